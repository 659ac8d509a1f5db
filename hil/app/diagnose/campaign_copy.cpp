#include "hil/app/diagnose/campaign_copy.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "hil/app/files/write_file.h"
#include "hil/base/text.h"
#include "hil/trace/campaign_description.h"

namespace forcegate {

namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

bool leaves_folder(const fs::path& file) { return file.is_absolute() || *file.lexically_normal().begin() == ".."; }

// The records of a description that stand in subfolders are copied to their place, those outside of the folder are named where they are.
Result<void> copy_listed(const std::vector<DescribedRecord>& listed, const fs::path& from, const fs::path& to, Json& description) {
  std::error_code error;
  for (std::size_t k = 0; k < listed.size(); ++k) {
    const fs::path file = listed[k].file;
    if (leaves_folder(file)) {
      description["records"][k]["file"] = fs::absolute(from / file).lexically_normal().string();
      continue;
    }
    if (fs::exists(to / file, error)) continue;
    fs::create_directories((to / file).parent_path(), error);
    fs::copy_file(from / file, to / file, error);
    if (error) return fail(ErrorCode::io, "the record cannot be copied: " + error.message(), (from / file).string(), "is the disk full?");
  }
  return {};
}

}  // namespace

Result<void> copy_campaign(const fs::path& from, const fs::path& to) {
  std::error_code error;
  const bool is_file = fs::is_regular_file(from, error), single = is_file && from.extension() != ".json";
  const fs::path folder = is_file ? from.parent_path() : from;
  const fs::path described = single ? fs::path() : is_file ? from : from / "campaign.json";
  fs::create_directories(to, error);
  std::vector<fs::path> files;
  if (single)
    files.push_back(from);
  else
    for (const auto& entry : fs::directory_iterator(folder.empty() ? fs::path(".") : folder, error))
      if (entry.is_regular_file()) files.push_back(entry.path());
  std::vector<std::string> records;
  for (const fs::path& file : files) {
    if (fs::exists(to / file.filename(), error))
      return fail(ErrorCode::usage, "the campaign has a record of this name already", (to / file.filename()).string(), "rename the recording");
    fs::copy_file(file, to / file.filename(), error);
    if (error) return fail(ErrorCode::io, "the campaign cannot be copied: " + error.message(), to.string(), "is the disk full?");
    const std::string ending = file.extension().string();
    if (single || ending == ".csv" || ending == ".h5" || ending == ".hdf5" || ending == ".mat") records.push_back(file.filename().string());
  }
  Json json = {{"campaign", to.filename().string()}};
  if (fs::exists(described, error)) {
    FORCEGATE_TRY(const CampaignDescription description, read_description(described));
    std::ifstream text(described, std::ios::binary);
    json = Json::parse(text, nullptr, false, true);
    if (description.records) {
      const Json before = json;
      FORCEGATE_CHECK_OK(copy_listed(*description.records, folder, to, json));
      if (json == before && described.filename() == "campaign.json") return {};  // copied as it was written
      return write_file_atomically(to / "campaign.json", json.dump(1) + "\n");
    }
  }
  std::ranges::sort(records, natural_less);
  Json list = Json::array();
  for (const std::string& file : records) list.push_back({{"file", file}});
  json["records"] = list;
  return write_file_atomically(to / "campaign.json", json.dump(1) + "\n");
}

Result<void> check_new(const fs::path& folder, const std::vector<fs::path>& recorded) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const bool is_recording = std::ranges::any_of(recorded, [&](const fs::path& file) { return fs::equivalent(entry.path(), file, error); });
    if (entry.path().filename() == kProfiles || is_recording) continue;
    return fail(ErrorCode::usage, "the output exists already, and holds " + entry.path().filename().string(), folder.string(),
                "choose another folder with -o" + std::string(recorded.empty() ? "" : ", or name every recording in it with --record"));
  }
  error.clear();
  if (fs::exists(folder, error) && !fs::is_directory(folder, error)) return fail(ErrorCode::usage, "the output exists already", folder.string(), "choose another folder with -o");
  return {};
}

CampaignCopy::CampaignCopy(fs::path folder, bool keep_profiles) : folder_(std::move(folder)), keep_profiles_(keep_profiles) {
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_, error)) found_.insert(entry.path().filename());
}

CampaignCopy::~CampaignCopy() {
  if (kept_) return;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder_, error)) {
    const fs::path name = entry.path().filename();
    if (!found_.contains(name) && !(keep_profiles_ && name == kProfiles)) fs::remove_all(entry.path(), error);
  }
  fs::remove(folder_, error);  // where it is empty
}

}  // namespace forcegate
