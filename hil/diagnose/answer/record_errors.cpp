#include "hil/diagnose/answer/record_errors.h"

#include <algorithm>
#include <cmath>

#include "hil/diagnose/base/judge.h"
#include "hil/diagnose/between/foretold.h"

namespace forcegate::diagnose {

namespace {

// 1: it is among those that the mean error is of.
std::vector<char> records_that_count(const Workspace& w, const Selection& selection, bool levels) {
  std::vector<char> out;
  for (const RecordGram& g : w.output.problem.records) out.push_back(w.judges != JudgedBy::heldout || g.heldout ? 1 : 0);
  if (!levels) return out;
  for (const ChosenEffect& chosen : selection.chosen) {
    const std::vector<char> foretold = foretold_records(w.output, chosen.variant, w.judges);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = out[i] != 0 && foretold[i] != 0 ? 1 : 0;
  }
  return out;
}

void tell_unforetold(const Workspace& w, const std::vector<char>& counts, Diagnosis& out) {
  std::string names;
  for (std::size_t i = 0; i < counts.size(); ++i)
    if (counts[i] == 0 && (w.judges != JudgedBy::heldout || w.output.problem.records[i].heldout)) names += (names.empty() ? "" : ", ") + w.output.problem.records[i].name;
  if (!names.empty()) out.notes.push_back("no other record has the mounting of " + names + ": nothing foretells it, and the error is that of the others");
}

}  // namespace

void add_records(const Workspace& w, const Selection& selection, Diagnosis& out) {
  const ResidualChannel& channel = w.output;
  const MixedFit &base = selection.base, &final = selection.claimed;
  Judged before = judge(channel, base, base, w.judges), after = judge(channel, final, base, w.judges);
  // what a claim changes between the records, their own gains and zeros would hide
  out.levels = std::any_of(out.findings.begin(), out.findings.end(),
                           [](const Finding& f) { return f.claimed() && !f.of_samples() && f.between_records; });
  if (out.levels) {
    before.adapted = judge_levels(channel, base, base, w.judges);
    after.adapted = judge_levels(channel, final, base, w.judges);
  }
  const double s = channel.scale;
  // set aside, too few for a claim, they are no error of the model; claimed, they are what the error falls by
  const bool counts_bad = std::ranges::any_of(out.findings, [](const Finding& f) { return f.of_samples() && f.claimed(); });
  for (std::size_t i = 0; i < channel.problem.records.size(); ++i) {
    const RecordGram& g = channel.problem.records[i];
    const double bad = counts_bad && i < w.health.size() ? w.health[i].bad_mean_square_V2 : 0.0;
    RecordError e;
    e.record = g.name;
    e.kind = w.input.records[i].kind;
    e.heldout = g.heldout;
    e.before = std::sqrt(before.adapted[i] * s * s + bad);
    e.after = s * std::sqrt(std::max(after.adapted[i], 0.0));
    e.plain_before = std::sqrt(before.plain[i] * s * s + bad);
    e.plain_after = s * std::sqrt(std::max(after.plain[i], 0.0));
    e.floor = std::min(w.noise_V[i], e.after);
    e.explainable = e.before > 0.0 ? std::clamp(1.0 - std::pow(e.floor / e.before, 2), 0.0, 1.0) : 0.0;
    out.records.push_back(e);
  }
  const std::vector<char> counts = records_that_count(w, selection, out.levels);
  tell_unforetold(w, counts, out);
  double n = 0.0, a = 0.0, b = 0.0, pa = 0.0, pb = 0.0, f = 0.0;
  for (std::size_t i = 0; i < out.records.size(); ++i)
    if (const RecordError& e = out.records[i]; counts[i] != 0) {
      n += 1.0;
      b += e.before * e.before;
      a += e.after * e.after;
      pb += e.plain_before * e.plain_before;
      pa += e.plain_after * e.plain_after;
      f += e.floor * e.floor;
    }
  n = std::max(n, 1.0);
  out.error_before = std::sqrt(b / n);
  out.error_after = std::sqrt(a / n);
  out.plain_before = std::sqrt(pb / n);
  out.plain_after = std::sqrt(pa / n);
  out.floor = std::sqrt(f / n);
  out.errors["U_plain"] = {out.plain_before, out.plain_after, out.unit};
  const bool of_output = std::ranges::any_of(out.findings, [](const Finding& one) { return one.claimed() && one.of_output(); });
  if (of_output && w.judges == JudgedBy::heldout && is_described_worse(out))
    out.notes.emplace_back("the held-out records are described worse with what is claimed than without: the claim rests on all records together, and a model that "
                           "takes it in is no better for these; more records tell");
}

bool most_stays(const Workspace& w, const Diagnosis& d) {
  constexpr double kMost = 0.5, kSome = 0.9;  // of the mean square above the floor: what acts on a few rows hardly changes it
  constexpr double kMatters = 0.0015;  // of the span
  const auto is_within = [](const Finding& f) { return f.claimed() && f.of_output() && !f.between_records; };
  if (d.levels || std::ranges::none_of(d.findings, is_within)) return false;
  const auto above_floor = [&](double error) { return error * error - d.floor * d.floor; };
  const double stays = above_floor(d.error_after) / std::max(1e-300, above_floor(d.error_before));
  return d.error_after > std::max(kFarAboveNoise * d.floor, kMatters * w.output.scale) && stays > kMost && stays < kSome;
}

void add_steps(const Workspace& w, const Selection& selection, Diagnosis& out) {
  const ResidualChannel& channel = w.output;
  const auto error = [&](const MixedFit& fit) {
    auto square = out.levels ? judge_levels(channel, fit, selection.base, w.judges) : judge(channel, fit, selection.base, w.judges).adapted;
    for (const ChosenEffect& chosen : selection.chosen)
      if (out.levels) set_unforetold_aside(channel, chosen.variant, w.judges, square);
    return channel.scale * std::sqrt(judged(channel, square, w.judges));
  };
  out.steps = {{"", error(selection.base)}};
  for (const ChosenEffect& chosen : selection.chosen) out.steps.push_back({chosen.kind->name, error(chosen.fit)});
}

}  // namespace forcegate::diagnose
