#include "hil/diagnose/choose/reference_witness.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "hil/diagnose/candidates/rig_law.h"
#include "hil/diagnose/candidates/signatures.h"
#include "hil/diagnose/candidates/spare_room.h"

namespace forcegate::diagnose {

namespace {

// dU = -g D c (F - L), L the force by the rig's law; a zero of the angle that is off by a degree is the rig's own: g D c2 sin th, where it turns.
// Rows near zero force take no part: an open contact carries nothing.
EffectKind rig_misfit(bool turns) {
  EffectForm form;
  form.name = "rig_misfit";
  form.strength.push_back({"c", "1", -10.0, 10.0, 0.0, "share of the rig's misfit"});
  if (turns) form.strength.push_back({"zero_rad", "rad", -10.0, 10.0, 0.0, "zero of the angle"});
  form.refine = false;
  form.columns = [turns](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
    out.setZero();
    if (r.rig_force_N.size() != r.rows()) return;
    for (std::size_t i = 0; i < r.rows(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      if (!(r.F_N[i] > kOpenContact * c.range_N)) continue;
      out(row, 0) = -r.decay[i] * (r.F_N[i] - r.rig_force_N[i]);
      if (turns && r.sin_theta.size() == r.rows()) out(row, 1) = r.decay[i] * c.range_N * r.sin_theta[i];
    }
  };
  EffectKind out;
  out.name = "rig_misfit";
  out.forms.push_back(std::move(form));
  return out;
}

// On a wheel that turns evenly a loop of the sensor goes nearly as the sine of the angle. A zero of the angle that only the output asks for, and
// beside which the reference is further off the rig's law than without, is none.
bool rig_shows_angle_zero(const ResidualChannel& channel, const Candidate& misfit, const MixedFit& fit) {
  const double share = fit.strength_of(misfit.first), zero = fit.strength_of(misfit.first + 1);
  const int first = channel.problem.nz + misfit.first;
  double with_sine = 0.0, of_sine = 0.0;
  for (const RecordGram& record : channel.problem.records) {
    with_sine += record.gram(first, first + 1);
    of_sine += record.gram(first + 1, first + 1);
  }
  return share != 0.0 && zero / share * (2.0 * with_sine + zero / share * of_sine) < 0.0;
}

}  // namespace

AgainstReference against_reference(const CampaignInput& input, ResidualChannel& channel, const Selection& selection, unsigned threads) {
  // where the claims stand on their own, what the rig adds beside them is the noise of the reference, in its size too, and they lose nothing
  constexpr double kKept = 0.3;    // of a claim's log evidence
  constexpr double kAgrees = 0.2;  // of the misfit's size
  AgainstReference out;
  // a push from the side may come to the reference alone: it is the rig's in any case
  const auto within = [](const ChosenEffect& c) { return !c.between && (c.kind->side == "sensor" || c.kind->side == "instrument"); };
  if (std::ranges::none_of(input.records, [](const RecordInput& r) { return !r.rig_force_N.empty(); }) || std::ranges::none_of(selection.chosen, within)) return out;
  const SpareRoom room(channel);
  const EffectKind kind = rig_misfit(input.has_theta);
  const EffectForm& form = kind.forms.front();
  place_candidate(channel, {&kind, &form, {}, 0, static_cast<int>(form.strength.size())});
  const Candidate placed = channel.candidates.back();
  fill_candidate(input, channel, placed, threads);

  const auto with_witness = [&](std::vector<int> columns) {
    columns.push_back(placed.first);
    if (placed.count > 1) {
      std::vector<int> turned = columns;
      turned.push_back(placed.first + 1);
      MixedFit fit = fit_mixed(channel.problem, turned, &selection.claimed, 12, RecordUse::all_records);
      if (fit.valid && rig_shows_angle_zero(channel, placed, fit)) return fit;
    }
    return fit_mixed(channel.problem, columns, &selection.claimed, 12, RecordUse::all_records);
  };
  // what takes the evidence of claims away has about as much of its own; most campaigns end here
  constexpr double kAsMuch = 0.5;
  double least = selection.claimed.log_evidence - selection.base.log_evidence;
  for (const ChosenEffect& c : selection.chosen)
    if (within(c) && c.unique > 0.0) least = std::min(least, c.unique);  // of one alone it is not asked
  if (!(with_witness(selection.base.columns).log_evidence - selection.base.log_evidence > kAsMuch * least)) return out;

  struct Beside {
    MixedFit without, with;  ///< the witness
    double share = 0.0;
  };
  const auto beside = [&](const std::vector<int>& columns) {
    Beside b{fit_mixed(channel.problem, columns, &selection.claimed, 12, RecordUse::all_records), with_witness(columns)};
    if (b.with.valid) b.share = b.with.strength_of(placed.first) * channel.gain_of_unit / b.with.coefficient[0];
    return b;
  };
  const Beside claimed = beside(selection.claimed.columns);
  const auto is_needless = [&](const auto& is_asked) {
    std::vector<int> others = selection.base.columns;
    for (const ChosenEffect& c : selection.chosen)
      if (!is_asked(c)) add_columns(others, columns_of(channel, c));
    const Beside b = beside(others);
    if (!b.without.valid || !b.with.valid || !claimed.with.valid || !(std::abs(b.share - 1.0) < kAgrees)) return false;
    if (claimed.with.log_evidence - b.with.log_evidence >= kKept * (claimed.without.log_evidence - b.without.log_evidence)) return false;
    out.share = b.share;
    return true;
  };
  const bool all = is_needless(within);
  for (const ChosenEffect& c : selection.chosen)
    if (within(c) && (all || is_needless([&](const ChosenEffect& o) { return &o == &c; }))) out.effects.push_back(c.kind->name);
  return out;
}

void withdraw_against_reference(const AgainstReference& against, Diagnosis& out) {
  if (against.effects.empty()) return;
  for (Finding& f : out.findings)
    if (!f.of_samples() && (std::ranges::find(against.effects, f.effect) != against.effects.end() || (f.of_reference() && !f.between_records)))
      f.limit(kWithdrawn, "the output and the rig agree about it, and the reference alone departs from both");
  out.notes.push_back(fmt::format("the reference itself is off: what the output misses of it ({}) is what it has too much by the rig's law, in the same size ({:.2f} times)",
                                  fmt::join(against.effects, ", "), against.share));
}

}  // namespace forcegate::diagnose
