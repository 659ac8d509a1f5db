#pragma once
// A run as one content-addressed bundle: RUN/bundle.json lists every file that the decision follows from with its
// SHA-256; the bundle's id is the SHA-256 of that list. Whoever has the folder can check the decision without rig and
// firmware, years later, or judge the same records under other limits.
//
//   bundle.json           {"format": 1, "id": ..., "tool_version": ..., "files": [{"name", "bytes", "sha256"}, ...]}
//   bundle/plan.json      the plan as it was played
//   bundle/plan.toml      the plan's file
//   bundle/limits.toml    the derived limits, when the plan has any
//   bundle/goldens/*      the golden traces that were compared
//   bundle/head.json      the result without what is judged (names, hashes, versions, notes)
//   bundle/waivers.toml   when there were any
//   bundle/run.json       calibration level, whether the run was interrupted, the day against which waivers expired
//   bundle/records.jsonl  one line per record: {"job": ..., "record": ...}
//   bundle/firmware       the image
//   traces/*.h5           samples of the records that were kept

#include <filesystem>
#include <string>
#include <vector>

#include "golden/compare/golden_record.h"
#include "hil/base/result.h"
#include "hil/gate/run_judge.h"
#include "hil/gate/waiver.h"

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
  RunMaterial material;
  std::vector<GoldenRecord> goldens;
  std::vector<Waiver> waivers;
  std::string today;
};

/// Files beside the records.
struct BundleSource {
  std::filesystem::path plan, firmware, limits, waivers;  ///< limits and waivers may be empty
  std::string today;
  std::vector<GoldenRecord> goldens;
};

/// Writes bundle/ and bundle.json into the folder of a run, whose kept traces are already there.
Result<void> write_bundle(const std::filesystem::path& folder, const BundleSource& source,
                          const RunMaterial& material);

/// Checks every hash first. Errors (parse): no bundle, another format, a file that is missing or was changed.
Result<Bundle> read_bundle(const std::filesystem::path& folder);

}  // namespace forcegate
