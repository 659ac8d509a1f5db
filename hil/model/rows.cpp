#include "hil/model/rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "hil/base/evenly_chosen.h"
#include "hil/base/quantile.h"
#include "hil/base/text.h"
#include "hil/model/states.h"

namespace forcegate {

namespace {

// The channel itself where it has that clock already; else `room`, filled along straight lines.
const std::vector<double>& on_clock(const Trace& trace, const Channel& channel, std::size_t clock,
                                    std::vector<double>& room) {
  if (channel.time_base == clock) return channel.value;
  const auto& from = trace.time_bases[channel.time_base].t_s;
  const auto& to = trace.time_bases[clock].t_s;
  std::vector<double>& out = room;
  out.assign(to.size(), kMissing);
  if (from.size() < 2) return out;
  std::size_t j = 0;
  for (std::size_t i = 0; i < to.size(); ++i) {
    while (j + 2 < from.size() && from[j + 1] <= to[i]) ++j;
    if (to[i] < from[j] || to[i] > from[j + 1]) continue;
    const double share = (to[i] - from[j]) / (from[j + 1] - from[j]);
    out[i] = channel.value[j] + share * (channel.value[j + 1] - channel.value[j]);
  }
  return out;
}

// An encoder that begins anew after every turn goes on here: between 6.2 and 0.1 lies 6.3, and not 3.1.
Channel unwrapped(Channel angle) {
  constexpr double kTurn_rad = 2.0 * std::numbers::pi;
  double before = kMissing, turns = 0.0;
  for (double& v : angle.value) {
    if (!std::isfinite(v)) continue;
    if (std::isfinite(before)) turns -= std::round((v - before) / kTurn_rad);
    before = v;
    v += turns * kTurn_rad;
  }
  return angle;
}

constexpr std::size_t kSteps = 4;  // over which rounded stamps of a uniform clock average out

double median_step(const std::vector<double>& t) {
  constexpr double kRounded = 0.1;
  std::vector<double> steps, means;
  EvenlyChosen choice(t.size(), 5000);
  for (std::size_t i = 1; i < t.size(); ++i) {
    if (!choice.next()) continue;
    steps.push_back(t[i] - t[i - 1]);
    if (i >= kSteps) means.push_back((t[i] - t[i - kSteps]) / static_cast<double>(kSteps));
  }
  if (steps.empty()) return 1.0;
  const double step = quantile(std::move(steps), 0.5), mean = quantile(std::move(means), 0.5);
  return std::abs(mean - step) > kRounded * step ? mean : step;
}

// Of a clock that begins anywhere: to the nanosecond, so that what is cut at an instant is cut there whatever the constant was.
std::vector<double> since_start(std::vector<double> t) {
  constexpr double kPerSecond = 1e9;
  for (const double t0 = t.empty() ? 0.0 : t.front(); double& v : t) v = std::round((v - t0) * kPerSecond) / kPerSecond;
  return t;
}

// Of sample k, over the steps before it or behind it: beside a hole the other side tells.
double step_around(const std::vector<double>& t, std::size_t k) {
  double out = std::numeric_limits<double>::infinity();
  if (k >= kSteps) out = (t[k] - t[k - kSteps]) / static_cast<double>(kSteps);
  if (k + kSteps < t.size()) out = std::min(out, (t[k + kSteps] - t[k]) / static_cast<double>(kSteps));
  return out;
}

double first_finite(const std::vector<double>& x) {
  const auto found = std::ranges::find_if(x, [](double v) { return std::isfinite(v); });
  return found == x.end() ? 0.0 : *found;
}

// Missing forces are held, so that the states of plays and filters stay finite.
void hold(std::vector<double>& x, double last) {
  for (double& v : x) {
    if (std::isfinite(v)) last = v;
    v = last;
  }
}

// First sample of each row, and the end of the last. A row holds `samples` where the clock goes as it mostly does; where the rate is
// another its length in time decides, so that rows stay about equally long, and none reaches over a hole.
std::vector<std::uint32_t> cut_rows(const std::vector<double>& t, double row_step_s, std::size_t samples) {
  constexpr double kLonger = 1.5;  // a jittering clock stays below
  const double step_s = row_step_s / static_cast<double>(samples);
  std::vector<std::uint32_t> begin = {0};
  for (std::size_t k = 1; k <= t.size(); ++k) {
    const double next_s = k < t.size() ? t[k] : t[k - 1] + (t[k - 1] - t[k - 2]), length_s = next_s - t[begin.back()];
    const bool full = k - begin.back() >= samples && (length_s > row_step_s / kLonger || step_around(t, k - 1) > step_s / kLonger);
    if (full || length_s > kLonger * row_step_s) begin.push_back(static_cast<std::uint32_t>(k));
  }
  return begin;
}

struct RowMeans {
  const RecordInput& record;
  std::vector<double> operator()(const std::vector<double>& x) const {
    std::vector<double> out(record.rows());
    for (std::size_t r = 0; r < record.rows(); ++r) {
      double sum = 0.0, n = 0.0;
      for (std::uint32_t k = record.row_begin[r]; k < record.row_begin[r + 1]; ++k)
        if (std::isfinite(x[k])) {
          sum += x[k];
          n += 1.0;
        }
      out[r] = n > 0.0 ? sum / n : kMissing;
    }
    return out;
  }
};

void set_angle(const std::vector<double>& theta, const std::vector<double>& t, RecordInput& out) {
  double angle = first_finite(theta), before = std::cos(angle), late = before;
  LowPass pole(kLateAngle_s, before);
  out.sin_theta.reserve(out.rows());
  out.cos_theta.reserve(out.rows());
  out.late_cos_theta.reserve(out.rows());
  for (std::size_t r = 0; r < out.rows(); ++r) {
    double sum_sin = 0.0, sum_cos = 0.0, sum_late = 0.0;
    const std::uint32_t begin = out.row_begin[r], end = out.row_begin[r + 1];
    for (std::uint32_t k = begin; k < end; ++k) {
      if (std::isfinite(theta[k])) angle = theta[k];
      const double cosine = std::cos(angle);
      if (k > 0) late = pole.step(before, cosine, t[k] - t[k - 1]);
      before = cosine;
      sum_sin += std::sin(angle);
      sum_cos += cosine;
      sum_late += late;
    }
    const double n = static_cast<double>(end - begin);
    out.sin_theta.push_back(sum_sin / n);
    out.cos_theta.push_back(sum_cos / n);
    out.late_cos_theta.push_back(sum_late / n);
  }
}

// The force is held over what is missing at its end too.
void set_full_rate(std::vector<double> t, std::vector<double> F, RecordInput& out) {
  const std::size_t used = out.row_begin.back();
  hold(F, first_finite(F));
  F.resize(used);
  t.resize(used);
  out.fast_t_s = since_start(std::move(t));
  out.fast_F_N = std::move(F);
}

constexpr double kFewestOfOneRecording = 200.0;  // rows, that prepare() of a diagnosis asks of a single one

Unexpected too_short(const Record& record, std::size_t samples, std::string hint) {
  return fail(ErrorCode::parse, "the record has only " + std::to_string(samples) + (samples == 1 ? " sample" : " samples"), record.place(), std::move(hint));
}

// Means of time, force and output over the rows, and which of them are whole.
void set_means(const std::vector<double>& t, const std::vector<double>& force, const std::vector<double>& output, std::span<const std::uint8_t> bad, RecordInput& out) {
  const std::size_t n_rows = out.row_begin.size() - 1;
  out.t_s.resize(n_rows);
  out.U_V.resize(n_rows);
  out.F_N.resize(n_rows);
  out.ok.assign(n_rows, 1);
  double last_F = first_finite(force);
  for (std::size_t r = 0; r < n_rows; ++r) {
    double sum_t = 0.0, sum_F = 0.0, sum_U = 0.0;
    const std::uint32_t begin = out.row_begin[r], end = out.row_begin[r + 1];
    for (std::uint32_t k = begin; k < end; ++k) {
      if (std::isfinite(force[k]))
        last_F = force[k];
      else
        out.ok[r] = 0;
      sum_t += t[k];
      sum_F += last_F;
      sum_U += output[k];
      if ((!bad.empty() && bad[k] != 0) || !std::isfinite(output[k])) out.ok[r] = 0;
    }
    const double n = end - begin;
    out.t_s[r] = sum_t / n;
    out.F_N[r] = sum_F / n;
    out.U_V[r] = sum_U / n;
    if (!std::isfinite(out.U_V[r])) out.U_V[r] = 0.0;
  }
  // a row next to a hole in the clock carries states of unknown age
  for (std::size_t r = 1; r < n_rows; ++r)
    if (follows_hole(out, r, 4.0 * out.row_step_s)) out.ok[r] = 0;
}

// What was recorded beside force and output; empty where it was not.
void set_further_channels(const Trace& trace, std::size_t clock, const std::vector<double>& t, bool angle, RecordInput& out) {
  std::vector<double> room;
  const RowMeans mean{out};
  const auto rows_of = [&](const std::vector<double>& values) -> std::vector<double> {
    std::vector<double> rows = mean(values);
    if (std::ranges::none_of(rows, [](double v) { return std::isfinite(v); })) return {};
    hold(rows, first_finite(rows));
    return rows;
  };
  const auto channel = [&](const char* name) -> std::vector<double> {
    const Channel* c = trace.find(name);
    return c == nullptr ? std::vector<double>{} : rows_of(on_clock(trace, *c, clock, room));
  };
  if (const Channel* theta = trace.find("theta")) {
    const Channel whole = unwrapped(*theta);
    const std::vector<double>& angles = on_clock(trace, whole, clock, room);
    out.theta_rad = rows_of(angles);
    if (angle && !out.theta_rad.empty()) set_angle(angles, t, out);
  }
  out.temp_C = channel("temp");
  out.humidity = channel("humidity");
  for (double& h : out.humidity) h *= 100.0;  // a share in the file; effects and records' own readings are in percent
  out.C_F = channel("C");
  out.F_cmd_N = channel("F_cmd");
  out.drive_V = channel("drive");
}

// What was written down of the record. One reading of the air says less than a channel, and all about what happens between records.
void set_declared(const Record& record, RecordInput& out) {
  if (out.temp_C.empty() && record.temp_C) out.temp_C.assign(out.rows(), *record.temp_C);
  if (out.humidity.empty() && record.humidity_pct) out.humidity.assign(out.rows(), *record.humidity_pct);
  out.start_s = record.start_s.value_or(kMissing);
  out.rest_before_s = record.rest_before_s.value_or(kMissing);
  out.cycles_before = record.cycles_before.value_or(0.0);
  out.drive_mean_V = record.drive_V.value_or(out.drive_V.empty() ? kMissing : quantile(out.drive_V, 0.5));
  out.mounting_name = record.mounting;
  out.eccentricity_mm = record.eccentricity_mm.value_or(kMissing);
  out.preload_mm = record.preload_mm.value_or(kMissing);
}

Result<RecordInput> make_rows(const Record& record, std::span<const std::uint8_t> bad, double row_step_s, bool angle) {
  const Trace& trace = record.trace;
  const Channel* F = trace.find("F_ref");
  const Channel* U = trace.find("U");
  if (F == nullptr || U == nullptr)
    return fail(ErrorCode::parse, std::string("the record has no channel ") + (F == nullptr ? "F_ref" : "U"),
                record.place_of_header(), "name the columns F_ref_N and U_V, or map yours with --map OTHER=F_ref_N");
  const std::size_t clock = F->time_base;
  const std::vector<double> t = since_start(trace.time_bases[clock].t_s);
  if (static_cast<double>(t.size()) < kFewestRows) return too_short(record, t.size(), "at least 16 samples are needed, and " + shortest(kFewestOfOneRecording) + " of a recording that is diagnosed alone");

  RecordInput out;
  out.name = record.name;
  out.kind = record.kind;
  out.heldout = record.role == RecordRole::heldout;
  const double step = median_step(t);
  const double samples = samples_of_row(step, row_step_s), needed = kFewestRows * samples;
  if (!(static_cast<double>(t.size()) >= needed)) return too_short(record, t.size(), "at least " + shortest(needed) + " are needed at this rate, and " + shortest(kFewestOfOneRecording * samples) + " of a recording that is diagnosed alone; leave the record out");
  out.row_step_s = step * samples;
  out.row_begin = cut_rows(t, out.row_step_s, static_cast<std::size_t>(samples));
  out.clock_start_s = trace.time_bases[clock].t_s.front();
  out.duration_s = t.back();

  std::vector<double> room;
  set_means(t, F->value, on_clock(trace, *U, clock, room), bad, out);
  set_further_channels(trace, clock, t, angle, out);
  set_declared(record, out);
  set_rates(out);
  out.decay.assign(out.rows(), 1.0);
  return out;
}

}  // namespace

void set_rates(RecordInput& r) {
  r.rate_N_per_s.assign(r.rows(), 0.0);
  for (std::size_t i = 1; i + 1 < r.rows(); ++i) r.rate_N_per_s[i] = (r.F_N[i + 1] - r.F_N[i - 1]) / (r.t_s[i + 1] - r.t_s[i - 1]);
}

bool follows_hole(const RecordInput& record, std::size_t row, double longest_step_s) {
  constexpr double kAlike = 1.5;
  const auto step_s = [&](std::size_t i) { return i > 0 && i < record.rows() ? record.t_s[i] - record.t_s[i - 1] : 0.0; };
  const double step = step_s(row);
  return step > longest_step_s && step > kAlike * step_s(row - 1) && step > kAlike * step_s(row + 1);
}

Result<RecordInput> make_record_input(const Record& record, std::span<const std::uint8_t> bad,
                                      double row_step_s, const RowParts& parts) {
  FORCEGATE_TRY(RecordInput out, make_rows(record, bad, row_step_s, parts.angle));
  const Channel& F = *record.trace.find("F_ref");
  if (parts.full_rate) set_full_rate(record.trace.time_bases[F.time_base].t_s, F.value, out);
  return out;
}

Result<RecordInput> take_record_input(Record& record, std::span<const std::uint8_t> bad, double row_step_s,
                                      const RowParts& parts) {
  FORCEGATE_TRY(RecordInput out, make_rows(record, bad, row_step_s, parts.angle));
  Channel& F = *record.trace.find("F_ref");
  if (parts.full_rate)
    set_full_rate(std::move(record.trace.time_bases[F.time_base].t_s), std::move(F.value), out);
  return out;
}

}  // namespace forcegate
