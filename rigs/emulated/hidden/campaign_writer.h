#pragma once

#include <filesystem>

#include "hil/base/result.h"
#include "rigs/emulated/hidden/campaign_maker.h"

namespace forcegate::hidden {

/// Writes campaign.json and one CSV per record into `folder` (created when missing; its parent must exist).
/// Refuses a folder that holds a campaign.json already unless `overwrite`. Nothing of the truth is written.
Result<void> write_campaign(const MadeCampaign& made, const std::filesystem::path& folder, bool overwrite);

}  // namespace forcegate::hidden
