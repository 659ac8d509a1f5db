#include "hil/diagnose/answer/sharper_output.h"

#include <algorithm>
#include <vector>

#include "hil/diagnose/answer/remainder.h"
#include "hil/diagnose/answer/residual_map.h"
#include "hil/diagnose/base/judge.h"
#include "hil/diagnose/choose/reference_latency.h"

namespace forcegate::diagnose {

namespace {

constexpr int kIterations = 20;

// Columns of the model without leads, and all leads that there are.
struct Columns {
  std::vector<int> others, leads;
};

Columns columns_of(const ResidualChannel& channel, const MixedFit& base) {
  Columns out{.others = base.columns, .leads = {}};
  add_leads(channel, out.leads);
  std::erase_if(out.others, [&](int column) { return std::ranges::find(out.leads, column) != out.leads.end(); });
  return out;
}

}  // namespace

void tell_sharper_output(const Workspace& w, const Selection& selection, unsigned threads, Diagnosis& out) {
  constexpr double kLeast = 0.001;  // of the span
  constexpr double kOfLeads = 0.5, kMost = 0.5;
  const ResidualChannel& channel = w.output;
  const Columns columns = columns_of(channel, selection.base);
  if (columns.leads.empty()) return;
  const auto fit_with = [&](const std::vector<int>& leads) {
    std::vector<int> all = columns.others;
    all.insert(all.end(), leads.begin(), leads.end());
    return fit_mixed(channel.problem, all, &selection.base, kIterations);
  };
  const MixedFit without = fit_with({}), with_all = fit_with(columns.leads);
  if (!without.valid || !with_all.valid) return;
  // mean squares above the noise
  const double fails_by = excess_mean_square(channel, without), left = excess_mean_square(channel, with_all), taken = fails_by - left;
  if (taken < kLeast * kLeast || taken < kMost * fails_by) return;
  double left_by_one = fails_by;
  for (const int lead : columns.leads)
    if (const MixedFit with = fit_with({lead}); with.valid) left_by_one = std::min(left_by_one, excess_mean_square(channel, with));
  const double sharper = left_by_one - left;
  if (sharper < kLeast * kLeast || sharper < kOfLeads * taken) return;
  for (Finding& f : out.findings)
    if (f.claimed() && f.of_output() && !f.between_records)
      f.limit(kWithdrawn, "that the output is sharper than the reference, which no effect of the library makes, explains as much");
  if (std::ranges::any_of(out.findings, &Finding::claimed)) out.residual_unknown = true;
  else out.verdict = DiagnosisVerdict::unknown;
  // what was forgiven shows where it fails
  out.maps = residual_maps(w, residual_rows(channel, without), threads);
  if (out.depends_on.empty()) out.depends_on = depends_on(out.maps);
  out.follows.emplace_back("how sharply the force bends: the output is sharper than the reference and does not lead it, as beside a mass between the two or a reference smoothed on both sides");
}

}  // namespace forcegate::diagnose
