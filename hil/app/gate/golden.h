#pragma once
// Check (e): golden traces. The rig's truth (ATI in open loop) is always held against its golden, the firmware's curve
// only when it declares the algorithm of the golden: a better algorithm is not rejected for being different.

#include <filesystem>
#include <string>
#include <vector>

#include "golden/compare/golden_record.h"
#include "hil/characterize/capacitance/weight_material.h"
#include "hil/gate/run_judge.h"

namespace forcegate {

/// Files NAME.golden of a folder in order of their names; none when the folder is not there. Errors: parse.
Result<std::vector<GoldenRecord>> read_goldens(const std::filesystem::path& folder);

/// "sine_f0.50_A1.50_m2.70@q50.golden"
std::string golden_file_name(const std::string& case_name, const std::string& specimen);

/// A record as goldens see it.
struct GoldenTarget {
  std::size_t place = 0;  ///< of the record in the run
  std::string record_id, case_name, specimen;
  std::uint64_t seed = 0;
  std::string rig;            ///< "emulated/1"
  std::string algorithm;      ///< that the firmware declares
  std::string truth = "ATI";  ///< what the first curve is
  bool with_truth = true;     ///< false in a closed loop, where the firmware itself makes it
  bool failed = false;        ///< a finding of its own
  std::string stimulus;       ///< in words; "" = not told
  bool as_planned = false;    ///< the record is whole and follows the set-point of its profile
  bool to_bless = false;      ///< stands for its case
  std::string calibration;
  GoldenContent content;
  TubeOptions truth_tube, firmware_tube;  ///< of a first golden
  std::string
      error_name;  ///< of a number that says how near the firmware is to the truth: mre_maxima_pct; "" = none
  double error = 0.0;
};

/// Of the records whose case asks for `golden`, first session, attempts that stand; one case's targets follow each other.
std::vector<GoldenTarget> golden_targets(const RunMaterial& material);
/// Of every sensor, its loadings as windows; the first curve is the network in double precision on the same codes, which
/// shows whether the bench still gives them.
std::vector<GoldenTarget> golden_targets(const characterize::WeightMaterial& material);

/// Signed margins of one record, extremum by extremum and sample by sample, as CSV.
struct GoldenMargins {
  std::string file;  ///< "four_sines@q50.csv"
  std::string csv;   ///< curve,where,t_s,golden_N,tested_N,margin_N
};

/// Checks rig_golden and golden_firmware of every target (one specimen of a case is enough:
/// others of it without a golden are passed over). A missing golden is not_run and required, of the record that stands for its case: no decision. A golden of
/// another rig, or for the firmware of another seed, is not comparable: not_run, not required. One of another profile (its
/// stimulus says so, or the record does as its own profile wants and the golden does not fit it) is not_run and required: to
/// act is the plan, no retry helps. notes: stale goldens, where
/// the build leaves the golden and is nearer to the ATI than it, and tolerances far above those of a first golden.
/// margins, when given: what to write beside the result, one file for each record that was compared.
ChecksByRecord golden_checks(const std::vector<GoldenTarget>& targets,
                             const std::vector<GoldenRecord>& goldens, std::vector<std::string>& notes,
                             std::vector<GoldenMargins>* margins = nullptr);

}  // namespace forcegate
