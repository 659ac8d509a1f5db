#pragma once
// The copy of a campaign that `next --run` appends its records to.

#include <filesystem>
#include <set>
#include <vector>

#include "hil/base/result.h"

namespace forcegate {

inline constexpr const char* kProfiles = "profiles";  ///< forces that were asked for

/// Errors (usage): the folder holds anything but profiles and these recordings.
Result<void> check_new(const std::filesystem::path& folder, const std::vector<std::filesystem::path>& recorded);

/// A whole campaign with a description that lists its records. Records of a description that stand in subfolders are copied to their place, those outside
/// of its folder are named where they are. Errors: usage where a file of the name is there; io; those of the description.
Result<void> copy_campaign(const std::filesystem::path& from, const std::filesystem::path& to);

/// Until its records are there: whatever ends the run before keep() leaves the folder as it was found. Forces that a person may still record stay.
class CampaignCopy {
 public:
  CampaignCopy(std::filesystem::path folder, bool keep_profiles);
  CampaignCopy(const CampaignCopy&) = delete;
  CampaignCopy& operator=(const CampaignCopy&) = delete;
  ~CampaignCopy();
  void keep() { kept_ = true; }

 private:
  std::filesystem::path folder_;
  std::set<std::filesystem::path> found_;
  bool keep_profiles_, kept_ = false;
};

}  // namespace forcegate
