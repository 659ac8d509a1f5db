#include "hil/diagnose/laws/drift.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "hil/model/rows.h"
#include "hil/trace/columns.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kBlocks = 200, kParts = 10;
constexpr const char* kForms[] = {"constant", "line", "exponential", "logarithm", "power"};

struct Blocks {
  std::vector<double> t_s, y;
};

Blocks block_means(const std::vector<double>& t_s, const std::vector<double>& y) {
  std::vector<std::size_t> good;
  for (std::size_t i = 0; i < y.size(); ++i)
    if (std::isfinite(y[i])) good.push_back(i);
  Blocks out;
  const std::size_t n = std::min(kBlocks, good.size());
  for (std::size_t b = 0; b < n; ++b) {
    const std::size_t from = b * good.size() / n, to = (b + 1) * good.size() / n;
    double t = 0.0, sum = 0.0;
    for (std::size_t k = from; k < to; ++k) t += t_s[good[k]] - t_s[good.front()], sum += y[good[k]];
    out.t_s.push_back(t / static_cast<double>(to - from));
    out.y.push_back(sum / static_cast<double>(to - from));
  }
  return out;
}

double law(const std::string& form, double since_s, double shape) {
  const double s = std::max(0.0, since_s);
  if (form == "line") return s;
  if (form == "exponential") return std::exp(-s / shape);
  if (form == "logarithm") return std::log10(1.0 + s / shape);
  if (form == "power") return std::pow(s, shape);
  return 0.0;
}

// Least squares of c + a law(t) on the blocks that are kept; returns the squared error on all kept blocks.
double solve(const Blocks& b, const std::vector<char>& kept, DriftFit& fit) {
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, syy = 0.0;
  for (std::size_t i = 0; i < b.y.size(); ++i) {
    if (!kept[i]) continue;
    const double x = law(fit.form, b.t_s[i] - fit.onset_s, fit.shape);
    n += 1.0, sx += x, sy += b.y[i];
  }
  const double mx = sx / n, my = sy / n;
  for (std::size_t i = 0; i < b.y.size(); ++i) {
    if (!kept[i]) continue;
    const double x = law(fit.form, b.t_s[i] - fit.onset_s, fit.shape) - mx, y = b.y[i] - my;
    sxx += x * x, sxy += x * y, syy += y * y;
  }
  fit.size = sxx > 1e-300 ? sxy / sxx : 0.0;
  fit.constant = my - fit.size * mx;
  return std::max(0.0, syy - fit.size * sxy);
}

// Golden section in log(shape) around the best of a log grid, for each onset of a grid that is then refined.
DriftFit best_fit(const Blocks& b, const std::vector<char>& kept, const std::string& form) {
  const double length = b.t_s.back();
  DriftFit best;
  best.form = form;
  best.shape = 1.0;
  double error = solve(b, kept, best);
  if (form == "constant") return best;
  // a logarithm that does not cover a decade of time within the record is no creep but any curve
  const double low = form == "power" ? 0.02 : length / 1000.0;
  const double high = form == "power" ? 0.9 : form == "logarithm" ? length / 10.0 : length * 10.0;
  const auto shape_error = [&](double onset_s, double shape, DriftFit& fit) {
    fit.form = form, fit.onset_s = onset_s, fit.shape = shape;
    return solve(b, kept, fit);
  };
  const auto best_shape = [&](double onset_s, DriftFit& out) {
    if (form == "line") return shape_error(onset_s, 1.0, out);
    constexpr int kGrid = 16;
    double least = 1e300;
    int at = 0;
    for (int k = 0; k <= kGrid; ++k) {
      DriftFit fit;
      const double e = shape_error(onset_s, low * std::pow(high / low, k / static_cast<double>(kGrid)), fit);
      if (e < least) least = e, at = k;
    }
    double left = std::max(0, at - 1) / static_cast<double>(kGrid),
           right = std::min(kGrid, at + 1) / static_cast<double>(kGrid);
    const auto value = [&](double u, DriftFit& fit) {
      return shape_error(onset_s, low * std::pow(high / low, u), fit);
    };
    for (int step = 0; step < 14; ++step) {
      const double a = left + 0.382 * (right - left), c = left + 0.618 * (right - left);
      DriftFit fa, fc;
      if (value(a, fa) < value(c, fc))
        right = c;
      else
        left = a;
    }
    return value(0.5 * (left + right), out);
  };
  const auto try_onset = [&](double onset_s) {
    DriftFit fit;
    const double e = best_shape(onset_s, fit);
    if (e < error) error = e, best = fit;
  };
  double step = length / 24.0;
  try_onset(0.0);
  const DriftFit at_once = best;
  const double at_once_error = error;
  for (int k = 1; k < 12; ++k) try_onset(k * step);
  for (int round = 0; round < 4; ++round) {
    step /= 3.0;
    const double centre = best.onset_s;
    for (int k = -2; k <= 2; ++k)
      if (k != 0 && centre + k * step >= 0.0) try_onset(centre + k * step);
  }
  // a later onset must earn its freedom: nothing holds it where the beginning of the record is left out
  return at_once_error < 1.2 * error ? at_once : best;
}

double rms_over(const Blocks& b, const DriftFit& fit, const std::vector<char>& use) {
  double sum = 0.0, n = 0.0;
  for (std::size_t i = 0; i < b.y.size(); ++i) {
    if (!use[i]) continue;
    const double e = b.y[i] - fit.constant - fit.size * law(fit.form, b.t_s[i] - fit.onset_s, fit.shape);
    sum += e * e;
    n += 1.0;
  }
  return std::sqrt(sum / std::max(1.0, n));
}

double noise_of(const std::vector<double>& y) {
  std::vector<double> d;
  for (std::size_t i = 1; i + 1 < y.size(); ++i) d.push_back(std::abs(y[i - 1] - 2.0 * y[i] + y[i + 1]));
  return 1.4826 * quantile(std::move(d), 0.5) / std::sqrt(6.0);
}

// Standard error out of the values with each part left out (Efron and Tibshirani 1993, eq. 11.5).
double jackknife(const std::vector<double>& left_out) {
  const double n = static_cast<double>(left_out.size());
  double mean = 0.0, square = 0.0;
  for (const double v : left_out) mean += v / n;
  for (const double v : left_out) square += (v - mean) * (v - mean);
  return std::sqrt((n - 1.0) / n * square);
}

const Channel* output_of(const Record& record) {
  if (const Channel* U = record.trace.find("U")) return U;
  const Channel* only = nullptr;
  for (const Channel& c : record.trace.channels) {
    if (c.name == "F_ref") continue;
    if (only) return nullptr;
    only = &c;
  }
  return only;
}

std::string listed(const Record& record) {
  std::string out;
  for (const Channel& c : record.trace.channels) out += (out.empty() ? "" : ", ") + header_of(c.name, c.unit);
  return out;
}

/// Columns beside the output that move: one of them may be the input.
void tell_unused(const Record& record, const Channel& output, Diagnosis& out) {
  for (const Channel& c : record.trace.channels) {
    double low = 1e300, high = -1e300;
    for (const double v : c.value)
      if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
    if (&c == &output || c.name == "temp" || !(high > low)) continue;
    const std::string name = header_of(c.name, c.unit);
    out.notes.push_back("column \"" + name + "\" is not used; if it is the input, add --map " + name +
                        "=F_ref_N");
  }
}

// Every record with the error of the constant and of the law that was taken, on its tenths that were left out.
void add_records(const Campaign& campaign, const std::vector<RecordDrift>& drifts, const std::string& form, Diagnosis& out) {
  for (std::size_t k = 0; k < drifts.size(); ++k) {
    const auto left_out = [&](const std::string& name) {
      return std::find_if(drifts[k].fits.begin(), drifts[k].fits.end(), [&](const DriftFit& f) { return f.form == name; })->left_out_rms;
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
  char text[300], from[40] = "";
  if (f.onset_s > 0.0) std::snprintf(from, sizeof from, " from %.3g s on", f.onset_s);
  if (f.form == "exponential")
    std::snprintf(text, sizeof text,
                  "the output moves exponentially%s towards %.4g %s with one time constant of %.3g s", from,
                  f.constant, unit.c_str(), f.shape);
  else if (f.form == "logarithm")
    std::snprintf(text, sizeof text, "the output creeps with the logarithm of time%s, %.3g %s a decade", from,
                  f.size, unit.c_str());
  else if (f.form == "power")
    std::snprintf(text, sizeof text, "the output creeps as a power of time%s, exponent %.2g", from, f.shape);
  else
    std::snprintf(text, sizeof text, "the output moves steadily%s by %.3g %s/s", from, f.size, unit.c_str());
  char tail[160];
  std::snprintf(tail, sizeof tail,
                "; parts of the record that were left out are predicted %.2g times better than by the %s law",
                ratio, second.c_str());
  return std::string(text) + tail;
}

}  // namespace

Result<RecordDrift> fit_drift(const std::string& record, const std::vector<double>& t_s,
                              const std::vector<double>& y) {
  const Blocks b = block_means(t_s, y);
  if (b.y.size() < 40)
    return fail(ErrorCode::parse, "the record has only " + std::to_string(b.y.size()) + " samples", record,
                "at least 40 are needed to tell one law of drift from another");
  RecordDrift out;
  out.record = record;
  out.span = quantile(b.y, 0.999) - quantile(b.y, 0.001);
  out.noise = noise_of(b.y);
  const std::vector<char> all(b.y.size(), 1);
  for (const char* form : kForms) {
    DriftFit fit = best_fit(b, all, form);
    fit.rms = rms_over(b, fit, all);
    double sum = 0.0;
    std::vector<double> sizes, shapes, onsets_s;
    for (std::size_t part = 0; part < kParts; ++part) {
      std::vector<char> kept(b.y.size(), 1), left(b.y.size(), 0);
      for (std::size_t i = part * b.y.size() / kParts; i < (part + 1) * b.y.size() / kParts; ++i)
        kept[i] = 0, left[i] = 1;
      const DriftFit without = best_fit(b, kept, form);
      sizes.push_back(without.size);
      shapes.push_back(without.shape);
      onsets_s.push_back(without.onset_s);
      const double rms = rms_over(b, without, left);
      sum += rms * rms;
    }
    fit.u_size = jackknife(sizes);
    fit.u_shape = jackknife(shapes);
    fit.u_onset_s = jackknife(onsets_s);
    fit.left_out_rms = std::sqrt(sum / kParts);
    out.fits.push_back(fit);
  }
  std::stable_sort(out.fits.begin(), out.fits.end(),
                   [](const DriftFit& a, const DriftFit& c) { return a.left_out_rms < c.left_out_rms; });
  return out;
}

bool is_drift_only(const Campaign& campaign) {
  return std::none_of(campaign.records.begin(), campaign.records.end(), [](const Record& record) {
    const Channel* F = record.trace.find("F_ref");
    if (!F) return false;
    double low = 1e300, high = -1e300;
    for (const double v : F->value)
      if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
    return high > low;
  });
}

Result<Diagnosis> diagnose_drift(const Campaign& campaign) {
  Diagnosis out;
  out.campaign = campaign.name;
  out.model = "law of time";
  out.notes = campaign.notes;
  const bool has_force = std::ranges::any_of(campaign.records, [](const Record& r) { return r.trace.find("F_ref") != nullptr; });
  out.notes.push_back(has_force ? "no record has an input that moves: only the drift of the output can be judged"
                                : "no column is the reference force, among " + listed(campaign.records.front()) +
                                      ": only the drift of the output can be judged");
  std::map<std::string, double> left_out;
  std::vector<RecordDrift> drifts;
  double before = 0.0, noise = 0.0;
  bool moves = false, wavers = false;
  for (const Record& record : campaign.records) {
    const Channel* U = output_of(record);
    if (!U)
      return fail(ErrorCode::parse, "which column is the output? There are " + listed(record), record.name,
                  "name it, for instance --map NAME=U_V; an input, where there is one: --map NAME=F_ref_N");
    out.unit = U->unit;
    if (&record == &campaign.records.front()) tell_unused(record, *U, out);
    FORCEGATE_TRY(RecordDrift drift,
                  fit_drift(record.name, record.trace.time_bases[U->time_base].t_s, U->value));
    moves |= drift.span > 6.0 * drift.noise;
    wavers |= drift.fits.front().left_out_rms > 5.0 * noise_of(U->value);
    for (const DriftFit& f : drift.fits) {
      left_out[f.form] += f.left_out_rms * f.left_out_rms;
      if (f.form == "constant") before += f.left_out_rms * f.left_out_rms;
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
    char text[120];
    std::snprintf(text, sizeof text, "%s: %.4g %s on parts that were left out", form.c_str(), error,
                  out.unit.c_str());
    out.notes.push_back(text);
  }
  if (!moves || ranked.front().second == "constant") {
    out.error_after = out.plain_after = out.error_before;
    add_records(campaign, drifts, "constant", out);
    if (wavers) {
      out.verdict = DiagnosisVerdict::unknown;
      out.depends_on = {"time"};
      out.notes.push_back(
          "the output moves far more than its noise and follows no law of time: its input was not recorded");
    }
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
  out.verdict = DiagnosisVerdict::known;
  Finding f;
  f.effect = "drift";
  f.side = "unknown";
  f.side_witnessed = false;
  f.form = form;
  f.unit = out.unit;
  f.probability = ratio > 1.5 ? 0.95 : 0.75;
  f.error_before = out.error_before;
  f.error_after = out.error_after;
  f.records_excited = f.records_improved = static_cast<int>(drifts.size());
  const DriftFit& first = *std::find_if(drifts.front().fits.begin(), drifts.front().fits.end(),
                                        [&](const DriftFit& d) { return d.form == form; });
  f.evidence = sentence_of(first, out.unit, ratio, rival->second) +
               "; without an input the side cannot be told: sensor, chamber and instrument may drift";
  f.parameters.push_back({"size", first.size, first.u_size, form == "line" ? out.unit + "/s" : out.unit});
  if (form == "exponential") f.parameters.push_back({"tau_s", first.shape, first.u_shape, "s"});
  if (form == "logarithm") f.parameters.push_back({"t1_s", first.shape, first.u_shape, "s"});
  if (form == "power") f.parameters.push_back({"exponent", first.shape, first.u_shape, "1"});
  if (first.onset_s > 0.0) f.parameters.push_back({"onset_s", first.onset_s, first.u_onset_s, "s"});
  f.effect_rms =
      std::sqrt(std::max(0.0, out.error_before * out.error_before - out.error_after * out.error_after));
  out.findings.push_back(std::move(f));
  out.steps = {{"", out.error_before}, {"drift", out.error_after}};
  return out;
}

}  // namespace forcegate::diagnose
