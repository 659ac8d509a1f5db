#include "hil/app/diagnose/with_claims.h"

#include <algorithm>
#include <cmath>

#include "hil/app/model/model_input.h"
#include "hil/diagnose/base_errors.h"
#include "hil/trace/trace.h"

namespace forcegate {

std::optional<diagnose::Refit> with_claims(const diagnose::Workspace& w, const Model& model, const Diagnosis& d, unsigned threads) {
  std::optional<diagnose::Refit> out;
  for (const Finding& f : d.findings) {
    if (!f.claimed() || !f.of_output()) continue;
    const Model start = out ? out->model : model;
    if (auto refit = diagnose::refit_prepared_rows(w, engine_options(start, threads), start, f.effect)) out = *std::move(refit);
  }
  return out;
}

bool is_plain_refitted(const diagnose::Workspace& w, const Diagnosis& d) {
  return w.law.decays && !d.levels && d.judged_by != JudgedBy::whole && std::ranges::any_of(w.input.records, [](const RecordInput& r) { return r.dynamic; });
}

void tell_plain_as_refitted(const diagnose::Workspace& w, const diagnose::EngineOptions& options, const std::optional<diagnose::Refit>& after, Diagnosis& d) {
  const std::vector<double> before = diagnose::plain_errors_V(w, options);
  const bool untold = !after && std::ranges::any_of(d.findings, [](const Finding& f) { return f.claimed() && f.of_output(); });
  if (before.size() != d.records.size() || (after && after->plain_after_of_record.size() != d.records.size())) return;
  const bool counts_bad = std::ranges::any_of(d.findings, [](const Finding& f) { return f.of_samples() && f.claimed(); });
  double square_before = 0.0, square_after = 0.0, n = 0.0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    RecordError& r = d.records[k];
    r.plain_after = after ? after->plain_after_of_record[k] : untold ? kMissing : before[k];
    r.plain_before = counts_bad && k < w.health.size() ? std::hypot(before[k], std::sqrt(w.health[k].bad_mean_square_V2)) : before[k];
    if (d.judged_by == JudgedBy::heldout && !r.heldout) continue;
    square_before += r.plain_before * r.plain_before;
    square_after += r.plain_after * r.plain_after;
    n += 1.0;
  }
  d.plain_before = std::sqrt(square_before / std::max(n, 1.0));
  d.plain_after = std::sqrt(square_after / std::max(n, 1.0));
  d.errors["U_plain"] = {d.plain_before, d.plain_after, d.unit};
}

}  // namespace forcegate
