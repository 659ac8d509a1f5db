#include "hil/diagnose/refit/fitted_effects.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <span>

#include "hil/diagnose/base_errors.h"
#include "hil/diagnose/candidates/signatures.h"
#include "hil/diagnose/candidates/user_candidates.h"
#include "hil/diagnose/choose/further_forms.h"
#include "hil/diagnose/choose/reference_latency.h"
#include "hil/diagnose/choose/screen.h"
#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/refit/best_form.h"
#include "hil/diagnose/refit/joint_shapes.h"
#include "hil/diagnose/refit/seen_terms.h"

namespace forcegate::diagnose {

namespace {

constexpr int kRounds = 15;

// Of one effect.
struct Forms {
  std::vector<int> variants, columns;
};

// Where the workspace was prepared with it; nothing, where it was not.
Forms standing_forms(ResidualChannel& channel, const Model& at, const std::string& name) {
  Forms out;
  const auto own = std::ranges::find(at.user_effects, name, &UserEffect::name);
  const bool own_stands = own != at.user_effects.end() && is_fitted(*own);
  for (std::size_t k = 0; k < channel.candidates.size(); ++k) {
    const Candidate& c = channel.candidates[k];
    if (c.kind->name != name || !(c.of_model || own_stands)) continue;
    out.variants.push_back(static_cast<int>(channel.variants.size()));
    channel.variants.push_back({static_cast<int>(k), columns_of(c)});
    add_columns(out.columns, columns_of(c));
  }
  return out;
}

Result<std::pair<Forms, MixedFit>> best_beside(Workspace& w, const Model& at, const std::string& name, const std::vector<int>& present, const MixedFit& beside,
                                               unsigned threads, std::vector<std::string>& notes) {
  const auto best = best_form(w, name, present, &beside, threads);
  // where the model stands is a start as good as any: a fit ends no worse than it began
  std::optional<WrittenForms> written = written_forms(w, at.effects, name, present, beside, threads);
  if (!best && !written) return Unexpected(best.error());
  WrittenForms taken;
  std::vector<std::string> told, told_of_written;
  if (best) {
    std::vector<int> all = present;
    std::ranges::copy(seen_columns(w, best->variant, told), std::back_inserter(all));
    taken = {{best->variant}, {}, fit_mixed(w.output.problem, all, &best->fit, kRounds)};
    if (const Candidate& of = candidate_of(w.output, best->variant); !moves_levels(of))
      for (const int v : further_forms(w.output, *of.kind, all, taken.fit)) taken.variants.push_back(v);
    taken.columns.assign(all.begin() + std::ssize(present), all.end());
    leave_out_unseen(w, present, taken, told);
  }
  if (written) leave_out_unseen(w, present, *written, told_of_written);
  const bool stays = written && (!taken.fit.valid || written->fit.log_evidence > taken.fit.log_evidence);
  if (stays) taken = *std::move(written);
  for (std::string& note : stays ? told_of_written : told)
    if (std::ranges::find(notes, note) == notes.end()) notes.push_back(std::move(note));
  return std::pair{Forms{std::move(taken.variants), std::move(taken.columns)}, std::move(taken.fit)};
}

bool stand_together(const Candidate& a, const Candidate& b) {
  constexpr double kSame = 0.02;
  return a.kind == b.kind && a.form == b.form && std::ranges::equal(a.shape, b.shape, [](double x, double y) { return std::abs(x - y) <= kSame * std::abs(y); });
}

// Two of one form that have come to one shape are one, with strengths that nothing tells apart.
void drop_twins(Workspace& w, Forms& forms, MixedFit& fit) {
  const ResidualChannel& channel = w.output;
  for (std::size_t k = 1; k < forms.variants.size(); ++k) {
    const Candidate& own = candidate_of(channel, forms.variants[k]);
    const auto before = std::span(forms.variants).first(k);
    if (std::ranges::none_of(before, [&](int v) { return stand_together(candidate_of(channel, v), own); })) continue;
    const auto is_own = [&](int column) { return own.owns(column); };
    std::vector<int> columns = fit.columns;
    std::erase_if(columns, is_own);
    MixedFit without = fit_mixed(channel.problem, columns, &fit, kRounds, fit.use);
    if (!without.valid) return;
    fit = std::move(without);
    std::erase_if(forms.columns, is_own);
    forms.variants.erase(forms.variants.begin() + static_cast<std::ptrdiff_t>(k--));
  }
}

Result<FittedEffects> fit_beside_each_other(Workspace& w, const Model& at, const std::vector<std::string>& names, MixedFit law, unsigned threads,
                                            std::vector<std::string>& notes) {
  if (!law.valid) return fail(ErrorCode::config, "the records do not determine the model", w.input.name, "more records, or records with more force");
  std::vector<Forms> forms;
  for (const std::string& name : names) forms.push_back(standing_forms(w.output, at, name));
  const auto columns_but = [&](std::size_t left_out) {
    std::vector<int> out = law.columns;
    for (std::size_t k = 0; k < forms.size(); ++k)
      if (k != left_out) add_columns(out, forms[k].columns);
    return out;
  };
  const bool adds = std::ranges::any_of(forms, [](const Forms& f) { return f.columns.empty(); });
  MixedFit now = law;
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (adds && !forms[k].columns.empty()) continue;
    const std::vector<int> present = columns_but(k);
    const MixedFit beside = present == law.columns ? law : fit_mixed(w.output.problem, present, &now, kRounds);
    FORCEGATE_TRY(auto best, best_beside(w, at, names[k], present, beside.valid ? beside : law, threads, notes));
    forms[k] = std::move(best.first);
    now = std::move(best.second);
  }
  const auto all_variants = [&] {
    std::vector<int> out;
    for (const Forms& f : forms) out.insert(out.end(), f.variants.begin(), f.variants.end());
    return out;
  };
  if (now.valid) move_together(w, all_variants(), now, threads);
  for (Forms& f : forms)
    if (now.valid) drop_twins(w, f, now);
  FittedEffects out;
  out.variants = all_variants();
  out.chain.push_back(std::move(law));
  std::vector<int> present = out.law().columns;
  for (std::size_t k = 0; k < names.size(); ++k) {
    add_columns(present, forms[k].columns);
    if (present == now.columns) out.chain.push_back(std::move(now));
    else out.chain.push_back(fit_mixed(w.output.problem, present, k + 1 < names.size() ? &out.all() : &now, kRounds));
    out.columns.emplace_back(names[k], std::move(forms[k].columns));
  }
  return out;
}

}  // namespace

// What a diagnosis carries along, or sets aside where it shows beside the effects only, is no error of the model here either.
Result<FittedEffects> fit_effects(Workspace& w, const Model& at, const std::vector<std::string>& names, bool leads, unsigned threads, std::vector<std::string>& notes) {
  const bool forgives = !leads && std::ranges::find(names, kLatencyEffect) == names.end();
  FORCEGATE_TRY(FittedEffects out, fit_beside_each_other(w, at, names, law_beside(w, {}, forgives, notes), threads, notes));
  if (!forgives || names.empty() || !out.law().columns.empty() || !out.all().valid) return out;
  const MixedFit beside = forgive_late_reference(w, out.all(), notes);
  if (beside.columns.size() == out.all().columns.size()) return out;
  take_off_output(w.output, strengths_of_leads(w.output, beside.columns, beside));
  return fit_beside_each_other(w, at, names, law_beside(w, {}, false, notes), threads, notes);
}

}  // namespace forcegate::diagnose
