#include "hil/app/model/weak_addition.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/diagnose/candidates/user_candidates.h"

namespace forcegate {
namespace {

constexpr double kWithin = 2.0;  // standard errors

std::string told(const std::string& effect, const ModelParameter& p) {
  return effect + "." + p.name + " = " + with_uncertainty(p.value, p.se) + (p.unit.empty() || p.unit == "1" ? "" : " " + p.unit);
}

bool is_none(const ModelParameter* p) { return std::abs(p->value) <= kWithin * p->se; }

// Those that were not fitted say nothing. Several that go together are each unsure where their sum is plain: the error says so.
void tell_strengths(const std::string& effect, std::vector<const ModelParameter*> strengths, bool error_falls, WeakAddition& out) {
  std::erase_if(strengths, [](const ModelParameter* p) { return !(p->se > 0.0); });
  if (strengths.empty() || (strengths.size() > 1 && error_falls)) return;
  if (!std::ranges::all_of(strengths, is_none)) return;
  out.is_shown = false;
  std::vector<std::string> values;
  for (const ModelParameter* p : strengths) values.push_back(told(effect, *p));
  out.warnings.push_back(join(values, ", ") + (values.size() == 1 ? " lies" : " lie") +
                         " within two standard errors of 0, where there is no such effect: these records do not show it");
}

// Beside a strength that is plainly there. Those of an effect of the library are its form's, and belong together.
void tell_parts(const std::string& equation, std::vector<const ModelParameter*> strengths, std::vector<std::string>& out) {
  std::erase_if(strengths, [](const ModelParameter* p) { return !(p->se > 0.0); });
  if (std::ranges::all_of(strengths, is_none)) return;
  for (const ModelParameter* p : strengths)
    if (is_none(p)) out.push_back(told(equation, *p) + " lies within two standard errors of 0: these records do not show that part of the equation; leave it out, or record what moves it more");
}

void tell_shape(const std::string& effect, const ModelParameter& p, double low, double high, const std::string& help, std::vector<std::string>& out) {
  constexpr double kSame = 1e-6;
  const auto at = [&](double end) { return std::abs(p.value - end) <= kSame * std::abs(end); };
  if (!(p.se > 0.0) || (!at(low) && !at(high))) return;
  out.push_back(fmt::format("{} lies at an end of what it may be ({:.4g} to {:.4g}): {}", told(effect, p), low, high, help));
}

}  // namespace

std::vector<std::string> shapes_at_their_ends(const UserEffect& own) {
  std::vector<std::string> out;
  for (const ModelParameter& p : own.parameters) {
    if (!std::isfinite(p.written)) continue;
    const diagnose::Reach reach = diagnose::reach_of(p);
    tell_shape(own.name, p, reach.low, reach.high, "write another value or wider bounds, or another equation", out);
  }
  return out;
}

WeakAddition weak_addition(const diagnose::Refit& r, const std::string& added) {
  WeakAddition out;
  if (added.empty()) return out;
  std::vector<const ModelParameter*> strengths;
  for (const ModelEffect& effect : r.model.effects) {
    if (effect.effect != added) continue;
    for (const ModelParameter& p : effect.strength) strengths.push_back(&p);
    const EffectKind* kind = EffectRegistry::instance().find(added);
    const EffectForm* form = kind != nullptr ? find_form(*kind, effect.form) : nullptr;
    for (std::size_t k = 0; form != nullptr && k < std::min(form->shape.size(), effect.shape.size()); ++k)
      if (!form->shape[k].choice && effect.shape[k].value != 0.0)  // no lag behind the temperature, no width: nothing is beyond it
        tell_shape(added, effect.shape[k], effect.shape[k].minimum, effect.shape[k].maximum,
                   "the records ask for more than such an effect has, and another form or effect may be there", out.warnings);
  }
  for (const UserEffect& own : r.model.user_effects) {
    if (own.name != added) continue;
    for (const ModelParameter& p : own.parameters)
      if (!std::isfinite(p.written) && p.se > 0.0) strengths.push_back(&p);  // what was not fitted has none
    tell_parts(added, strengths, out.warnings);
    for (std::string& warning : shapes_at_their_ends(own)) out.warnings.push_back(std::move(warning));
  }
  constexpr double kHardly = 0.98;
  const bool falls = r.error_after <= kHardly * r.error_before;
  tell_strengths(added, strengths, falls, out);
  if (!falls && r.plain_after >= r.plain_before) {
    out.is_shown = false;
    const PrintedUnit unit = printed_unit(r.waterfall.unit);
    if (diagnose::lowers_error(r.error_before, r.error_after)) out.warnings.push_back(
        fmt::format("the error hardly falls ({:.4g} -> {:.4g} {}), and with one gain, offset and decay for all records it does not at all",
                    unit.factor * r.error_before, unit.factor * r.error_after, unit.name));
  }
  if (!out.is_shown && !out.warnings.empty()) out.warnings.emplace_back("leave " + added + " out: the model before describes these records as well; records that move it more may show it");
  return out;
}

}  // namespace forcegate
