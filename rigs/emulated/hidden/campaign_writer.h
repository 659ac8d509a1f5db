#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "rigs/emulated/hidden/campaign_maker.h"

namespace forcegate::hidden {

/// Writes campaign.json and one CSV per record into `folder` (created when missing; its parent must exist).
/// The description comes first: records that an interrupt left out are then missed by whoever reads the folder. After an error both are gone again.
/// Refuses a folder that holds a campaign.json already unless `overwrite`, which takes away the recordings of a
/// mystery that was there, and its seal. Nothing of the truth is written. `interrupted` is asked before each record; then the error is `cancelled`.
Result<void> write_campaign(const MadeCampaign& made, const std::filesystem::path& folder, bool overwrite,
                            const std::function<bool()>& interrupted = {});
/// Removes the files that write_campaign has made of it.
void take_back_campaign(const MadeCampaign& made, const std::filesystem::path& folder);

/// Adds the records of continue_campaign to a campaign.json; the names of the new files, in order. No file is overwritten.
Result<std::vector<std::string>> append_records(const MadeCampaign& made,
                                                const std::vector<std::string>& names,
                                                const std::filesystem::path& folder);

}  // namespace forcegate::hidden
