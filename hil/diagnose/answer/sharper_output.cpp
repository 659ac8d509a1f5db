#include "hil/diagnose/answer/sharper_output.h"

#include <algorithm>
#include <optional>

#include "hil/diagnose/answer/remainder.h"
#include "hil/diagnose/answer/residual_map.h"
#include "hil/diagnose/base/judge.h"
#include "hil/diagnose/choose/reference_latency.h"

namespace forcegate::diagnose {

namespace {

// Mean squares above the noise, of the span.
struct Leads {
  double without = 0.0, with_one = 0.0, with_all = 0.0;
  MixedFit fit_without;
};

std::optional<Leads> leads_beside(const ResidualChannel& channel, const MixedFit& base) {
  std::vector<int> others = base.columns, leads;
  for (const Candidate& c : channel.candidates)
    if (is_allowed_lead(c)) {
      std::erase(others, c.first);
      if (std::ranges::find(leads, c.first) == leads.end()) leads.push_back(c.first);
    }
  if (leads.empty()) return std::nullopt;
  const auto fit_with = [&](const std::vector<int>& more) {
    std::vector<int> columns = others;
    columns.insert(columns.end(), more.begin(), more.end());
    return fit_mixed(channel.problem, columns, &base, 20);
  };
  const MixedFit with_all = fit_with(leads);
  Leads out{.fit_without = fit_with({})};
  if (!out.fit_without.valid || !with_all.valid) return std::nullopt;
  out.without = out.with_one = excess_mean_square(channel, out.fit_without);
  out.with_all = excess_mean_square(channel, with_all);
  for (const int lead : leads)
    if (const MixedFit with = fit_with({lead}); with.valid) out.with_one = std::min(out.with_one, excess_mean_square(channel, with));
  return out;
}

}  // namespace

void tell_sharper_output(const Workspace& w, const Selection& selection, unsigned threads, Diagnosis& out) {
  constexpr double kLeast = 0.001;  // of the span
  constexpr double kOfLeads = 0.5, kMost = 0.5;
  const std::optional<Leads> leads = leads_beside(w.output, selection.base);
  if (!leads) return;
  const double sharper = leads->with_one - leads->with_all, all = leads->without - leads->with_all;
  if (sharper < kLeast * kLeast || sharper < kOfLeads * all || all < kMost * leads->without) return;
  for (Finding& f : out.findings)
    if (f.claimed() && f.of_output() && !f.between_records)
      f.limit(kWithdrawn, "that the output is sharper than the reference, which no effect of the library makes, explains as much");
  if (std::ranges::any_of(out.findings, &Finding::claimed)) out.residual_unknown = true;
  else out.verdict = DiagnosisVerdict::unknown;
  if (out.depends_on.empty()) out.depends_on = depends_on(residual_maps(w, residual_rows(w.output, leads->fit_without), threads));
  out.follows.emplace_back("how sharply the force bends: the output is sharper than the reference and does not lead it, as beside a mass between the two or a reference smoothed on both sides");
}

}  // namespace forcegate::diagnose
