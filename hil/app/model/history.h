#pragma once
// `forcegate history`: did the error fall? The model's own steps, and the order-averaged waterfall on a campaign.

#include <optional>

#include "hil/app/model/fit.h"

namespace forcegate {

struct History {
  Model model;
  std::optional<diagnose::Waterfall> waterfall;  ///< when a campaign was given
  std::vector<std::string> notes;                ///< what it leaves out, one sentence each
};

Result<History> history_request(const CampaignRequest& request);
/// The last step that added an effect is one that `forcegate add` advises to leave out.
bool leads_to_no_use(const Model& model);
std::string history_text(const History& history);
std::string history_json(const History& history);

}  // namespace forcegate
