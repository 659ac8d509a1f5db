#include "hil/diagnose/refit/added_effect.h"

#include <algorithm>
#include <cmath>

#include "hil/diagnose/answer/pictures.h"
#include "hil/diagnose/answer/record_errors.h"
#include "hil/diagnose/answer/residual_map.h"
#include "hil/diagnose/base_errors.h"
#include "hil/diagnose/candidates/model_effects.h"
#include "hil/diagnose/choose/further_forms.h"
#include "hil/diagnose/refit/best_form.h"

namespace forcegate::diagnose {

namespace {

Result<ChosenEffect> choose(Workspace& w, const MixedFit& base, const std::string& effect, unsigned threads) {
  FORCEGATE_TRY(const VariantScore best, best_form(w, effect, base.columns, &base, threads));
  const Candidate& candidate = candidate_of(w.output, best.variant);
  ChosenEffect out;
  out.kind = candidate.kind;
  out.variant = best.variant;
  out.between = moves_levels(candidate);
  std::vector<int> present = base.columns;
  add_columns(present, columns_of(w.output, best.variant));
  out.fit = fit_mixed(w.output.problem, present, &best.fit, 15);
  if (out.fit.valid && !out.between) out.further = further_forms(w.output, *out.kind, present, out.fit);
  if (!out.fit.valid) return fail(ErrorCode::config, "the records do not determine the model with " + effect, w.input.name);
  out.columns.assign(present.begin() + static_cast<std::ptrdiff_t>(base.columns.size()), present.end());
  return out;
}

// The law with what the model had before: of one that has the effect already, without its columns.
MixedFit base_without(const Workspace& w, const EngineOptions& before, const std::string& effect, std::vector<std::string>& notes) {
  std::vector<int> columns = model_columns(w.output, before);
  for (const Candidate& c : w.output.candidates)
    if (c.of_model && c.kind->name == effect) std::erase_if(columns, [&](int j) { return c.owns(j); });
  return law_beside(w, columns, true, notes);
}

}  // namespace

void take_after(const Diagnosis& from, Diagnosis& to) {
  if (from.levels != to.levels || from.judged_by != to.judged_by || from.records.size() != to.records.size()) return;
  for (std::size_t k = 0; k < to.records.size(); ++k) {
    RecordError& r = to.records[k];
    r.after = from.records[k].after;
    r.plain_after = from.records[k].plain_after;
    r.floor = from.records[k].floor;
  }
  to.error_after = from.error_after;
  to.plain_after = from.plain_after;
  to.floor = from.floor;
  to.errors["U_plain"].after = from.plain_after;
  to.maps_after = from.maps_after;
  to.overlays = from.overlays;
  to.repeatability = from.repeatability;
}

Result<Diagnosis> show_added(Workspace& w, const EngineOptions& before, const std::string& effect) {
  Diagnosis out = answer_about(w, before.model_name);
  out.judged_by = w.judges;
  out.verdict = DiagnosisVerdict::known;
  Search search;
  Selection& selection = search.output;
  selection.base = base_without(w, before, effect, out.notes);
  if (!selection.base.valid) return fail(ErrorCode::config, "the records do not determine the model", w.input.name);
  FORCEGATE_TRY(ChosenEffect chosen, choose(w, selection.base, effect, before.threads));
  selection.claimed = selection.final = chosen.fit;
  Finding f = finding_about(*chosen.kind, out.unit);
  f.probability = 1.0;
  out.findings.push_back(std::move(f));
  selection.chosen.push_back(std::move(chosen));
  add_records(w, selection, out);
  const auto residual = residual_rows(w.output, selection.base), left = residual_rows(w.output, selection.claimed);
  out.maps = residual_maps(w, residual, before.threads);
  out.maps_after = residual_maps(w, left, before.threads);
  const auto sd = [&](int k) { return std::sqrt(selection.claimed.variance[k]); };
  out.repeatability = {sd(0), sd(1) * w.output.scale, sd(2), sd(3)};
  add_pictures(w, search, selection.claimed, before.threads, out);
  return out;
}

}  // namespace forcegate::diagnose
