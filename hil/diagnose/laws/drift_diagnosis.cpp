#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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
         fmt::format("; parts of the record that were left out are predicted {:.2g} times better than by the {} law", ratio, second);
}

}  // namespace

Result<Diagnosis> diagnose_drift(const Campaign& campaign) {
  Diagnosis out;
  out.campaign = campaign.name;
  out.model = "law of time";
  out.judged_by = JudgedBy::left_out;
  out.notes = campaign.notes;
  const bool has_force = std::ranges::any_of(campaign.records, [](const Record& r) { return r.trace.find("F_ref") != nullptr; });
  out.notes.push_back(has_force ? "no record has an input that moves: only the drift of the output can be judged"
                                : "no column is the reference force, among " + listed(campaign.records.front()) +
                                      ": only the drift of the output can be judged");
  if (has_force) out.notes.push_back(what_the_force_shows(campaign));
  std::map<std::string, double> left_out;
  std::vector<RecordDrift> drifts;
  double before = 0.0, noise = 0.0;
  bool moves = false, wavers = false;
  double longest_mean_s = 0.0, sample_noise = 0.0;
  constexpr double kFarAbove = 2.0, kOfSample = 0.5;  // noise of a mean, and of a sample: instruments wander by less
  for (const Record& record : campaign.records) {
    const Channel* U = output_of(record);
    if (!U)
      return fail(ErrorCode::parse, "which column is the output? There are " + listed(record), record.name,
                  "name it, for instance --map NAME=U_V; an input, where there is one: --map NAME=F_ref_N");
    out.unit = U->unit;
    if (&record == &campaign.records.front()) tell_unused(record, *U, out);
    FORCEGATE_TRY(RecordDrift drift,
                  fit_drift(record.name, record.trace.time_bases[U->time_base].t_s, U->value));
    const std::vector<double>& t_s = record.trace.time_bases[U->time_base].t_s;
    const double of_sample = movement_of(U->value).noise;
    if (t_s.size() > kDriftBlocks) longest_mean_s = std::max(longest_mean_s, (t_s.back() - t_s.front()) / static_cast<double>(kDriftBlocks));
    sample_noise += of_sample * of_sample;
    moves |= drift.span > 6.0 * drift.noise;
    const double left = drift.fits.front().left_out_rms;
    wavers |= left > kFarAbove * drift.noise && left > kOfSample * of_sample;
    tell_recorded_causes(record, *U, out);
    for (const DriftFit& f : drift.fits) {
      left_out[std::string(f.law->name)] += f.left_out_rms * f.left_out_rms;
      if (f.law == &drift_laws().front()) before += f.left_out_rms * f.left_out_rms;
    }
    noise += drift.noise * drift.noise;
    drifts.push_back(std::move(drift));
  }
  const auto n = static_cast<double>(drifts.size());
  std::vector<std::pair<double, std::string>> ranked;
  for (const auto& [form, square] : left_out) ranked.emplace_back(std::sqrt(square / n), form);
  std::sort(ranked.begin(), ranked.end());
  // the simplest law that predicts as well as the best one
  const double enough = 1.1 * ranked.front().first;
  for (const char* simple : {"constant", "line"}) {
    const auto at = std::find_if(ranked.begin(), ranked.end(),
                                 [&](const auto& r) { return r.second == simple && r.first <= enough; });
    if (at == ranked.end()) continue;
    std::rotate(ranked.begin(), at, at + 1);
    break;
  }
  out.floor = std::sqrt(noise / n);
  if (const PrintedUnit unit = printed_unit(out.unit); longest_mean_s > 0.0)
    out.notes.push_back(fmt::format("errors and floor are of {} means of each record, over {} s; single samples scatter by {} {} RMS", kDriftBlocks, plain_number(longest_mean_s),
                                    plain_number(unit.factor * std::sqrt(sample_noise / n)), unit.name));
  out.error_before = std::sqrt(before / n);
  out.error_after = ranked.front().first;
  out.plain_before = out.error_before;
  out.plain_after = out.error_after;
  constexpr double kFails = 10.0;  // times the best: an exponential that is led beyond its part says nothing by its number
  for (const auto& [error, form] : ranked) {
    if (error > kFails * ranked.front().first && ranked.front().first > 0.0) {
      out.notes.push_back(form + ": fails on parts that were left out");
      continue;
    }
    out.notes.push_back(fmt::format("{}: {:.4g} {} on parts that were left out", form, error, out.unit));
  }
  if (!moves || ranked.front().second == "constant") {
    out.error_after = out.plain_after = out.error_before;
    add_records(campaign, drifts, "constant", out);
    if (wavers) follows_no_law(out);
    return out;
  }
  const std::string& form = ranked.front().second;
  add_records(campaign, drifts, form, out);
  // a line is a limit of every curved law: it must beat the constant only
  const auto rival = form == "line" ? std::find_if(ranked.begin(), ranked.end(),
                                                   [](const auto& r) { return r.second == "constant"; })
                                    : ranked.begin() + 1;
  const double ratio = rival->first / std::max(ranked.front().first, 1e-300);
  if (ratio < 1.15) {
    out.verdict = DiagnosisVerdict::unknown;
    out.depends_on = {"time"};
    out.notes.push_back("the " + form + " and the " + rival->second +
                        " law predict equally well: record longer");
    return out;
  }
  constexpr double kDescribes = 3.0, kMostOfIt = 0.25;
  const bool leaves_more = wavers && out.error_after > kDescribes * out.floor;
  if (leaves_more && out.error_after > kMostOfIt * out.error_before) {
    follows_no_law(out);
    return out;
  }
  out.verdict = DiagnosisVerdict::known;
  out.residual_unknown = leaves_more;
  if (leaves_more) out.depends_on = {"time"};
  Finding f;
  f.effect = "drift";
  f.between_records = true;  // the levels of the records show it
  f.side = "unknown";
  f.side_witnessed = false;
  f.form = form;
  f.unit = out.unit;
  f.probability = ratio > 1.5 ? 0.95 : 0.75;
  f.error_before = out.error_before;
  f.error_after = out.error_after;
  f.records_excited = f.records_improved = static_cast<int>(drifts.size());
  const DriftFit& first = *std::find_if(drifts.front().fits.begin(), drifts.front().fits.end(),
                                        [&](const DriftFit& d) { return d.law->name == form; });
  f.evidence = sentence_of(first, out.unit, ratio, rival->second) +
               "; without an input the side cannot be told: sensor, chamber and instrument may drift";
  f.parameters.push_back({"size", first.size, first.u_size, out.unit + first.law->per});
  if (first.law->shape_name != nullptr) f.parameters.push_back({first.law->shape_name, first.shape, first.u_shape, first.law->shape_unit});
  if (first.onset_s > 0.0) f.parameters.push_back({"onset_s", first.onset_s, first.u_onset_s, "s"});
  f.effect_rms =
      std::sqrt(std::max(0.0, out.error_before * out.error_before - out.error_after * out.error_after));
  out.findings.push_back(std::move(f));
  out.steps = {{"", out.error_before}, {"drift", out.error_after}};
  return out;
}

}  // namespace forcegate::diagnose
