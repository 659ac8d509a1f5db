#include "hil/diagnose/engine.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/base/plain_number.h"
#include "hil/diagnose/answer/capacitance_witness.h"
#include "hil/diagnose/answer/claim_unloaded_zero.h"
#include "hil/diagnose/answer/decay_course.h"
#include "hil/diagnose/answer/findings.h"
#include "hil/diagnose/answer/guessed_effects.h"
#include "hil/diagnose/answer/late_drive.h"
#include "hil/diagnose/answer/moving_zero.h"
#include "hil/diagnose/answer/opens_in_places.h"
#include "hil/diagnose/answer/out_of_step.h"
#include "hil/diagnose/answer/null_calibration.h"
#include "hil/diagnose/answer/pictures.h"
#include "hil/diagnose/answer/ranking.h"
#include "hil/diagnose/answer/record_errors.h"
#include "hil/diagnose/answer/remainder.h"
#include "hil/diagnose/answer/reservation.h"
#include "hil/diagnose/answer/sharper_output.h"
#include "hil/diagnose/answer/steady_line.h"
#include "hil/diagnose/answer/uneven_wheel.h"
#include "hil/diagnose/answer/verdict.h"
#include "hil/diagnose/answer/wide_scatter.h"
#include "hil/diagnose/answer/withdrawals.h"
#include "hil/diagnose/base/record_spread.h"
#include "hil/diagnose/base/repeatability.h"
#include "hil/diagnose/base_errors.h"
#include "hil/diagnose/base/whole_recording.h"
#include "hil/diagnose/choose/outdone.h"
#include "hil/diagnose/choose/search.h"
#include "hil/diagnose/raw/sent_on_change.h"
#include "hil/model/lagged_channel.h"

namespace forcegate::diagnose {

namespace {

Finding of_raw_samples(const HealthClaim& claim, const std::string& unit) {
  const EffectKind* kind = EffectRegistry::instance().find(claim.effect);
  Finding out = finding_about(*kind, unit, ShownIn::samples);  // of its errors, which are the output's
  out.probability = claim.probability;
  out.evidence = claim.evidence;
  out.parameters.push_back({claim.parameter, claim.value, claim.u, claim.unit});
  out.form = kOfSamples;
  out.samples = claim.samples;
  return out;
}

// The error of F_ref against the rig's own law.
ErrorPair errors_of_rig(const Workspace& w, const Selection& rig) {
  const bool levels = std::ranges::any_of(rig.chosen, [](const ChosenEffect& c) { return c.between; });
  const auto error = [&](const MixedFit& fit) {
    const auto square = levels ? judge_levels(w.rig, fit, rig.base, w.judges) : judge(w.rig, fit, rig.base, w.judges).adapted;
    return w.rig.scale * std::sqrt(judged(w.rig, square, w.judges));
  };
  return {error(rig.base), error(rig.claimed.valid ? rig.claimed : rig.final), "N", levels};
}

bool rig_is_judged(const Workspace& w, const Search& search) { return w.has_rig && search.rig.base.valid; }

// What every channel and the raw samples have to say, in no order yet.
void collect_findings(const Workspace& w, const Search& search, const Remainder& rest, Diagnosis& out) {
  constexpr double kHalf = 0.5, kNamedEnough = 0.6, kOfRig = 0.51;
  const bool named_enough = rest.explained > kHalf || !rest.structured();
  add_findings(w, w.output, search.output, named_enough ? std::max(rest.explained, kNamedEnough) : rest.explained, out);
  out.findings.insert(out.findings.end(), search.suspicions.begin(), search.suspicions.end());
  for (Finding& f : out.findings)
    if (f.effect == "reference_drift" && f.of_output() && w.rig_shows != RigShows::zero_of_records && f.form != "course_over_rig") decide_by_capacitance(w.input, f);
  for (const HealthClaim& claim : w.raw_claims) out.findings.push_back(of_raw_samples(claim, w.output.unit));
  if (rig_is_judged(w, search)) {
    const Selection& rig = search.rig;
    add_findings(w, w.rig, rig, std::max(rig.excess_before > 0.0 ? 1.0 - rig.excess_after / rig.excess_before : 1.0, kOfRig), out);
    if (!rig.chosen.empty()) out.errors["F"] = errors_of_rig(w, rig);
  }
  if (w.has_command && search.drive.base.valid) add_findings(w, w.command, search.drive, kNamedEnough, out);
  if (auto contact = contact_that_opens(w, out.findings)) {
    std::erase_if(out.findings, [&](const Finding& f) { return f.effect == contact->effect; });
    // of the records in which it opens; what the search took and did not claim is no answer beside it
    if (std::ranges::none_of(out.findings, [](const Finding& f) { return f.claimed() && f.of_reference(); })) out.errors["F"] = {contact->error_before, contact->error_after, "N", false};
    out.findings.push_back(*std::move(contact));
  }
  if (auto late = listed_late_drive(w, out.findings)) out.findings.push_back(*std::move(late));
  if (auto shift = listed_out_of_step(w, search.output, out.findings)) out.findings.push_back(*std::move(shift));
  if (auto zero = listed_moving_zero(w, search.output, out.findings)) out.findings.push_back(*std::move(zero));
  share_among_timing(search.output, out.findings);
  if (!w.input.generic) leave_curves_to_larger_causes(out.findings);
  leave_spikes_to_codes(w, out.findings);
}

// One entry for each effect, claims first; of equally sure ones what explains more of the error first.
void put_in_order(std::vector<Finding>& findings) {
  std::map<std::string, double> most;
  for (const Finding& f : findings) most[f.unit] = std::max(most[f.unit], f.error_before);
  const auto rank = [&](const Finding& f) {
    const double of = most[f.unit], fall = of > 0.0 ? (f.error_before * f.error_before - f.error_after * f.error_after) / (of * of) : 0.0;
    const double sure = f.probability >= 0.8 ? 1.0 : f.claimed() ? std::floor(10.0 * f.probability) / 10.0 : f.probability;
    return std::pair{sure, f.of_samples() ? 0.0 : fall};
  };
  std::stable_sort(findings.begin(), findings.end(), [&](const Finding& a, const Finding& b) { return rank(a) > rank(b); });
  std::vector<Finding> unique;
  for (Finding& f : findings)
    if (std::ranges::none_of(unique, [&](const Finding& u) { return u.effect == f.effect; })) unique.push_back(std::move(f));
  findings = std::move(unique);
}

void tell_records_far_above(const Workspace& w, const Remainder& rest, Diagnosis& out) {
  constexpr std::size_t kNamed = 4;
  for (const RecordAbove& above : rest.records_far_above) out.far_above.push_back({w.input.records[above.record].name, above.times});
  const std::size_t n = out.far_above.size();
  const bool tells = out.verdict == DiagnosisVerdict::unknown ? rest.leaves_far_more() : out.verdict == DiagnosisVerdict::none && n > 0;
  if (!tells) return;
  std::string text;
  for (std::size_t k = 0; k < std::min(kNamed, n); ++k)
    text += fmt::format("{}{} ({})", k == 0 ? "" : ", ", out.far_above[k].record, so_many_times(out.far_above[k].times));
  if (n > kNamed) text += fmt::format(" and {} more", n - kNamed);
  out.notes.push_back("far above what their instruments may leave: " + text);
  if (out.verdict == DiagnosisVerdict::none && n == 1)
    out.notes.emplace_back("it is the only one, and what no other record shows is no claim: look at its page, and record the like again");
}

// What no claim between the records explains, and is far more than a specimen repeats to.
void tell_wide_scatter(const Workspace& w, const Selection& selection, Diagnosis& out) {
  if (w.input.single) return;
  const bool claimed = std::ranges::any_of(out.findings, [](const Finding& f) { return f.claimed() && f.between_records; });
  // a cause that is listed and not claimed explains nothing yet
  const bool listed = !claimed && std::ranges::any_of(selection.chosen, &ChosenEffect::between);
  std::vector<int> columns = selection.base.columns;
  for (const ChosenEffect& c : selection.chosen)
    if (!c.between) add_columns(columns, columns_of(w.output, c));
  const bool zeros_explained = std::ranges::any_of(out.findings, [](const Finding& f) { return f.claimed() && f.form == kUnloadedZero; });
  const std::optional<WideScatter> scatter = wide_scatter(w, listed ? fit_mixed(w.output.problem, columns, &selection.base, 18, RecordUse::all_records) : selection.final, zeros_explained);
  if (!scatter) return;
  out.notes.push_back((claimed ? "beside what is claimed: " : "") + scatter->note);
  if (scatter->follows.empty() || out.verdict == DiagnosisVerdict::unknown || (out.verdict == DiagnosisVerdict::known && !claimed)) return;
  if (claimed) out.residual_unknown = true;
  else out.verdict = DiagnosisVerdict::unknown;
  out.depends_on = {"time"};
  out.follows = {scatter->follows};
}

// What the records' own wander takes up, no effect is asked about.
void tell_moving_zero(const Workspace& w, const MixedFit& fit, Diagnosis& out) {
  std::optional<MovingZero> zero = moving_zero_of_records(w, fit);
  const auto found = std::ranges::find(out.findings, std::string("reference_drift"), &Finding::effect);
  if (!zero || (found != out.findings.end() && found->claimed())) return;
  if (found == out.findings.end())
    out.findings.insert(std::ranges::find_if(out.findings, [&](const Finding& f) { return f.probability < zero->finding.probability; }), zero->finding);
  if (zero->follows.empty() || out.verdict == DiagnosisVerdict::unknown) return;
  if (out.verdict == DiagnosisVerdict::known) out.residual_unknown = true;
  else out.verdict = DiagnosisVerdict::unknown;
  out.depends_on = {"time"};
  out.follows = {std::move(zero->follows)};
}

// The noise that everything is held against is taken from one row to the next, where such a line is noise.
void tell_steady_line(const Workspace& w, Diagnosis& out) {
  const std::optional<SteadyLine> line = steady_line(w);
  if (!line) return;
  if (out.verdict == DiagnosisVerdict::known) out.residual_unknown = true;
  else out.verdict = DiagnosisVerdict::unknown;
  if (std::ranges::find(out.depends_on, "time") == out.depends_on.end()) out.depends_on.emplace_back("time");
  const PrintedUnit unit = printed_unit(w.output.unit);
  out.follows.push_back(fmt::format("a line at {:.3g} Hz, {:.3g} {}, that the force does not have", line->frequency_Hz, unit.factor * line->amplitude_V, unit.name));
}

// What is left of such an output is the logger's, and no effect's.
void tell_sent_on_change(const Workspace& w, Diagnosis& out) {
  const std::optional<double> step_V = step_of_sent_changes(w.health);
  if (!step_V) return;
  if (out.verdict == DiagnosisVerdict::known) out.residual_unknown = true;
  else out.verdict = DiagnosisVerdict::unknown;
  if (std::ranges::find(out.depends_on, "output") == out.depends_on.end()) out.depends_on.emplace_back("output");
  const PrintedUnit unit = printed_unit(w.output.unit);
  out.follows.push_back(fmt::format("a logger that sends the output only when it has moved by some {} {}", plain_number(unit.factor * *step_V), unit.name));
}

// A fault of the wheel's form moves sensor and reference alike: the rig's law alone shows it.
void tell_uneven_wheel(const Workspace& w, const Selection& rig, Diagnosis& out) {
  if (std::ranges::any_of(out.findings, [](const Finding& f) { return f.claimed() && f.shown_in == ShownIn::rig; })) return;
  std::optional<UnevenWheel> wheel = uneven_wheel(w, rig);
  if (!wheel) return;
  if (out.verdict == DiagnosisVerdict::known) out.residual_unknown = true;
  else out.verdict = DiagnosisVerdict::unknown;
  std::erase(out.depends_on, "angle");
  out.depends_on.insert(out.depends_on.begin(), "angle");
  out.follows.insert(out.follows.begin(), std::move(wheel->follows));
  out.rig_maps.push_back(std::move(wheel->map));
}

// The model's own effects are no candidates, nor are their other forms: where its forms leave far more than the instruments may and others of the
// same families do not, nothing is chosen, and yet it is no "none".
bool form_falls_short(const EngineOptions& options, const Selection& selection, const Remainder& rest) {
  return !options.in_model.empty() && selection.chosen.empty() && rest.beside_claims && !rest.far_above;
}

OpenPoints open_points(const Workspace& w, const EngineOptions& options, const Search& search, const Remainder& rest, const Withdrawals& withdrawn,
                       const Diagnosis& out) {
  return {.follows_no_force = !follows_force(w.output, search.output.base),
          .form_falls_short = form_falls_short(options, search.output, rest),
          .structure_is_left = rest.structured(),
          .claims_withdrawn = withdrawn.any(),
          .name_is_open = name_is_open(out, search.suspicions),
          .leaves_far_more = rest.leaves_far_more()};
}

// In the words of what explains most of it, and its coordinate before those of the maps.
void tell_what_it_follows(const std::vector<Outdone>& outdone, Diagnosis& out) {
  constexpr std::size_t kMost = 3;
  for (const Outdone& o : outdone) {
    if (o.is_tie) continue;
    std::erase(out.depends_on, o.group);
    out.depends_on.insert(out.depends_on.begin(), o.group);
    if (std::ranges::find(out.follows, o.by) == out.follows.end()) out.follows.push_back(o.by);
  }
  if (out.depends_on.size() > kMost) out.depends_on.resize(kMost);
}

// What has no name yet: what it depends on.
void tell_dependences(const EngineOptions& options, const OpenPoints& open, const Withdrawals& withdrawn, Diagnosis& out) {
  const bool unknown = out.verdict == DiagnosisVerdict::unknown;
  // where all claims were withdrawn, what they soak up is unknown too
  if (unknown || out.residual_unknown) out.depends_on = depends_on(unknown && withdrawn.any() ? out.maps : out.maps_after);
  if (!out.depends_on.empty()) tell_what_it_follows(withdrawn.outdone, out);
  if (unknown && open.form_falls_short)
    out.follows.insert(out.follows.begin(), fmt::format("another form of what the model has ({})", fmt::join(options.in_model, ", ")));
  if (unknown && withdrawn.of_reference) out.follows.insert(out.follows.begin(), "an error of the reference itself");
}

void add_errors_of_samples(Diagnosis& out) {
  for (Finding& f : out.findings)
    if (f.of_samples()) {
      f.error_before = out.error_before;
      f.error_after = out.error_after;
      f.effect_rms = std::sqrt(std::max(0.0, f.error_before * f.error_before - f.error_after * f.error_after));
    }
}

void tell_coloured_noise(const Remainder& rest, Diagnosis& out) {
  if (rest.coloured && rest.smooth)
    out.notes.push_back(fmt::format("the noise of the output hangs together over time ({:.2g} % of the span, RMS), of one size in every record whatever the load does",
                                    100.0 * rest.structure_rms));
}

Repeatability repeatability_of(const Workspace& w, const MixedFit& fit) {
  const auto sd = [&](int k) { return std::sqrt(fit.variance[k]) * of_few_records(records_of_column(w, fit, k)); };
  // of a single record that decays, or of none, there is only what specimens usually differ by
  const auto seen = [&](int k) { return records_of_column(w, fit, k) > 1 ? sd(k) : kMissing; };
  double wander = 0.0, n = 0.0;
  for (std::size_t k = 0; k < fit.zeta.size(); ++k) {
    const double of_record = wander_on_rows(w.output, fit, k);
    wander += of_record * of_record;
    n += of_record > 0.0 ? 1.0 : 0.0;
  }
  return {sd(0), sd(1) * w.output.scale, seen(2), seen(3), n > 0.0 ? std::sqrt(wander / n) * w.output.scale : 0.0};
}

void add_null_scores(const Workspace& w, const Search& search, unsigned threads, Diagnosis& out) {
  constexpr int kFlips = 6;
  const NullCalibration null = calibrate_null(
      w.input, w.output, search.output.final, search.skip, search.rules, kFlips, threads);
  out.expected_false = null.expected_false;
  for (RankedEffect& r : out.ranking)
    if (const auto found = null.score.find(r.effect); found != null.score.end()) r.null_score = found->second;
}

// The null scores are of the output's.
void add_rankings(const Workspace& w, const Search& search, unsigned threads, Diagnosis& out) {
  add_ranking(w.input, w.output, search.output, search.rules, out);
  add_null_scores(w, search, threads, out);
  if (rig_is_judged(w, search)) add_ranking(w.input, w.rig, search.rig, search.rig_rules, out);
  if (w.has_command && search.drive.base.valid) add_ranking(w.input, w.command, search.drive, search.drive_rules, out);
}

// A family may come up, and be turned down, once for every model that it is tried beside.
void add_refused(const Search& search, Diagnosis& out) {
  for (const auto* told : {&search.output.nuisance, &search.begun_anew})
    for (const std::string& what : *told)
      if (std::ranges::find(out.notes, what) == out.notes.end()) out.notes.push_back(what);
  for (const Selection* tried : {&search.output, &search.rig, &search.drive})
    for (const RefusedEffect& r : tried->refused)
      if (std::ranges::none_of(out.refused, [&](const RefusedEffect& o) { return o.effect == r.effect && o.reason == r.reason; }))
        out.refused.push_back(r);
}

Unexpected undetermined(const Workspace& w) {
  return fail(ErrorCode::parse, "the records do not determine the starting model", w.input.name, "more records, or records with more force");
}

}  // namespace

Result<Diagnosis> compare_workspace(Workspace& w, const EngineOptions& options) {
  Diagnosis out = answer_about(w, options.model_name);
  out.notes = w.input.notes;
  const MixedFit base = base_model(w, options, out.notes);
  if (!base.valid) return undetermined(w);
  if (!base.columns.empty() && whole_must_judge(w, fit_mixed(w.output.problem, {}, &base), base)) w.judges = JudgedBy::whole;
  out.judged_by = w.judges;
  const auto residual = residual_rows(w.output, base);
  out.maps = residual_maps(w, residual, options.threads);
  Selection of_base;
  of_base.base = of_base.claimed = base;
  add_records(w, of_base, out);
  out.repeatability = repeatability_of(w, base);
  if (options.pictures) add_pictures(w, Search{}, base, options.threads, out);
  return out;
}

Result<Diagnosis> diagnose_workspace(Workspace& w, const EngineOptions& options) {
  Diagnosis out = answer_about(w, options.model_name);
  out.notes = w.input.notes;
  const Search search = search_channels(w, options);
  const Selection& selection = search.output;
  out.judged_by = w.judges;
  if (w.judges == JudgedBy::whole)
    out.notes.emplace_back("its parts show different things, and some cannot be foretold from the others: errors are of the whole recording, which the model was fitted to");
  if (!selection.base.valid)
    return undetermined(w);
  const Remainder rest = remainder_of(w, selection, options.threads);

  collect_findings(w, search, rest, out);
  const Withdrawals withdrawn = withdraw(w, selection, rest, options.threads, out);
  leave_creep_to_moving_zero(w, selection.final, out.findings);
  leave_unclear_growth_open(out.findings);
  put_in_order(out.findings);
  tell_not_separable(selection, out);
  if (rig_is_judged(w, search)) tell_not_separable(search.rig, out);

  const OpenPoints open = open_points(w, options, search, rest, withdrawn, out);
  if (open.follows_no_force) out.notes.emplace_back("the output hardly follows the force: is the sensor connected, and is this its column? --map NAME=U_V names another");
  out.verdict = verdict_of(out.findings, open);
  tell_records_far_above(w, rest, out);
  // what the user gets who takes the findings in, not what all forms of their families soak up beside them
  add_records(w, selection, out);
  out.residual_unknown = out.verdict == DiagnosisVerdict::known && (rest.beside_claims || withdrawn.some_outdone() || most_stays(w, out));
  if (out.residual_unknown) doubt_later_claims(out.findings);
  out.maps = residual_maps(w, residual_rows(w.output, selection.base), options.threads);
  out.maps_after = rest.maps;
  tell_dependences(options, open, withdrawn, out);

  add_steps(w, selection, out);
  add_errors_of_samples(out);
  if (std::ranges::none_of(out.findings, [](const Finding& f) { return f.claimed() && f.of_reference(); })) out.errors.erase("F");
  tell_coloured_noise(rest, out);
  add_rankings(w, search, options.threads, out);
  if (!w.input.single) tell_visible_from(out);
  const MixedFit& claimed = selection.claimed.valid ? selection.claimed : selection.base;
  out.repeatability = repeatability_of(w, selection.final);
  claim_unloaded_zero(w, claimed, out);
  tell_wide_scatter(w, selection, out);
  tell_moving_zero(w, selection.final, out);
  if (rig_is_judged(w, search)) tell_uneven_wheel(w, search.rig, out);
  tell_steady_line(w, out);
  tell_sent_on_change(w, out);
  tell_sharper_output(w, selection, options.threads, out);
  tell_decay(w, selection.final, options.threads, out);
  add_refused(search, out);
  suspect_refused(w, search.rules, out);
  tell_guessed_effects(w, claimed, search.rules.first_gain, out);
  state_probabilities(out);
  if (options.pictures) add_pictures(w, search, selection.claimed, options.threads, out);
  return out;
}

}  // namespace forcegate::diagnose
