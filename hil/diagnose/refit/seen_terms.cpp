#include "hil/diagnose/refit/seen_terms.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/base/plain_number.h"

namespace forcegate::diagnose {

namespace {

double longest_record_s(const CampaignInput& input) {
  double out = 0.0;
  for (const RecordInput& r : input.records) out = std::max(out, r.duration_s);
  return out;
}

}  // namespace

bool is_seen(const EffectForm& form, std::size_t strength, const CampaignInput& input) {
  constexpr double kOfRecord = 2.0;
  return form.memory_s.empty() || form.memory_s[strength] <= kOfRecord * longest_record_s(input);
}

void note_unseen(const EffectKind& kind, const EffectForm& form, const CampaignInput& input, std::vector<std::string>& notes) {
  double least_s = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < form.memory_s.size(); ++k)
    if (!is_seen(form, k, input)) least_s = std::min(least_s, form.memory_s[k]);
  if (std::isinf(least_s)) return;
  const std::string note = fmt::format("{}: terms of {} s and longer are left out, since the longest record has {} s: a longer one tells them", kind.name, plain_number(least_s),
                                       plain_number(longest_record_s(input)));
  if (std::ranges::find(notes, note) == notes.end()) notes.push_back(note);
}

std::vector<int> seen_columns(const Workspace& w, int variant, std::vector<std::string>& notes) {
  const Candidate& c = candidate_of(w.output, variant);
  const std::vector<int> all = columns_of(w.output, variant);
  std::vector<int> out = all;
  std::erase_if(out, [&](int column) { return !is_seen(*c.form, static_cast<std::size_t>(column - c.first), w.input); });
  if (out.empty()) return all;
  if (out.size() < all.size()) note_unseen(*c.kind, *c.form, w.input, notes);
  return out;
}

void leave_out_unseen(const Workspace& w, const std::vector<int>& present, WrittenForms& forms, std::vector<std::string>& notes) {
  constexpr int kRounds = 15;
  const auto unseen = [&](int column) {
    return std::ranges::any_of(forms.variants, [&](int v) {
      const Candidate& c = candidate_of(w.output, v);
      return c.owns(column) && !is_seen(*c.form, static_cast<std::size_t>(column - c.first), w.input);
    });
  };
  WrittenForms out = forms;
  std::erase_if(out.columns, unseen);
  if (out.columns.empty() || out.columns.size() == forms.columns.size()) return;
  std::vector<int> all = present;
  all.insert(all.end(), out.columns.begin(), out.columns.end());
  out.fit = fit_mixed(w.output.problem, all, &forms.fit, kRounds, forms.fit.use);
  if (!out.fit.valid) return;
  for (const int v : forms.variants) note_unseen(*candidate_of(w.output, v).kind, *candidate_of(w.output, v).form, w.input, notes);
  const auto is_in = [&](int column) { return std::ranges::find(out.columns, column) != out.columns.end(); };
  std::erase_if(out.variants, [&](int v) { return std::ranges::none_of(columns_of(w.output, v), is_in); });
  forms = std::move(out);
}

}  // namespace forcegate::diagnose
