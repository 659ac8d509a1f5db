#include "hil/trace/recording_files.h"

#include <algorithm>
#include <array>

#include "hil/base/text.h"

namespace forcegate {

namespace fs = std::filesystem;

Result<RecordingFiles> recording_files(const fs::path& folder) {
  constexpr std::array kRecords = {".csv", ".tsv", ".h5", ".hdf5", ".mat"}, kTexts = {".txt", ".dat", ".lvm", ".log", ".asc"};
  RecordingFiles out;
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(folder, failed)) {
    const std::string ending = ascii_lower(entry.path().extension().string());
    if (entry.path().filename().string().front() == '.') continue;
    if (std::ranges::find(kRecords, ending) != kRecords.end()) out.records.push_back(entry.path());
    if (std::ranges::find(kTexts, ending) != kTexts.end()) out.texts.push_back(entry.path());
  }
  if (failed) return fail(ErrorCode::io, "the folder cannot be listed: " + failed.message(), folder.string());
  for (std::vector<fs::path>* files : {&out.records, &out.texts})
    std::ranges::sort(*files, [](const fs::path& a, const fs::path& b) { return natural_less(a.filename().string(), b.filename().string()); });
  return out;
}

}  // namespace forcegate
