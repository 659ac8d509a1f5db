#include "hil/app/pictures/record_pictures.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <numbers>
#include <optional>

#include "hil/base/quantile.h"
#include "hil/trace/extrema.h"

namespace forcegate {
namespace {

struct ModelledRecord {
  std::string name;
  const RecordInput* input = nullptr;
  std::vector<std::uint8_t> ok;
  std::vector<double> model;  ///< any unit: gain and zero are fitted
  double gain = 1.0, zero = 0.0, rms = 0.0, span = 0.0, noise = 0.0;

  double residual(std::size_t i) const { return input->U_V[i] - zero - gain * model[i]; }
};

struct Straight {
  double gain = 0.0, zero = 0.0;
};

// Least squares of y = zero + gain x over the rows that `use` admits.
template <class Use>
std::optional<Straight> straight(const std::vector<double>& x, const std::vector<double>& y, const Use& use) {
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (use(i)) n += 1.0, sx += x[i], sy += y[i];
  if (n < 3.0) return std::nullopt;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (use(i)) sxx += (x[i] - sx / n) * (x[i] - sx / n), sxy += (x[i] - sx / n) * (y[i] - sy / n);
  const double gain = sxx > 0.0 ? sxy / sxx : 0.0;
  return Straight{gain, (sy - gain * sx) / n};
}

// `in_frame`: nullptr where the model has no effects.
std::vector<double> model_rows(const CampaignInFrame* in_frame, const Model& model, const RecordInput& r) {
  if (in_frame != nullptr)
    if (auto out = model_output_V(model, *in_frame, r)) return std::move(*out);
  std::vector<double> out(r.rows());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = r.base_force_N(i);
  return out;
}

bool finish(ModelledRecord& m) {
  const RecordInput& r = *m.input;
  const auto line = straight(m.model, r.U_V, [&](std::size_t i) { return m.ok[i] != 0; });
  if (!line) return false;
  m.gain = line->gain, m.zero = line->zero;
  double sum = 0.0, n = 0.0, low = INFINITY, high = -INFINITY;
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (m.ok[i] != 0) {
      sum += m.residual(i) * m.residual(i), n += 1.0;
      low = std::min(low, m.model[i]), high = std::max(high, m.model[i]);
    }
  m.rms = std::sqrt(sum / n);
  m.span = high - low;
  return std::isfinite(m.rms);
}

// The decay of the records is that of the law alone, which bends itself towards what the effects do: beside them it would count that twice. Theirs is
// the model's, as it stands or with what the record's own differs from the law of all; of these the picture takes the one that leaves less.
bool set_model(const CampaignInFrame* in_frame, const Model& model, const diagnose::Workspace& w, std::size_t record, ModelledRecord& m) {
  const RecordInput& r = *m.input;
  if (in_frame == nullptr && r.decay.size() == r.rows()) {
    m.model = model_rows(nullptr, model, r);
    return finish(m);
  }
  RecordInput all = r;
  all.wanted.clear();
  set_decay(all, model.law);
  m.model = model_rows(in_frame, model, all);
  if (!finish(m)) return false;
  if (r.dynamic && model.law.decays && record < w.shifts.size()) {
    ModelledRecord own = m;
    BaseLaw law = model.law;
    law.loading_share = w.law.loading_share;
    set_decay(all, law, w.shifts[record].log_b, w.shifts[record].log_q);
    own.model = model_rows(in_frame, model, all);
    if (finish(own) && own.rms < m.rms) m = std::move(own);
  }
  return true;
}

std::vector<ModelledRecord> modelled(const diagnose::Workspace& w, const Model& model) {
  std::vector<ModelledRecord> out;
  std::optional<CampaignInFrame> in_frame;
  if (!model.effects.empty() || !model.user_effects.empty()) in_frame.emplace(model.frame, w.input);
  for (std::size_t k = 0; k < w.input.records.size(); ++k) {
    const RecordInput& r = w.input.records[k];
    if (r.rows() == 0 || r.U_V.size() != r.rows()) continue;
    // the blocks of one recording have the same rows
    ModelledRecord m{r.name, &r, r.ok, {}};
    if (k < w.noise_V.size()) m.noise = w.noise_V[k];
    bool made = false;
    if (w.input.single && !out.empty()) m.model = out.front().model, made = finish(m);
    else made = set_model(in_frame ? &*in_frame : nullptr, model, w, k, m);
    if (made) out.push_back(std::move(m));
  }
  return out;
}

// What is looked at along time: records, or the one recording without its cuts.
std::vector<ModelledRecord> whole_records(const diagnose::Workspace& w, std::vector<ModelledRecord> parts) {
  if (!w.input.single || parts.size() < 2) return parts;
  ModelledRecord whole = parts.front();
  const std::size_t cut = whole.name.rfind('/');
  if (cut != std::string::npos) whole.name.erase(cut);
  for (const ModelledRecord& part : parts)
    for (std::size_t i = 0; i < whole.ok.size(); ++i) whole.ok[i] |= part.ok[i];
  if (!finish(whole)) return parts;
  return {std::move(whole)};
}

void transform(std::vector<std::complex<double>>& x) {  // n a power of two
  const std::size_t n = x.size();
  for (std::size_t i = 1, j = 0; i < n; ++i) {
    std::size_t bit = n >> 1;
    for (; (j & bit) != 0; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(x[i], x[j]);
  }
  for (std::size_t length = 2; length <= n; length <<= 1) {
    const std::complex<double> turn = std::polar(1.0, -2.0 * std::numbers::pi / static_cast<double>(length));
    for (std::size_t begin = 0; begin < n; begin += length) {
      std::complex<double> w = 1.0;
      for (std::size_t i = 0; i < length / 2; ++i, w *= turn) {
        const std::complex<double> a = x[begin + i], b = w * x[begin + i + length / 2];
        x[begin + i] = a + b;
        x[begin + i + length / 2] = a - b;
      }
    }
  }
}

struct Stretch {
  std::size_t begin = 0, end = 0;
  std::size_t size() const { return end - begin; }
};

// Stretches of samples; up to kBridge rows without one are bridged by a straight line in `y`.
std::vector<Stretch> stretches(const std::vector<std::uint8_t>& ok, std::vector<double>& y) {
  constexpr std::size_t kBridge = 5;
  std::vector<Stretch> out;
  for (std::size_t i = 0; i < ok.size(); ++i) {
    if (ok[i] == 0 || !std::isfinite(y[i])) continue;
    if (out.empty() || i - out.back().end > kBridge) {
      out.push_back({i, i + 1});
      continue;
    }
    const std::size_t from = out.back().end - 1;
    for (std::size_t j = from + 1; j < i; ++j)
      y[j] = y[from] + (y[i] - y[from]) * static_cast<double>(j - from) / static_cast<double>(i - from);
    out.back().end = i + 1;
  }
  return out;
}

std::optional<std::vector<double>> density(const std::vector<double>& y, const std::vector<Stretch>& where, std::size_t length, double step_s) {
  std::vector<double> power(length / 2 + 1, 0.0);
  double windows = 0.0, weight = 0.0;
  for (std::size_t i = 0; i < length; ++i) weight += std::pow(std::sin(std::numbers::pi * static_cast<double>(i) / static_cast<double>(length)), 4.0);
  std::vector<std::complex<double>> x(length);
  for (const Stretch& s : where)
    for (std::size_t begin = s.begin; begin + length <= s.end; begin += length / 2) {
      double mean = 0.0;
      for (std::size_t i = 0; i < length; ++i) mean += y[begin + i] / static_cast<double>(length);
      for (std::size_t i = 0; i < length; ++i)
        x[i] = (y[begin + i] - mean) * std::pow(std::sin(std::numbers::pi * static_cast<double>(i) / static_cast<double>(length)), 2.0);
      transform(x);
      for (std::size_t k = 0; k < power.size(); ++k) power[k] += 2.0 * std::norm(x[k]) * step_s / weight;
      windows += 1.0;
    }
  if (windows == 0.0) return std::nullopt;
  std::vector<double> out;
  for (std::size_t k = 1; k < power.size(); ++k) out.push_back(std::sqrt(power[k] / windows));
  return out;
}

std::vector<double> residual_of(const ModelledRecord& m) {
  std::vector<double> out(m.input->rows());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = m.residual(i);
  return out;
}

// Of the load without the steps in which the reference reads; empty where no column tells, or not in every row.
std::vector<double> command_of(const ModelledRecord& m) {
  const RecordInput& r = *m.input;
  std::vector<double> out = r.F_cmd_N;
  if (out.size() != r.rows()) {
    out = r.theta_rad;
    for (double& angle : out) angle = 1.0 - std::cos(angle);
  }
  if (out.size() != r.rows()) return {};
  for (std::size_t i = 0; i < out.size(); ++i)
    if (m.ok[i] != 0 && !std::isfinite(out[i])) return {};
  return out;
}

std::optional<ResidualSpectrum> spectrum_of(const ModelledRecord& m, const ModelledRecord* after) {
  constexpr std::size_t kShortest = 64, kLongest = 2048;
  std::vector<double> residual = residual_of(m), load(residual.size());
  for (std::size_t i = 0; i < residual.size(); ++i) load[i] = m.gain * m.model[i];
  std::vector<std::uint8_t> ok = m.ok;  // equal steps alone: not where the record was sampled more slowly than its rows are long
  for (std::size_t i = 1; i < ok.size(); ++i)
    if (m.input->t_s[i] - m.input->t_s[i - 1] > 1.5 * m.input->row_step_s) ok[i] = 0;
  const std::vector<Stretch> where = stretches(ok, residual);
  stretches(ok, load);
  std::size_t longest = 0, length = 1;
  for (const Stretch& s : where) longest = std::max(longest, s.size());
  while (2 * length <= std::min(longest / 2, kLongest)) length *= 2;
  if (length < kShortest) return std::nullopt;
  const double step_s = m.input->row_step_s;
  auto of_residual = density(residual, where, length, step_s), of_load = density(load, where, length, step_s);
  if (!of_residual || !of_load) return std::nullopt;
  ResidualSpectrum out{m.name, {}, std::move(*of_residual), std::move(*of_load), m.noise * std::sqrt(2.0 * step_s)};
  if (after != nullptr) {
    std::vector<double> left = residual_of(*after);
    stretches(ok, left);
    if (auto of_left = density(left, where, length, step_s)) out.after = std::move(*of_left);
  }
  if (std::vector<double> command = command_of(m); !command.empty()) {
    stretches(ok, command);
    if (auto of_command = density(command, where, length, step_s)) out.command = std::move(*of_command);
  }
  for (std::size_t k = 1; k <= out.residual.size(); ++k)
    out.f_Hz.push_back(static_cast<double>(k) / (static_cast<double>(length) * step_s));
  return out;
}

std::optional<ExtremaDecay> extrema_of(const ModelledRecord& m, const ModelledRecord* after) {
  constexpr double kProminence = 0.25, kFlat = 0.05;  // of the span
  constexpr std::size_t kFewest = 4;
  const RecordInput& r = *m.input;
  double low = INFINITY, high = -INFINITY;
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (m.ok[i] != 0) low = std::min(low, r.F_N[i]), high = std::max(high, r.F_N[i]);
  if (!(high > low)) return std::nullopt;
  ExtremaDecay out;
  out.record = m.name;
  for (const Extremum& turn : turning_points(r.t_s, r.F_N, kProminence * (high - low))) {
    auto at = static_cast<std::size_t>(std::lower_bound(r.t_s.begin(), r.t_s.end(), turn.t_s) - r.t_s.begin());
    if (at >= r.rows() || (at > 0 && turn.t_s - r.t_s[at - 1] < r.t_s[at] - turn.t_s)) --at;
    // two samples of one height make a plateau whose middle may be no peak
    if (m.ok[at] == 0 || std::abs(r.F_N[at] - turn.value) > kFlat * (high - low)) continue;
    TurningSeries& side = turn.turn == Turn::maximum ? out.maxima : out.minima;
    side.t_s.push_back(r.t_s[at]);
    side.measured.push_back(r.U_V[at]);
    side.modelled.push_back(m.zero + m.gain * m.model[at]);
    if (after != nullptr) side.after.push_back(after->zero + after->gain * after->model[at]);
  }
  if (out.maxima.t_s.size() < kFewest || out.minima.t_s.size() < kFewest) return std::nullopt;
  return out;
}

// Tenths of the rows that hold samples.
struct Tenths {
  std::vector<std::vector<std::size_t>> rows;
};
Tenths tenths_of(const ModelledRecord& m) {
  constexpr std::size_t kTenths = 10;
  std::vector<std::size_t> good;
  for (std::size_t i = 0; i < m.ok.size(); ++i)
    if (m.ok[i] != 0) good.push_back(i);
  Tenths out;
  for (std::size_t b = 0; b < kTenths; ++b)
    out.rows.emplace_back(good.begin() + static_cast<std::ptrdiff_t>(b * good.size() / kTenths),
                          good.begin() + static_cast<std::ptrdiff_t>((b + 1) * good.size() / kTenths));
  return out;
}

// Mean over all rows and its standard uncertainty from the means of tenths.
template <class Value>
std::pair<double, double> mean_of(const Tenths& tenths, const Value& value) {
  std::vector<double> means;
  double sum = 0.0, n = 0.0;
  for (const auto& rows : tenths.rows) {
    double part = 0.0;
    for (const std::size_t i : rows) part += value(i);
    sum += part, n += static_cast<double>(rows.size());
    if (!rows.empty()) means.push_back(part / static_cast<double>(rows.size()));
  }
  const double mean = sum / n, count = static_cast<double>(means.size());
  double square = 0.0;
  for (const double v : means) square += (v - mean) * (v - mean);
  return {mean, count > 1.0 ? std::sqrt(square / (count * (count - 1.0))) : NAN};
}

double jackknife_of_gain(const ModelledRecord& m, const Tenths& tenths) {
  std::vector<double> gains;
  std::vector<std::uint8_t> use = m.ok;
  for (const auto& rows : tenths.rows) {
    for (const std::size_t i : rows) use[i] = 0;
    if (const auto line = straight(m.model, m.input->U_V, [&](std::size_t i) { return use[i] != 0; })) gains.push_back(line->gain);
    for (const std::size_t i : rows) use[i] = 1;
  }
  double mean = 0.0, square = 0.0;
  const double n = static_cast<double>(gains.size());
  for (const double g : gains) mean += g / n;
  for (const double g : gains) square += (g - mean) * (g - mean);
  return n > 1.0 ? std::sqrt(square * (n - 1.0) / n) : NAN;
}

std::vector<RecordLevel> levels_of(const diagnose::Workspace& w, const std::vector<ModelledRecord>& records) {
  constexpr std::size_t kFewest = 3;
  constexpr double kMoves = 0.3;    // of the largest span
  constexpr double kUnknown = 0.2;  // relative standard uncertainty of a gain
  if (records.size() < kFewest) return {};
  double widest = 0.0;
  for (const ModelledRecord& m : records) widest = std::max(widest, m.span);
  std::vector<double> gains;
  for (const ModelledRecord& m : records)
    if (m.span >= kMoves * widest) gains.push_back(m.gain);
  const double gain = median(gains);
  std::vector<RecordLevel> out;
  std::vector<double> zeros;
  for (const ModelledRecord& m : records) {
    const RecordInput& r = *m.input;
    const Tenths tenths = tenths_of(m);
    RecordLevel level;
    level.record = m.name;
    level.start_s = r.start_s + (w.input.single ? r.t_s[tenths.rows.front().empty() ? 0 : tenths.rows.front().front()] : 0.0);
    std::tie(level.zero, level.u_zero) = mean_of(tenths, [&](std::size_t i) { return r.U_V[i] - gain * m.model[i]; });
    zeros.push_back(level.zero);
    level.gain_pct = level.u_gain_pct = level.reference_N = level.u_reference_N = NAN;
    const double u_gain = std::abs(jackknife_of_gain(m, tenths) / gain);
    if (m.span >= kMoves * widest && u_gain < kUnknown) {  // a single step is in one tenth: no gain without it
      level.gain_pct = 100.0 * (m.gain / gain - 1.0);
      level.u_gain_pct = 100.0 * u_gain;
    }
    if (w.rig_shows == RigShows::zero_of_records && r.rig_force_N.size() == r.rows())  // a record's own line has its zero in it
      std::tie(level.reference_N, level.u_reference_N) = mean_of(tenths, [&](std::size_t i) { return r.F_N[i] - r.rig_force_N[i]; });
    out.push_back(std::move(level));
  }
  const double middle = median(zeros);
  for (RecordLevel& level : out) level.zero -= middle;
  return out;
}

}  // namespace

RecordPictures record_pictures(const diagnose::Workspace& w, const Model& model, const Model* after) {
  RecordPictures out;
  out.unit = w.output.unit;
  std::vector<ModelledRecord> parts = modelled(w, model);
  out.levels = levels_of(w, parts);
  out.levels_over_time = w.input.has_start_times || w.input.single;
  std::vector<ModelledRecord> records = whole_records(w, std::move(parts));
  std::stable_sort(records.begin(), records.end(), [](const ModelledRecord& a, const ModelledRecord& b) { return a.rms > b.rms; });
  std::vector<ModelledRecord> with_effects;
  if (after != nullptr) with_effects = whole_records(w, modelled(w, *after));
  for (const ModelledRecord& m : records) {
    const auto at = std::ranges::find(with_effects, m.name, &ModelledRecord::name);
    const ModelledRecord* const same = at == with_effects.end() ? nullptr : &*at;
    if (out.spectra.size() < kMostRecordPictures)
      if (auto spectrum = spectrum_of(m, same)) out.spectra.push_back(std::move(*spectrum));
    if (out.extrema.size() < kMostRecordPictures)
      if (auto extrema = extrema_of(m, same)) out.extrema.push_back(std::move(*extrema));
  }
  if (out.spectra.empty()) out.missing.emplace_back("No spectrum of the residual: no record has 128 rows (means of up to 20 ms) without a gap.");
  if (out.extrema.empty()) out.missing.emplace_back("No maxima and minima over time: no record turns four times up and four times down over a quarter of its span.");
  if (out.levels.empty()) out.missing.emplace_back("No level over the records: that takes three records.");
  return out;
}

}  // namespace forcegate
