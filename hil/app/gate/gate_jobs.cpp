#include "hil/app/gate/gate_jobs.h"

#include <fmt/format.h>

#include <algorithm>

#include "hil/base/digest.h"
#include "hil/base/rng.h"
#include "hil/base/text.h"
#include "hil/interface/dut.h"

namespace forcegate {
namespace {

CaseJob common_job(const GateRequest& request, const GateSetup& setup, const std::string& specimen) {
  CaseJob job;
  job.rig = request.rig;
  job.rig_options = request.rig_options;
  job.specimen = specimen;
  job.seed = setup.plan.seed;
  job.session = 0;
  job.safety = setup.plan.safety;
  return job;
}

std::string session_suffix(std::uint64_t session) {
  return session == 0 ? std::string() : fmt::format("/session{}", session + 1);
}

// `transient` = n: only the first n attempts at a record have the faults.
std::map<std::string, double> faults_of_attempt(const std::map<std::string, double>& faults, int attempt) {
  const auto transient = faults.find("transient");
  if (transient != faults.end() && attempt > transient->second) return {};
  return faults;
}

}  // namespace

bool plays_on_one_bench(const GateRequest& request, const GateSetup& setup) {
  return request.rig == "bench" && (!setup.rig.emulated || request.rig_options.contains("attach"));
}

bool plays_only_once(const GateRequest& request, const GateSetup& setup) {
  if (plays_on_one_bench(request, setup)) return true;
  const auto given = request.rig_options.find("clock");
  const auto own = setup.rig.details.find("clock");
  const std::string clock = given != request.rig_options.end() ? given->second : own != setup.rig.details.end() ? own->second : "";
  return request.rig == "bench" && clock == "paced";
}

RunResult run_head(const GateRequest& request, const std::string& firmware_sha256, const std::string& lane) {
  RunResult head;
  head.tool_version = FORCEGATE_VERSION;
  head.command_line = request.command_line;
  head.started_at = request.started_at;
  head.firmware_path = request.firmware.string();
  head.firmware_sha256 = firmware_sha256;
  head.environment["compiler"] = "GCC " __VERSION__;
  head.environment["lane"] = lane;
  return head;
}

Result<void> known_cases(const std::vector<std::string>& wanted, const std::vector<std::string>& known,
                         const std::string& where) {
  for (const std::string& name : wanted)
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      const std::string near = nearest_name(name, known);
      return fail(ErrorCode::usage, "the plan has no case '" + printable_utf8(name) + "'", where,
                  near.empty() ? "it has: " + join(known, ", ") : "did you mean '" + near + "'?");
    }
  return {};
}

Result<std::string> image_sha256(const std::filesystem::path& image) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(image, ignored))
    return fail(ErrorCode::usage, "there is no firmware file", image.string(),
                "build the images first (./ci/build) or mend the path");
  return sha256_file(image);
}

// Which lanes would run it, for who asked for another one.
std::string lanes_of(const std::filesystem::path& image) {
  std::vector<std::string> fit;
  for (const LaneKind& lane : Registry<LaneKind>::instance().all())
    if (lane.accepts(image)) fit.push_back("--lane " + lane.name);
  return fit.empty() ? "no lane runs it: give an ELF image built for one of the ports"
                     : "this image runs with " + join(fit, " or ") + ": leave --lane out, or give an image built for that lane";
}

Result<std::string> choose_lane(const GateRequest& request, const std::string& board_lane) {
  const auto& lanes = Registry<LaneKind>::instance();
  if (!board_lane.empty() && (request.lane.empty() || request.lane == board_lane)) return board_lane;
  if (!request.lane.empty()) {
    const LaneKind* lane = lanes.find(request.lane);
    if (lane == nullptr) {
      const std::string near = nearest_name(request.lane, lanes.names());
      return fail(
          ErrorCode::usage, "there is no lane named '" + printable_utf8(request.lane) + "'", {},
          near.empty() ? "choose one of: " + join(lanes.names(), ", ") : "did you mean '" + near + "'?");
    }
    if (!lane->accepts(request.firmware))
      return fail(ErrorCode::usage, "lane '" + request.lane + "' cannot run this image",
                  request.firmware.string(), lanes_of(request.firmware) + "; lane '" + request.lane + "': " + lane->doc);
    return lane->name;
  }
  for (const LaneKind& lane : lanes.all())
    if (lane.accepts(request.firmware)) return lane.name;
  return fail(ErrorCode::usage, "this is no firmware image that any lane can run",
              request.firmware.string(),
              "give an ELF image built for one of the ports: " + join(lanes.names(), ", "));
}

bool calibrates(const GateRequest& request, const GateSetup& setup) {
  return setup.rig.can_move && request.calibration_file.empty() &&
         setup.plan.calibration.level != CalibrationLevel::nominal;
}

CaseJob calibration_job(const GateRequest& request, const GateSetup& setup, const std::string& specimen,
                        std::uint64_t session, int attempt) {
  CaseJob job = common_job(request, setup, specimen);
  job.kind = CaseJob::Kind::calibration;
  job.id = "calibration/" + specimen + session_suffix(session);
  job.session = session;
  job.attempt = attempt;
  job.calibrate = setup.plan.calibration;
  return job;
}

CaseJob record_job(const GateRequest& request, const GateSetup& setup, std::size_t case_index,
                   const std::string& specimen, std::uint64_t session, int attempt,
                   const Calibration& calibration) {
  const PlanCase& planned = setup.plan.cases[case_index];
  const auto& specimens = specimens_of(setup.plan, planned);
  CaseJob job = common_job(request, setup, specimen);
  job.id = planned.name + "/" + specimen + session_suffix(session);
  job.lane = planned.lane;
  job.lane_options = request.lane_options;
  job.image = std::filesystem::absolute(request.firmware).string();
  job.planned = planned;
  // One record stands for its case; what cannot be played again is drawn in any case. Without a folder there is no report.
  const bool stands = session == 0 && specimen == specimens[specimens.size() / 2];
  job.curves = (stands && !request.output.empty()) || !setup.rig.emulated;
  job.session = session;
  job.attempt = attempt;
  job.record = setup.number_of_case.at(planned.name);
  job.nonce = static_cast<std::uint32_t>(
      mix_seed(job.seed, fmt::format("{}/{}/{}", setup.firmware_sha256, job.id, attempt)) & 0xFFFFFFFFu);
  job.faults = faults_of_attempt(request.faults, attempt);
  job.calibration = calibration;
  job.calibration_given = !calibrates(request, setup);
  return job;
}

double rig_time_s(const CaseJob& job) {
  const auto duration_s = [](const StimulusSpec& spec) {
    const auto made = make_stimulus(spec);
    return made ? (*made)->duration_s() : 0.0;
  };
  if (job.kind == CaseJob::Kind::record) return duration_s(job.planned.stimulus);
  double t_s = job.calibrate.sweep_s * job.calibrate.sweeps;
  if (job.calibrate.level == CalibrationLevel::identified)
    t_s += duration_s(job.calibrate.identification->stimulus);
  return t_s;
}

}  // namespace forcegate
