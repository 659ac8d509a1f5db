#include "hil/diagnose/answer/guessed_effects.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "hil/diagnose/choose/screen.h"

namespace forcegate::diagnose {

void tell_guessed_effects(const Workspace& w, const MixedFit& fit, double first_gain, Diagnosis& out) {
  constexpr double kLeastFall = 0.1;
  const ResidualChannel& channel = w.output;
  for (const Candidate& c : channel.candidates) {
    if (!c.is_guess) continue;
    std::vector<int> others;
    std::ranges::remove_copy_if(fit.columns, std::back_inserter(others), [&](int column) { return c.owns(column); });
    if (others.size() == fit.columns.size()) continue;
    const MixedFit without = fit_mixed(channel.problem, others, &fit, 12, fit.use);
    if (!without.valid) continue;
    const double gain = fit.log_evidence - without.log_evidence;
    const double left = excess_mean_square(channel, fit), before = excess_mean_square(channel, without);
    if (gain < first_gain || !(left < (1.0 - kLeastFall) * before)) {
      const std::string guess = "the model's " + c.kind->name + " was a guess";
      std::erase_if(out.notes, [&](const std::string& note) { return note.starts_with(guess); });  // where it was moved to, too
      out.notes.push_back(guess + ", and these records do not show it");
      continue;
    }
    if (std::ranges::any_of(out.findings, [&](const Finding& o) { return o.effect == c.kind->name; })) continue;  // two forms of one effect
    Finding f = finding_about(*c.kind, channel);
    f.form = c.form->name;
    f.probability = kNoClaim;
    f.in_model = true;
    std::string values;
    for (std::size_t k = 0; k < c.shape.size(); ++k) values += fmt::format(", {} = {:.3g} {}", c.form->shape[k].name, c.shape[k], c.form->shape[k].unit);
    f.evidence = c.kind->summary + "; the model has it already, as a guess that these records bear out" + values + ": it is not missing";
    const auto weaker = std::ranges::find_if(out.findings, [&](const Finding& o) { return o.probability < f.probability; });
    out.findings.insert(weaker, std::move(f));
  }
}

}  // namespace forcegate::diagnose
