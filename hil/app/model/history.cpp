#include "hil/app/model/history.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hil/app/model/never_fitted.h"
#include "hil/app/model/weak_addition.h"
#include "hil/base/plain_number.h"
#include "hil/diagnose/candidates/user_candidates.h"

namespace forcegate {
namespace {

// The latest step that put an effect in which the model still has; null where it has none.
const HistoryStep* last_added(const Model& model) {
  std::vector<std::string> names = model.effect_names();
  for (const UserEffect& own : model.user_effects)
    if (diagnose::is_fitted(own)) names.push_back(own.name);
  for (auto step = model.history.rbegin(); step != model.history.rend(); ++step)
    if (std::ranges::find(names, step->effect) != names.end()) return &*step;
  return nullptr;
}

// The model from which the step was taken. Its law is kept by no file; that of a first step is the one that comes with the program, which
// may decay where the refit found that these records do not.
Model before_step(const Model& with_step, const HistoryStep& step) {
  Model model = with_step;
  std::erase_if(model.effects, [&](const ModelEffect& e) { return e.effect == step.effect; });
  for (UserEffect& own : model.user_effects)  // an equation stands in its file before it is added: what no fit has estimated is left out
    if (own.name == step.effect)
      for (ModelParameter& p : own.parameters) p.se = 0.0;
  if (&step == &with_step.history.front())
    if (const Result<Model> library = library_model(model.name)) model.law = library->law;
  return model;
}

// Before any other step than the first of a model of the library the law and the forms were others, and no file keeps them.
std::string not_as_it_was(const HistoryStep& step, const HistoryStep& again) {
  constexpr double kSame = 0.01;
  if (again.campaign != step.campaign || again.unit != step.unit) return {};
  if (std::abs(again.error_before - step.error_before) <= kSame * step.error_before && std::abs(again.error_after - step.error_after) <= kSame * step.error_before) return {};
  const PrintedUnit unit = printed_unit(step.unit);
  const auto from_to = [&](double before, double after) { return plain_number(unit.factor * before) + " -> " + plain_number(unit.factor * after) + " " + unit.name; };
  return "taken again, " + step.effect + " is " + from_to(again.error_before, again.error_after) + ", and was " + from_to(step.error_before, step.error_after) +
         ": the file does not keep the law and the forms that the model had before, so the waterfall begins with those of now";
}

}  // namespace

bool leads_to_no_use(const Model& model) {
  const HistoryStep* step = last_added(model);
  if (step == nullptr || step->one_law) return false;
  // asked as add was answered
  diagnose::Refit refit;
  refit.model = model;
  refit.error_before = step->error_before, refit.error_after = step->error_after;
  refit.plain_before = step->plain_before, refit.plain_after = step->plain_after;
  return (!is_needed(refit) && !helps_one_law(refit)) || !weak_addition(refit, step->effect).is_shown;
}

Result<History> history_request(const CampaignRequest& request) {
  History out;
  FORCEGATE_TRY(out.model, load_model(request.model));
  if (!request.campaign.empty()) {
    // as the step was taken: a model that holds the effect already weighs the records by it, and its errors are no step's
    const HistoryStep* step = last_added(out.model);
    FORCEGATE_TRY(diagnose::Refit refit, step != nullptr ? fit_request(request, before_step(out.model, *step), step->effect)
                                                         : fit_request(request, ""));
    out.waterfall = std::move(refit.waterfall);
    out.notes = left_out_notes(out.model);
    if (std::string note = step != nullptr ? not_as_it_was(*step, refit.model.history.back()) : std::string(); !note.empty()) out.notes.push_back(std::move(note));
  }
  return out;
}

std::string history_text(const History& h) {
  std::string out =
      h.model.name + ", " + (h.model.sensor.empty() ? "sensor not named" : h.model.sensor) + "\n";
  if (h.model.history.empty()) out += "  no steps yet: the model is as it was written\n";
  for (const HistoryStep& s : h.model.history) {
    const PrintedUnit unit = printed_unit(s.unit);
    const std::string step = fmt::format("  {:<22} on {:<16} {:>8} -> {:>8} {} ", s.one_law ? "one law for all" : s.effect.empty() ? "refit" : "+ " + s.effect, s.campaign,
                                         plain_number(unit.factor * s.error_before), plain_number(unit.factor * s.error_after), unit.name);
    if (s.one_law) out += step + "left out, of the law without effects and with them; no record has a gain of its own here\n";
    else out += step + fmt::format("held out (floor {}){}\n", plain_number(unit.factor * s.floor), s.accepted ? "" : "  [the held-out error did not fall]");
  }
  if (leads_to_no_use(h.model)) out += "  the effect added last is not needed for these records, or not shown by them: the model before it describes them as well\n";
  if (h.waterfall) out += "waterfall, held out:\n" + waterfall_text(*h.waterfall);
  for (const std::string& note : h.notes) out += "note: " + note + "\n";
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
                     {"floor", s.one_law ? nlohmann::ordered_json() : nlohmann::ordered_json(s.floor)},
                     {"unit", s.unit},
                     {"accepted", s.accepted},
                     {"one_law", s.one_law}});
  nlohmann::ordered_json out = {{"format", 1}, {"model", h.model.name}, {"steps", steps}};
  if (h.waterfall) out["waterfall"] = nlohmann::ordered_json::parse(waterfall_json(*h.waterfall));
  out["notes"] = h.notes;
  return out.dump(2) + "\n";
}

}  // namespace forcegate
