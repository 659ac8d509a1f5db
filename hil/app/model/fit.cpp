#include "hil/app/model/fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hil/app/model/beyond_bounds.h"
#include "hil/app/model/never_fitted.h"
#include "hil/app/model/weak_addition.h"
#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/diagnose/candidates/user_candidates.h"
#include "hil/diagnose/laws/no_input.h"

namespace forcegate {
namespace {

// Beside a gain, a zero and a decay of each record's own an effect may have nothing left to do that a law for all of them lacks.
std::string not_needed(const diagnose::Refit& r) {
  if (!helps_one_law(r)) return "the error did not fall: this effect is not needed for these records";
  const PrintedUnit unit = printed_unit(r.waterfall.unit);
  return fmt::format("the error did not fall: where each record has a gain, a zero and a decay of its own, this effect is not needed for these records; with one of each for all, "
                     "as a firmware has it, the error falls from {} to {} {}",
                     plain_number(unit.factor * r.plain_before), plain_number(unit.factor * r.plain_after), unit.name);
}

bool has_effect(const Model& model, const std::string& name) {
  const std::vector<std::string> names = model.effect_names();
  return std::ranges::find(names, name) != names.end() ||
         std::ranges::any_of(model.user_effects, [&](const UserEffect& e) { return e.name == name && diagnose::is_fitted(e); });
}

}  // namespace

namespace {

// A file holds no value that was written before the fit: a refit of what it says would look two decades around the fitted one, and further each time.
void keep_reach(Model& model) {
  for (UserEffect& own : model.user_effects)
    for (ModelParameter& p : own.parameters) {
      if (!std::isfinite(p.written)) continue;
      const diagnose::Reach reach = diagnose::reach_of(p);
      p.minimum = reach.low, p.maximum = reach.high;
    }
}

// What loading the model and losing its decay say of it.
std::vector<std::string> law_notes(const std::vector<std::string>& of_campaign, const std::string& of_unit, const Model& before, const Model& after) {
  std::vector<std::string> out;
  if (std::ranges::find(of_campaign, of_unit) != of_campaign.end()) out.push_back(of_unit);
  if (before.law.decays && !after.law.decays)
    out.emplace_back("the maxima of these records do not decay along the law of the model: what is fitted is kind = \"static\", without b_scale and q_scale");
  return out;
}

Result<diagnose::Refit> fit_campaign(const CampaignRequest& request, Campaign campaign, const Model& model,
                                     const std::string& add) {
  const PlacesOf places(campaign, request.campaign);
  if (auto law = diagnose::check_shows_a_law(campaign); !law) return Unexpected(places.with_file(std::move(law.error())));
  if (!add.empty() && has_effect(model, add))
    return fail(ErrorCode::config, "the model has " + add + " already", request.model.empty() ? model.name : request.model,
                "forcegate fit refits it");
  const std::string unit = output_unit(campaign), of_unit = note_of_another_unit(model, campaign);
  const std::vector<std::string> of_campaign = campaign.notes;
  auto out = diagnose::refit_campaign(std::move(campaign), engine_options(model, request.threads), model, add);
  const auto own = std::ranges::find(model.user_effects, add, &UserEffect::name);
  if (!out && own != model.user_effects.end() && out.error().text.starts_with("the campaign cannot show"))
    return fail(out.error().code, "the campaign cannot show " + add, out.error().where,
                "its equation has no value at the shapes tried, or the records ask for a parameter outside of its min and max");
  if (!out) return Unexpected(places.with_file(std::move(out.error())));
  out->model.output_unit = unit;
  for (diagnose::ParameterMove& move : out->moves)
    if (move.name == "gain_N_per_V") {
      move.unit = "N/" + unit;
      if (model.output_unit != unit) move.before = kMissing;  // a gain of another quantity
    }
  for (std::string& note : law_notes(of_campaign, of_unit, model, out->model)) out->notes.push_back(std::move(note));
  for (std::string& note : left_out_notes(model, add)) out->notes.push_back(std::move(note));
  for (std::string& note : beyond_bounds_notes(out->model)) out->notes.push_back(std::move(note));
  for (const UserEffect& effect : out->model.user_effects)
    if (effect.name != add)  // of the added one a warning says it
      for (std::string& note : shapes_at_their_ends(effect)) out->notes.push_back(std::move(note));
  keep_reach(out->model);
  return out;
}

}  // namespace

Result<diagnose::Refit> fit_request(const CampaignRequest& request, const std::string& add) {
  FORCEGATE_TRY(Campaign campaign, load_campaign(request));
  FORCEGATE_TRY(const Model model, load_model(request, campaign));
  return fit_campaign(request, std::move(campaign), model, add);
}

Result<diagnose::Refit> fit_request(const CampaignRequest& request, const Model& model, const std::string& add) {
  FORCEGATE_TRY(Campaign campaign, load_campaign(request));
  return fit_campaign(request, std::move(campaign), model, add);
}

bool helps_one_law(const diagnose::Refit& r) {
  constexpr double kPlainly = 0.9;
  return !is_needed(r) && r.plain_after < kPlainly * r.plain_before;
}

bool is_needed(const diagnose::Refit& r) { return diagnose::lowers_error(r.error_before, r.error_after); }

std::string waterfall_text(const diagnose::Waterfall& w) {
  const PrintedUnit unit = printed_unit(w.unit);
  const auto number = [&](double v) { return plain_number(unit.factor * v); };
  std::string out = fmt::format("  {:<22} {:>8} {}\n", "base law", number(w.start), unit.name);
  const double full = std::max(w.start, 1e-12);
  // below a ten thousandth of the error a change is rounding of the fit, in whatever digits it comes
  constexpr double kNone = 1e-4;
  const auto change = [&](double fall) {
    return !std::isfinite(fall)            ? std::string("?")
           : std::abs(fall) < kNone * full ? std::string("0")
                                           : fmt::format("{:+.3g}", -unit.factor * fall);
  };
  for (const auto& bar : w.bars) {
    const double shown = std::isfinite(bar.as_added) ? std::clamp(40.0 * bar.as_added / full, 0.0, 40.0) : 0.0;
    const auto length = static_cast<std::size_t>(shown);
    std::string picture;
    for (std::size_t k = 0; k < length; ++k) picture += bar.hollow ? "o" : "#";
    const std::string orders =
        w.all_orders ? fmt::format("over all orders {} [{}, {}]", change(bar.average), change(bar.high), change(bar.low)) : "in this order";
    out += fmt::format("  {:<22} {:>8} {}  {:<40} {}\n", bar.effect, change(bar.as_added), unit.name, picture, orders);
  }
  out += fmt::format("  {:<22} {:>8} {}\n  {:<22} {:>8} {}\n", "what is left", number(w.end), unit.name, "floor",
                     number(w.floor), unit.name);
  return out;
}

namespace {

// A parameter that the records do not tell would be written as a zero of its uncertainty, which it is not: it stayed near what was written.
std::string after_text(const diagnose::ParameterMove& m) {
  constexpr double kReach = 100.0;
  const double ratio = m.after / m.before;
  const bool untold = std::isfinite(ratio) && ratio >= 1.0 / kReach && ratio <= kReach && m.u > std::abs(m.after);
  return untold ? fmt::format("{:.3g}, not told by these records (u = {:.2g})", m.after, m.u) : with_uncertainty(m.after, m.u);
}

}  // namespace

std::string refit_text(const diagnose::Refit& r, const std::string& add, bool notes) {
  const PrintedUnit unit = printed_unit(r.waterfall.unit);
  const auto number = [&](double v) { return plain_number(unit.factor * v); };
  std::string out = add.empty() ? "refitted\n" : "added " + add + " and refitted everything\n";
  out += fmt::format(
      "{}{}: {} -> {} {} (floor {} {}); with one gain, offset and decay for all of them {} -> {} {}\n",
      error_name(r.judged_by), r.levels ? ", one gain and offset for all" : "",
      number(r.error_before), number(r.error_after), unit.name, number(r.floor), unit.name, number(r.plain_before),
      number(r.plain_after), unit.name);
  if (!add.empty() && !is_needed(r)) out += not_needed(r) + "\n";
  for (const std::string& warning : weak_addition(r, add).warnings) out += "warning: " + warning + "\n";
  out += "parameters:\n";
  for (const auto& m : r.moves)
    out += fmt::format("  {:<28} {:>12} -> {} {}\n", m.name, std::isfinite(m.before) ? fmt::format("{:.5g}", m.before) : "new", after_text(m),
                       m.unit == "1" ? "" : m.unit);
  if (notes)
    for (const std::string& note : r.notes) out += "note: " + note + "\n";
  if (!r.waterfall.bars.empty()) out += "error by effect, held out:\n" + waterfall_text(r.waterfall);
  return out;
}

std::string waterfall_json(const diagnose::Waterfall& w) {
  nlohmann::ordered_json bars = nlohmann::ordered_json::array();
  for (const auto& b : w.bars)
    bars.push_back({{"effect", b.effect},
                    {"change", -b.as_added},
                    {"as_added", b.as_added},
                    {"average", b.average},
                    {"low", b.low},
                    {"high", b.high},
                    {"hollow", b.hollow}});
  return nlohmann::ordered_json{{"start", w.start}, {"end", w.end}, {"floor", w.floor}, {"bars", bars}}.dump();
}

std::string refit_json(const diagnose::Refit& r, const std::string& add) {
  nlohmann::ordered_json moves = nlohmann::ordered_json::array();
  for (const auto& m : r.moves)
    moves.push_back({{"name", m.name},
                     {"before", std::isfinite(m.before) ? nlohmann::ordered_json(m.before) : nlohmann::ordered_json()},
                     {"after", m.after},
                     {"u", m.u},
                     {"unit", m.unit}});
  const WeakAddition weak = weak_addition(r, add);
  std::vector<std::string> notes = r.notes;
  if (!add.empty() && !is_needed(r)) notes.push_back(not_needed(r));
  const nlohmann::ordered_json out = {
      {"format", 1},
      {"added", add},
      {"model", r.model.name},
      {"accepted", add.empty() || is_needed(r)},
      {"shown", weak.is_shown},
      {"warnings", weak.warnings},
      {"parameters", moves},
      {"notes", notes},
      {"error_before", r.error_before},
      {"error_after", r.error_after},
      {"floor", r.floor},
      {"adapted", r.levels ? nlohmann::ordered_json{"decay"} : nlohmann::ordered_json{"gain", "zero", "decay"}},
      {"plain_before", r.plain_before},
      {"plain_after", r.plain_after},
      {"judged_by", to_string(r.judged_by)},
      {"unit", r.waterfall.unit},
      {"waterfall", nlohmann::ordered_json::parse(waterfall_json(r.waterfall))}};
  return out.dump(2) + "\n";
}

}  // namespace forcegate
