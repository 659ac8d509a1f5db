#pragma once
// Check (e): golden traces. The rig's truth (ATI in open loop) is always held against its golden, the firmware's curve
// only when it declares the algorithm of the golden: a better algorithm is not rejected for being different.

#include <filesystem>
#include <string>
#include <vector>

#include "golden/compare/golden_record.h"
#include "hil/gate/run_judge.h"

namespace forcegate {

/// Files NAME.golden of a folder in order of their names; none when the folder is not there. Errors: parse.
Result<std::vector<GoldenRecord>> read_goldens(const std::filesystem::path& folder);

/// "sine_f0.50_A1.50_m2.70@q50.golden"
std::string golden_file_name(const std::string& case_name, const std::string& specimen);

GoldenContent golden_content(const CaseRecord& record);

/// Signed margins of one record, extremum by extremum and sample by sample, as CSV.
struct GoldenMargins {
  std::string file;  ///< "four_sines@q50.csv"
  std::string csv;   ///< curve,where,t_s,golden_N,tested_N,margin_N
};

/// Checks golden_rig and golden_firmware of every record whose case asks for `golden` (one specimen of a case is enough:
/// others of it without a golden are passed over). A missing golden is not_run and required: no decision. A golden of
/// another rig, or for the firmware of another seed, is not comparable: not_run, not required. notes: stale goldens, where
/// the build leaves the golden and is nearer to the ATI than it.
/// margins, when given: what to write beside the result, one file for each record that was compared.
ChecksByRecord golden_checks(const RunMaterial& material, const std::vector<GoldenRecord>& goldens,
                             std::vector<std::string>& notes, std::vector<GoldenMargins>* margins = nullptr);

}  // namespace forcegate
