#pragma once
// A run as one content-addressed bundle: RUN/bundle.json lists every file that the decision follows from with its
// SHA-256; the bundle's id is the SHA-256 of that list. Whoever has the folder can check the decision without rig and
// firmware, years later, or judge the same records under other limits.
//
//   bundle.json           {"format": 1, "id": ..., "tool_version": ..., "files": [{"name", "bytes", "sha256"}, ...]}
//   bundle/plan.json      the plan as it was played (not of a plan of kind capacitance-gate, which nothing changes)
//   bundle/plan.toml      the plan's file
//   bundle/study.toml     the plan of the training, for kind capacitance-gate
//   bundle/limits.toml    the derived limits, when the plan has any
//   bundle/goldens/*      the golden traces that were compared
//   bundle/head.json      the result without what is judged (names, hashes, versions, notes)
//   bundle/waivers.toml   when there were any
//   bundle/run.json       calibration level, whether the run was interrupted, the day against which waivers expired, the plan's file as the
//                         command named it
//   bundle/records.jsonl  one line per record: {"job": ..., "record": ...}; kind capacitance-gate: frames and answers
//   bundle/firmware       the image
//   traces/*.h5           samples of the records that were kept

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "hil/app/files/write_file.h"
#include "hil/app/gate/judged_run.h"
#include "hil/app/gate/run_folder.h"
#include "hil/base/result.h"

namespace forcegate {

inline constexpr int kBundleFormat = 1;

struct BundleFile {
  std::string name;  ///< relative to the folder
  std::uint64_t bytes = 0;
  std::string sha256;
};

struct Bundle {
  std::string id, tool_version;
  std::vector<BundleFile> files;  ///< by name
  std::variant<RunMaterial, characterize::WeightMaterial> material;
  RunEvidence evidence;
  std::string plan_file;  ///< as the command named it; "": it gave the name of a plan in ci/plans
};

/// Files beside the records.
struct BundleSource {
  std::filesystem::path plan, firmware, limits, waivers;  ///< limits and waivers may be empty
  const RunEvidence& evidence;
  std::string plan_as_asked;  ///< file or name
};

/// Writes bundle/ and bundle.json into the folder of a run, whose kept traces are already there. The list has the hash of the
/// result too, which is written last.
Result<void> write_bundle(const std::filesystem::path& folder, const BundleSource& source,
                          const RunMaterial& material, const RunResult& result);
Result<void> write_bundle(const std::filesystem::path& folder, const BundleSource& source,
                          const characterize::WeightMaterial& material, const RunResult& result);

/// Good where the folder holds no list, or one of before results were listed. Errors (parse): result.json is not what the run wrote.
Result<void> check_result_unchanged(const std::filesystem::path& folder);

/// The result of a run's folder, or of its result.json. Errors: as check_result_unchanged and read_result; where an older run of that name lies aside it is named.
Result<RunResult> read_run(const std::filesystem::path& path);

/// Margins of the goldens, bundle and every report, then the folder gets its name.
template <class Material>
Result<void> publish_run(RunFolder& folder, const BundleSource& source, const Material& material,
                         const std::vector<GoldenMargins>& margins, const RunResult& result) {
  for (const GoldenMargins& one : margins)
    FORCEGATE_CHECK_OK(write_file_atomically(folder.path() / "golden" / one.file, one.csv));
  FORCEGATE_CHECK_OK(write_bundle(folder.path(), source, material, result));
  return folder.publish(result);
}

/// Checks every hash first. Errors (parse): no bundle, another format, a file that is missing or was changed, result.json included.
Result<Bundle> read_bundle(const std::filesystem::path& folder);

}  // namespace forcegate
