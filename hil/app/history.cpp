#include "hil/app/history.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hil/base/plain_number.h"

namespace forcegate {

Result<History> history_request(const CampaignRequest& request) {
  History out;
  FORCEGATE_TRY(out.model, load_model(request.model));
  if (!request.campaign.empty()) {
    FORCEGATE_TRY(diagnose::Refit refit, fit_request(request, ""));
    out.waterfall = std::move(refit.waterfall);
  }
  return out;
}

std::string history_text(const History& h) {
  std::string out =
      h.model.name + ", " + (h.model.sensor.empty() ? "sensor not named" : h.model.sensor) + "\n";
  if (h.model.history.empty()) out += "  no steps yet: the model is as it was written\n";
  for (const HistoryStep& s : h.model.history) {
    const PrintedUnit unit = printed_unit(s.unit);
    out += fmt::format("  {:<22} on {:<16} {:>8} -> {:>8} {} held out (floor {}){}\n",
                       s.effect.empty() ? "refit" : "+ " + s.effect, s.campaign,
                       plain_number(unit.factor * s.error_before), plain_number(unit.factor * s.error_after), unit.name,
                       plain_number(unit.factor * s.floor), s.accepted ? "" : "  [the held-out error did not fall]");
  }
  if (h.waterfall) out += "waterfall, held out:\n" + waterfall_text(*h.waterfall);
  return out;
}

std::string history_json(const History& h) {
  nlohmann::ordered_json steps = nlohmann::ordered_json::array();
  for (const HistoryStep& s : h.model.history)
    steps.push_back({{"effect", s.effect},
                     {"campaign", s.campaign},
                     {"error_before", s.error_before},
                     {"error_after", s.error_after},
                     {"plain_before", s.plain_before},
                     {"plain_after", s.plain_after},
                     {"floor", s.floor},
                     {"unit", s.unit},
                     {"accepted", s.accepted}});
  nlohmann::ordered_json out = {{"format", 1}, {"model", h.model.name}, {"steps", steps}};
  if (h.waterfall) out["waterfall"] = nlohmann::ordered_json::parse(waterfall_json(*h.waterfall));
  return out.dump(2) + "\n";
}

}  // namespace forcegate
