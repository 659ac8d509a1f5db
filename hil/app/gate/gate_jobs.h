#pragma once
// From a plan and a request to the jobs of a run.

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hil/app/gate/gate.h"
#include "hil/gate/case_record.h"

namespace forcegate {

struct GateSetup {
  Plan plan;
  std::string firmware_sha256;
  std::string lane;  ///< of the cases that name none; afterwards every case has one
  std::vector<std::string> notes;
  RigInfo rig;
  std::optional<Calibration> calibration;  ///< that of the request's file, with the converter of the rig
  std::vector<std::string> specimens;  ///< all that are needed, in order of first use
  /// Place of a case in the whole plan, from 1. It draws the noise of its records: what --case leaves out changes none of the others.
  std::map<std::string, std::uint64_t> number_of_case;
};

/// Name of the lane that runs the request's image: the one asked for, else that of the rig's own board, else the first
/// that accepts it. Errors: usage.
Result<std::string> choose_lane(const GateRequest& request, const std::string& board_lane = {});

/// Errors: usage when there is no such file.
Result<std::string> image_sha256(const std::filesystem::path& image);

/// What a result says of program, command, image and lane.
RunResult run_head(const GateRequest& request, const std::string& firmware_sha256, const std::string& lane);

/// Errors (usage): a name that is none of `known`, which `where` has.
Result<void> known_cases(const std::vector<std::string>& wanted, const std::vector<std::string>& known,
                         const std::string& where);

/// Checks everything that can be wrong before a record is made (exit 2). A recording has no converter of its own: where the calibration
/// file states one and the request's rig options do not, it is added to them.
Result<GateSetup> prepare_gate(GateRequest& request);

/// One bench on the table, or twins that are served as one: a record cannot be had twice, nor two at a time. Only twins that a worker starts
/// for itself can be had several times.
bool plays_on_one_bench(const GateRequest& request, const GateSetup& setup);

/// Records that nothing plays again as they were: of one bench, and of twins in time of the wall. They are kept, whatever ends the run.
bool plays_only_once(const GateRequest& request, const GateSetup& setup);

/// Anything to measure before the records: not at nominal level, with a calibration file or on a recording.
bool calibrates(const GateRequest& request, const GateSetup& setup);

/// Calibration of a specimen in a session (0, 1 ...).
CaseJob calibration_job(const GateRequest& request, const GateSetup& setup, const std::string& specimen,
                        std::uint64_t session, int attempt);

/// One record: the case's number in the plan, a specimen, a session. Its id is CASE/SPECIMEN, from the second
/// session on CASE/SPECIMEN/session2 and so on.
CaseJob record_job(const GateRequest& request, const GateSetup& setup, std::size_t case_index,
                   const std::string& specimen, std::uint64_t session, int attempt,
                   const Calibration& calibration);

/// Rig time of a job, s.
double rig_time_s(const CaseJob& job);

}  // namespace forcegate
