#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <compare>
#include <map>

#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/diagnose/laws/drift.h"
#include "hil/model/rows.h"
#include "hil/trace/channels.h"
#include "hil/trace/column_map.h"
#include "hil/trace/columns.h"

namespace forcegate::diagnose {

namespace {

std::string listed(const Record& record) {
  std::string out;
  for (const Channel& c : record.trace.channels) out += (out.empty() ? "" : ", ") + written_header(c, record.headers);
  return out;
}

/// Columns beside the output that move: one of them may be the input.
void tell_unused(const Record& record, const Channel& output, Diagnosis& out) {
  for (const Channel& c : record.trace.channels) {
    double low = 1e300, high = -1e300;
    for (const double v : c.value)
      if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
    if (&c == &output || c.name == "temp" || c.name == "F_ref" || !(high > low)) continue;
    const std::string name = written_header(c, record.headers);
    out.notes.push_back("column \"" + name + "\" is not used; if it is the input, add --map " + shell_quoted(name + "=F_ref_N"));
  }
}

/// What drifts together is not told apart by its course alone.
void tell_recorded_causes(const Record& record, const Channel& output, Diagnosis& out) {
  const std::vector<double>& t_s = record.trace.time_bases[output.time_base].t_s;
  for (const KnownChannel& known : kKnownChannels) {
    const Channel* c = known.is_cause ? record.trace.find(known.name) : nullptr;
    if (c == nullptr || !movement_of(c->value).stands_out()) continue;
    if (response_as_a_whole(at_times(record.trace.time_bases[c->time_base].t_s, c->value, t_s), output.value).found)
      out.notes.push_back(record.name + ": the output goes with " + header_of(c->name, c->unit) + " as it goes with time: either may be the cause");
  }
}

void follows_no_law(Diagnosis& out) {
  out.verdict = DiagnosisVerdict::unknown;
  out.depends_on = {"time"};
  out.notes.push_back("the output moves far more than its noise and follows no law of time: its input was not recorded");
}

// Every record with the error of the constant and of the law that was taken, on its tenths that were left out.
void add_records(const Campaign& campaign, const std::vector<RecordDrift>& drifts, const std::string& form, Diagnosis& out) {
  for (std::size_t k = 0; k < drifts.size(); ++k) {
    const auto left_out = [&](const std::string& name) {
      return std::find_if(drifts[k].fits.begin(), drifts[k].fits.end(), [&](const DriftFit& f) { return f.law->name == name; })->left_out_rms;
    };
    RecordError e;
    e.record = drifts[k].record;
    e.kind = campaign.records[k].kind;
    e.before = e.plain_before = left_out("constant");
    e.after = e.plain_after = left_out(form);
    e.floor = std::min(drifts[k].noise, e.after);
    e.explainable = e.before > 0.0 ? std::clamp(1.0 - std::pow(e.floor / e.before, 2), 0.0, 1.0) : 0.0;
    out.records.push_back(std::move(e));
  }
  out.errors["U_plain"] = {out.plain_before, out.plain_after, out.unit};
}

std::string sentence_of(const DriftFit& f, const std::string& unit, double ratio, const std::string& second) {
  const std::string from = f.onset_s > 0.0 ? fmt::format(" from {:.3g} s on", f.onset_s) : "";
  return f.law->sentence(f, from, unit) +
         fmt::format("; parts of the record that were left out are predicted {} better than by the {} law", so_many_times(ratio), second);
}

// All records' fits, and what they add up to (mean squares over records).
struct Drifts {
  std::vector<RecordDrift> records;
  std::map<std::string, double> left_out;  // of every law
  double constant = 0.0;                   // of the first one, in the order of the records
  double noise = 0.0, sample_noise = 0.0;
  double longest_mean_s = 0.0;
  bool moves = false, wavers = false;

  double rms(double sum) const { return std::sqrt(sum / static_cast<double>(records.size())); }

  void add(RecordDrift drift, const std::vector<double>& t_s, double of_sample) {
    constexpr double kMoves = 6.0;                      // noise of a mean
    constexpr double kFarAbove = 2.0, kOfSample = 0.5;  // noise of a mean, and of a sample: instruments wander by less
    if (t_s.size() > kDriftBlocks) longest_mean_s = std::max(longest_mean_s, (t_s.back() - t_s.front()) / static_cast<double>(kDriftBlocks));
    sample_noise += of_sample * of_sample;
    moves |= drift.span > kMoves * drift.noise;
    const double left = drift.fits.front().left_out_rms;
    wavers |= left > kFarAbove * drift.noise && left > kOfSample * of_sample;
    for (const DriftFit& f : drift.fits) {
      const double square = f.left_out_rms * f.left_out_rms;
      left_out[std::string(f.law->name)] += square;
      if (f.law == &drift_laws().front()) constant += square;
    }
    noise += drift.noise * drift.noise;
    records.push_back(std::move(drift));
  }
};

struct RankedLaw {
  double error = 0.0;
  std::string form;
  auto operator<=>(const RankedLaw&) const = default;
};

// The best first; before it the simplest one that predicts as well.
std::vector<RankedLaw> ranked_laws(const Drifts& drifts) {
  constexpr double kAsWell = 1.1;
  std::vector<RankedLaw> out;
  for (const auto& [form, square] : drifts.left_out) out.push_back({drifts.rms(square), form});
  std::ranges::sort(out);
  const double enough = kAsWell * out.front().error;
  for (const char* simple : {"constant", "line"}) {
    const auto at = std::ranges::find_if(out, [&](const RankedLaw& r) { return r.form == simple && r.error <= enough; });
    if (at == out.end()) continue;
    std::rotate(out.begin(), at, at + 1);
    break;
  }
  return out;
}

// A line is a limit of every curved law: it must beat the constant only.
const RankedLaw& rival_of_first(const std::vector<RankedLaw>& ranked) {
  return ranked.front().form == "line" ? *std::ranges::find(ranked, "constant", &RankedLaw::form) : ranked[1];
}

void tell_what_is_there(const Campaign& campaign, Diagnosis& out) {
  const bool has_force = std::ranges::any_of(campaign.records, [](const Record& r) { return r.trace.find("F_ref") != nullptr; });
  out.notes.push_back(has_force ? "no record has an input that moves: only the drift of the output can be judged"
                                : "no column is the reference force, among " + listed(campaign.records.front()) +
                                      ": only the drift of the output can be judged");
  if (has_force) out.notes.push_back(what_the_force_shows(campaign));
}

Result<Drifts> fit_drifts(const Campaign& campaign, Diagnosis& out) {
  Drifts drifts;
  for (const Record& record : campaign.records) {
    const Channel* U = output_of(record);
    if (!U)
      return fail(ErrorCode::parse, "which column is the output? There are " + listed(record), record.name,
                  "name it, for instance --map NAME=U_V; an input, where there is one: --map NAME=F_ref_N");
    out.unit = U->unit;
    if (&record == &campaign.records.front()) tell_unused(record, *U, out);
    const std::vector<double>& t_s = record.trace.time_bases[U->time_base].t_s;
    FORCEGATE_TRY(RecordDrift drift, fit_drift(record.name, t_s, U->value));
    drifts.add(std::move(drift), t_s, movement_of(U->value).noise);
    tell_recorded_causes(record, *U, out);
  }
  return drifts;
}

void tell_errors(const Drifts& drifts, const std::vector<RankedLaw>& ranked, Diagnosis& out) {
  constexpr double kFails = 10.0;  // times the best: an exponential that is led beyond its part says nothing by its number
  out.floor = drifts.rms(drifts.noise);
  out.error_before = out.plain_before = drifts.rms(drifts.constant);
  out.error_after = out.plain_after = ranked.front().error;
  if (const PrintedUnit unit = printed_unit(out.unit); drifts.longest_mean_s > 0.0)
    out.notes.push_back(fmt::format("errors and floor are of {} means of each record, over {} s; single samples scatter by {} {} RMS", kDriftBlocks,
                                    plain_number(drifts.longest_mean_s), plain_number(unit.factor * drifts.rms(drifts.sample_noise)), unit.name));
  for (const auto& [error, form] : ranked) {
    const bool fails = error > kFails * ranked.front().error && ranked.front().error > 0.0;
    out.notes.push_back(fails ? form + ": fails on parts that were left out" : fmt::format("{}: {:.4g} {} on parts that were left out", form, error, out.unit));
  }
}

Finding finding_of(const Drifts& drifts, const std::string& form, double ratio, const std::string& second, const Diagnosis& out) {
  constexpr double kPlain = 1.5;
  Finding f;
  f.effect = "drift";
  f.between_records = true;  // the levels of the records show it
  f.side = "unknown";
  f.side_witnessed = false;
  f.form = form;
  f.unit = out.unit;
  f.probability = ratio > kPlain ? 0.95 : 0.75;
  f.error_before = out.error_before;
  f.error_after = out.error_after;
  f.records_excited = f.records_improved = static_cast<int>(drifts.records.size());
  const DriftFit& first = *std::ranges::find_if(drifts.records.front().fits, [&](const DriftFit& d) { return d.law->name == form; });
  f.evidence = sentence_of(first, out.unit, ratio, second) + "; without an input the side cannot be told: sensor, chamber and instrument may drift";
  f.parameters.push_back({"size", first.size, first.u_size, out.unit + first.law->per});
  if (first.law->shape_name != nullptr) f.parameters.push_back({first.law->shape_name, first.shape, first.u_shape, first.law->shape_unit});
  if (first.onset_s > 0.0) f.parameters.push_back({"onset_s", first.onset_s, first.u_onset_s, "s"});
  f.effect_rms = std::sqrt(std::max(0.0, out.error_before * out.error_before - out.error_after * out.error_after));
  return f;
}

void judge_law(const Campaign& campaign, const Drifts& drifts, const std::vector<RankedLaw>& ranked, Diagnosis& out) {
  constexpr double kPartsFromRival = 1.15;
  constexpr double kDescribes = 3.0, kMostOfIt = 0.25;
  const std::string& form = ranked.front().form;
  if (!drifts.moves || form == "constant") {
    out.error_after = out.plain_after = out.error_before;
    add_records(campaign, drifts.records, "constant", out);
    if (drifts.wavers) follows_no_law(out);
    return;
  }
  add_records(campaign, drifts.records, form, out);
  const RankedLaw& rival = rival_of_first(ranked);
  const double ratio = rival.error / std::max(ranked.front().error, 1e-300);
  if (ratio < kPartsFromRival) {
    out.verdict = DiagnosisVerdict::unknown;
    out.depends_on = {"time"};
    out.notes.push_back("the " + form + " and the " + rival.form + " law predict equally well: record longer");
    return;
  }
  const bool leaves_more = drifts.wavers && out.error_after > kDescribes * out.floor;
  if (leaves_more && out.error_after > kMostOfIt * out.error_before) {
    follows_no_law(out);
    return;
  }
  out.verdict = DiagnosisVerdict::known;
  out.residual_unknown = leaves_more;
  if (leaves_more) out.depends_on = {"time"};
  out.findings.push_back(finding_of(drifts, form, ratio, rival.form, out));
  out.steps = {{"", out.error_before}, {"drift", out.error_after}};
}

}  // namespace

Result<Diagnosis> diagnose_drift(const Campaign& campaign) {
  Diagnosis out;
  out.campaign = campaign.name;
  out.model = "law of time";
  out.no_input = true;
  out.judged_by = JudgedBy::left_out;
  out.notes = campaign.notes;
  tell_what_is_there(campaign, out);
  FORCEGATE_TRY(const Drifts drifts, fit_drifts(campaign, out));
  const std::vector<RankedLaw> ranked = ranked_laws(drifts);
  tell_errors(drifts, ranked, out);
  judge_law(campaign, drifts, ranked, out);
  return out;
}

}  // namespace forcegate::diagnose
