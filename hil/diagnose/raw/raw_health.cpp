#include "hil/diagnose/raw/raw_health.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "hil/base/parallel.h"
#include "hil/base/portable_math.h"
#include "hil/base/quantile.h"
#include "hil/diagnose/raw/falls_to_floor.h"
#include "hil/diagnose/raw/floor_by_force.h"
#include "hil/diagnose/raw/mains_line.h"
#include "hil/diagnose/raw/range_ends.h"
#include "hil/diagnose/raw/reference_scatter.h"
#include "hil/diagnose/raw/sample_noise.h"
#include "hil/diagnose/raw/short_spikes.h"
#include "hil/diagnose/raw/silent_runs.h"
#include "hil/diagnose/raw/suspect_runs.h"
#include "hil/model/came_in.h"
#include "hil/model/record_input.h"

namespace forcegate::diagnose {

namespace {

// The channel itself where it is as long as its clock; else `room`, with what is missing.
const std::vector<double>& aligned(const Channel& channel, std::size_t n, std::vector<double>& room) {
  if (channel.value.size() == n) return channel.value;
  room = channel.value;
  room.resize(n, kMissing);
  return room;
}

double middle_of_four(double a, double b, double c, double d) {
  const double low = std::min(std::min(a, b), std::min(c, d)),
               high = std::max(std::max(a, b), std::max(c, d));
  return 0.5 * (a + b + c + d - low - high);
}

// Of two channels, their sums of squares about the means.
struct Shared {
  double n = 0.0, FF = 0.0, FU = 0.0, UU = 0.0;
  std::optional<double> gain() const { return FF > 0.0 ? std::optional(FU / FF) : std::nullopt; }
};

Shared shared_by(std::span<const double> F, std::span<const double> U) {
  Shared out;
  double mean_F = 0.0, mean_U = 0.0;
  for (std::size_t i = 0; i < F.size(); ++i) {
    if (!std::isfinite(F[i] + U[i])) continue;
    out.n += 1.0;
    const double dF = F[i] - mean_F, dU = U[i] - mean_U;
    mean_F += dF / out.n;
    mean_U += dU / out.n;
    out.FF += dF * (F[i] - mean_F);
    out.FU += dF * (U[i] - mean_U);
    out.UU += dU * (U[i] - mean_U);
  }
  return out;
}

// A row that is lost whole is nobody's in particular.
void count_missing(const std::vector<double>& F, const std::vector<double>& U, RecordHealth& out) {
  std::size_t of_output = 0, of_reference = 0;  // lengths of the runs so far
  const auto end_run = [&](std::size_t& length) {
    out.missing_variance += static_cast<double>(length * length);
    length = 0;
  };
  for (std::size_t i = 0; i < F.size(); ++i) {
    const bool has_F = std::isfinite(F[i]), has_U = std::isfinite(U[i]);
    if (has_F && !has_U) {
      ++out.missing;
      out.missing_runs += of_output++ == 0 ? 1 : 0;
    } else {
      end_run(of_output);
    }
    if (has_U && !has_F) {
      ++out.reference_missing;
      ++of_reference;
    } else {
      end_run(of_reference);
    }
  }
  end_run(of_output);
  end_run(of_reference);
}

// Of one record where its force moves enough to tell; noise of the reference would make it small.
double gain_of_record(const Shared& shared, const HealthScales& scales) {
  constexpr double kEnough = 0.1;  // RMS, of the range
  return shared.FF > kEnough * kEnough * scales.range_N * scales.range_N * shared.n ? *shared.gain() : scales.gain_V_per_N;
}

// What the output typically does between two samples beside the force, as a standard deviation; 0 where the force does most of it. Of an output
// that rings it is no noise, and its peaks stand above every straight line through their neighbours.
double restlessness(const std::vector<double>& F, const std::vector<double>& U, double gain_V_per_N) {
  constexpr std::size_t kEnough = 20000;
  constexpr double kOfForce = 0.5;
  std::vector<double> moved, by_force;
  for (std::size_t i = 1; i < U.size(); i += 1 + U.size() / kEnough) {
    const double force = gain_V_per_N * (F[i] - F[i - 1]), beside = U[i] - U[i - 1] - force;
    if (!std::isfinite(beside)) continue;
    moved.push_back(std::abs(beside));
    by_force.push_back(std::abs(force));
  }
  if (moved.empty()) return 0.0;
  const double typical = quantile(std::move(moved), 0.5);
  return typical > kOfForce * quantile(std::move(by_force), 0.5) ? 1.4826 * typical : 0.0;
}

// What noise and steps do between two samples.
double quiet_of(const std::vector<double>& F, const std::vector<double>& U, double noise_V, double lsb_V, const HealthScales& scales) {
  constexpr double kOfRestless = 6.0;
  return std::max(8.0 * std::max(noise_V, 0.3 * lsb_V) + 0.012 * scales.U_range_V, kOfRestless * restlessness(F, U, scales.gain_V_per_N));
}

bool thrown_in_all(const Campaign& campaign, const HealthScales& scales, unsigned threads) {
  std::vector<std::vector<Jump>> of_record(campaign.records.size());
  std::vector<double> quiet_V(campaign.records.size(), 0.0);
  parallel_for(campaign.records.size(), threads, [&](std::size_t k) {
    const Trace& trace = campaign.records[k].trace;
    const Channel *f = trace.find("F_ref"), *u = trace.find("U");
    if (f == nullptr || u == nullptr) return;
    const std::vector<double>& t_s = trace.time_bases[f->time_base].t_s;
    std::vector<double> room_F, room_U;
    const std::vector<double>&F = aligned(*f, t_s.size(), room_F), &U = aligned(*u, t_s.size(), room_U);
    quiet_V[k] = quiet_of(F, U, white_noise(U), scales.step_V, scales);
    of_record[k] = excursions(t_s, F, U, {.quiet_V = quiet_V[k], .gain_V_per_N = std::abs(scales.gain_V_per_N)});
  });
  std::vector<Jump> all;
  for (const std::vector<Jump>& one : of_record) all.insert(all.end(), one.begin(), one.end());
  return !quiet_V.empty() && thrown_at_random(all, std::ranges::max(quiet_V));
}

}  // namespace

HealthScales health_scales(const Campaign& campaign, unsigned threads) {
  std::vector<double> F, U;
  for (const Record& record : campaign.records) {
    const Channel* f = record.trace.find("F_ref");
    const Channel* u = record.trace.find("U");
    if (f == nullptr || u == nullptr) continue;
    const std::size_t n = std::min(f->value.size(), u->value.size()),
                      stride = std::max<std::size_t>(1, n / 3000);
    std::size_t seen = 0;  // of those that are there: a stride over the rows may meet the missing ones alone
    for (std::size_t i = 0; i < n; ++i)
      if (std::isfinite(f->value[i]) && std::isfinite(u->value[i]) && seen++ % stride == 0) {
        F.push_back(f->value[i]);
        U.push_back(u->value[i]);
      }
  }
  HealthScales out;
  for (const Record& record : campaign.records)
    if (const Channel* u = record.trace.find("U"); u != nullptr && !u->unit.empty() && (u->unit != "1" || u->quantity == "ratio")) {
      out.unit = u->unit;
      break;
    }
  if (F.size() < 8) return out;
  out.range_N = std::max(1e-12, quantile(F, 0.999) - quantile(F, 0.001));
  out.U_range_V = std::max(1e-12, quantile(U, 0.999) - quantile(U, 0.001));
  out.gain_V_per_N = shared_by(F, U).gain().value_or(1.0);
  out.step_N = value_step(F);
  out.step_V = value_step(U);
  out.thrown = thrown_in_all(campaign, out, threads);
  return out;
}

namespace {

// Among spikes with tails, a short one at the low end is one of them that the end of the range cuts off. Lone ones that all fall to one level
// (`lone_fall`) are lost samples, others may be spikes.
void count_zeros(bool among_spikes, bool lone_fall, RecordHealth& out) {
  const auto is_zero = [&](std::size_t i) { return out.bad[i] == static_cast<std::uint8_t>(BadSample::zero); };
  for (std::size_t i = 0; i < out.bad.size(); ++i) {
    if (!is_zero(i)) continue;
    std::size_t end = i + 1;
    while (end < out.bad.size() && is_zero(end)) ++end;
    const std::size_t length = end - i;
    const bool of_spikes = among_spikes && length <= kLongestSpike;
    (of_spikes || (length == 1 && !lone_fall) ? out.lone_zeros : out.zeros) += length;
    out.zero_runs += of_spikes ? 0 : 1;
    i = end;
  }
}

std::size_t parts_of_record(const std::vector<std::size_t>& samples, std::size_t n) {
  constexpr std::size_t kParts = 8;
  std::array<bool, kParts> in{};
  for (const std::size_t i : samples) in[kParts * i / n] = true;
  return static_cast<std::size_t>(std::ranges::count(in, true));
}

}  // namespace

RecordHealth check_raw_health(const Record& record, const HealthScales& scales, const BenchFacts& bench) {
  RecordHealth out;
  out.record = record.name;
  const Channel* f = record.trace.find("F_ref");
  const Channel* u = record.trace.find("U");
  if (f == nullptr || u == nullptr) return out;
  const auto& t = record.trace.time_bases[f->time_base].t_s;
  assert(u->time_base == f->time_base);
  const std::size_t n = t.size();
  std::vector<double> room_F, room_U;
  const std::vector<double>&F = aligned(*f, n, room_F), &U = aligned(*u, n, room_U);
  out.samples = n;
  out.bad.assign(n, 0);
  out.gaps = record.trace.time_bases[f->time_base].gaps.size();
  if (n < 16) return out;
  count_missing(F, U, out);
  out.noise_U_V = white_noise(U);
  out.noise_F_N = std::min(white_noise(F), restless_noise(t, F));
  const Shared shared = shared_by(F, U);
  out.scatter_F = reference_scatter(t, F, U, {.range_V = scales.U_range_V, .gain_V_per_N = gain_of_record(shared, scales), .noise_V = out.noise_U_V, .step_N = value_step(F)});
  if (shared.n > 0.0 && shared.UU > 0.0) out.beside_line_N = std::sqrt(std::max(0.0, shared.FF - shared.FU * shared.FU / shared.UU) / shared.n);
  const double low_rail = lowest_code_V(bench);
  out.lsb_U_V = value_step(U);
  out.lsb_F_N = value_step(F);
  // a few levels of a staircase show no step: it is then that of all records, or the one that the converter is said to have
  if (out.lsb_F_N == 0.0) out.lsb_F_N = scales.step_N;
  if (are_set_levels(F, out.lsb_F_N, U, scales.gain_V_per_N)) out.lsb_F_N = 0.0;
  if (out.lsb_U_V == 0.0) out.lsb_U_V = scales.step_V;
  if (out.lsb_U_V == 0.0 && bench.adc_bits > 0 && shows_few_values(U))
    out.lsb_U_V = (std::isfinite(bench.voltage_max_V) ? bench.voltage_max_V - low_rail : scales.U_range_V) / std::exp2(bench.adc_bits);
  const double gain = std::abs(scales.gain_V_per_N);
  const double quiet = quiet_of(F, U, out.noise_U_V, out.lsb_U_V, scales);

  const RangeEnds ends = ends_of_range(U, low_rail, bench.voltage_max_V, out.lsb_U_V, out.noise_U_V);
  const StepsOfOutput steps(F, U, gain, quiet);
  const double most_V = std::max(scales.U_range_V, std::isfinite(bench.voltage_max_V) ? bench.voltage_max_V - low_rail : 0.0);
  std::optional<FloorByForce> floor;
  const auto belongs_at_floor = [&](std::size_t i) {
    constexpr double kNear = 0.005;  // of the range
    if (!floor) floor.emplace(F, U, low_rail + out.lsb_U_V + 1e-9, std::max(3.0 * out.noise_F_N, kNear * scales.range_N));
    return floor->belongs_there(F[i]);
  };
  const auto mark = [&](std::size_t i, BadSample why, double error) {
    if (why == BadSample::zero && belongs_at_floor(i)) return;
    error = std::min(std::abs(error), most_V);  // a logger's 9.9e37 is as far off as the output can be
    if (out.bad[i] == 0) out.bad_mean_square_V2 += error * error;
    out.bad[i] = static_cast<std::uint8_t>(why);
  };
  const double near_V = out.near_V = std::max({1.5 * out.lsb_U_V, 4.0 * out.noise_U_V, 0.005 * scales.U_range_V});  // levels that are one
  for (const Fall& fall : falls_to_floor(F, U, steps, near_V, scales.U_range_V))
    for (std::size_t i = fall.begin; i < fall.end; ++i) mark(i, BadSample::zero, std::min(U[fall.begin - 1], U[fall.end]) - U[i]);
  std::vector<std::size_t> spike;
  std::vector<double> spike_level;
  std::vector<Jump> spike_jumps;
  // a spike comes back, and its neighbours know nothing of it; what stays is an edge, or held samples that were let go, and what they
  // climb to is a peak
  const auto stands_alone = [&](std::size_t i, double jump) {
    return std::abs(U[i + 1] - U[i - 1]) < 0.6 * jump && std::abs(U[i - 1] + U[i + 1] - U[i - 2] - U[i + 2]) < 0.8 * jump;
  };
  // missing, spikes and zeros: a sample against its neighbours, allowing for what the force does there
  for (std::size_t i = 2; i + 2 < n; ++i) {
    if (!std::isfinite(U[i])) {
      out.bad[i] = static_cast<std::uint8_t>(BadSample::missing);
      continue;
    }
    const double middle = middle_of_four(U[i - 2], U[i - 1], U[i + 1], U[i + 2]);
    const double jump = std::abs(U[i] - middle);
    if (!(jump > quiet)) continue;
    const auto [low, high] = spread_of_present({&F[i - 2], 5});
    if (!steps.exceeds(jump, high - low)) continue;
    if (std::abs(U[i] - low_rail) < 1e-9 + out.lsb_U_V) {
      if (steps.calm_before(i) || steps.calm_behind(i + 1, U[i])) mark(i, BadSample::zero, jump);
    } else if (stands_alone(i, jump) && jump > kAboveAround * scatter_around(U, i)) {
      spike.push_back(i);
      spike_level.push_back(middle);
      spike_jumps.push_back({middle, U[i]});
    }
  }
  std::vector<ShortSpike> short_spikes = find_short_spikes(t, F, U, {quiet, gain, scales.thrown}, spike_jumps);
  std::erase_if(short_spikes, [&](const ShortSpike& s) { return out.bad[s.begin] == static_cast<std::uint8_t>(BadSample::zero); });
  for (const ShortSpike& s : short_spikes)
    for (std::size_t i = s.begin; i < s.begin + s.length; ++i) {
      mark(i, BadSample::outlier, s.peak_V);
      ++out.outliers;
      out.outlier_square_V2 += s.peak_V * s.peak_V;
    }
  // the first sample of one that falls quickly stands alone too
  std::size_t alone = 0;
  for (std::size_t k = 0; k < spike.size(); ++k) {
    if (out.bad[spike[k]] != 0) continue;
    spike[alone] = spike[k];
    spike_level[alone++] = spike_level[k];
  }
  spike.resize(alone);
  spike_level.resize(alone);
  const LoneSpikes lone{U, spike, spike_level};
  bool lone_fall = false;
  if (fall_to_one_level(lone, near_V)) {
    for (std::size_t k = 0; k < spike.size(); ++k) mark(spike[k], BadSample::zero, U[spike[k]] - spike_level[k]);
    lone_fall = true;
    spike.clear(), spike_level.clear();
  }
  const double bit_V = common_bit_V(lone, bench.voltage_max_V - low_rail, scales.U_range_V);
  if (!sit_at_fixed_levels(lone) || (bit_V > 0.0 && stay_on_one_side(lone, F, scales.gain_V_per_N, bit_V))) {
    std::vector<double> size;
    for (std::size_t k = 0; k < spike.size(); ++k) size.push_back(std::abs(U[spike[k]] - spike_level[k]));
    out.bit_V = bit_V;
    out.outlier_parts = parts_of_record(spike, n);
    (out.bit_V > 0.0 ? out.bit_errors : out.outliers) += spike.size();
    if (out.bit_V == 0.0) out.lone_jumps = jumps_of(lone);
    for (std::size_t k = 0; k < spike.size(); ++k) {
      mark(spike[k], out.bit_V > 0.0 ? BadSample::bit : BadSample::outlier, size[k]);
      if (out.bit_V == 0.0) out.outlier_square_V2 += size[k] * size[k];
    }
  }
  out.top_V = *std::max_element(U.begin(), U.end(), [](double a, double b) {
    return (std::isfinite(a) ? a : -1e300) < (std::isfinite(b) ? b : -1e300);
  });
  const RunScales of_runs{.gain_V_per_N = gain, .U_range_V = scales.U_range_V, .noise_F_N = out.noise_F_N, .noise_U_V = out.noise_U_V, .lsb_U_V = out.lsb_U_V, .rises = scales.gain_V_per_N >= 0.0,
                          .low_V = low_rail, .high_V = bench.voltage_max_V, .top_V = out.top_V, .quiet_V = quiet};
  for (const SuspectRun& run : find_suspect_runs(F, U, of_runs)) {
    if (out.bad[run.begin] == static_cast<std::uint8_t>(BadSample::zero)) continue;  // a fall to the record's floor
    for (std::size_t k = run.begin; k < run.end; ++k) mark(k, run.why, run.error_V);
    const std::size_t length = run.end - run.begin;
    if (run.why == BadSample::zero) continue;  // count_zeros
    if (run.begin > 0) out.runs.push_back({U[run.begin], U[run.begin - 1], length, run.error_V});
    (run.why == BadSample::rail ? out.at_rail : out.held) += length;
    if (run.why == BadSample::rail) out.rail_V = U[run.begin];
  }
  for (const SilentRun& run : find_silent_runs(U, out.lsb_U_V, out.noise_U_V)) {
    const auto is = [&](BadSample why) { return out.bad[run.begin] == static_cast<std::uint8_t>(why); };
    if (!is(BadSample::none) && !is(BadSample::held)) continue;
    ++out.silent_runs;
    if (is(BadSample::held)) continue;
    out.silent += run.end - run.begin;
    for (std::size_t k = run.begin; k < run.end; ++k) mark(k, BadSample::held, 0.0);
  }
  count_zeros(scales.thrown || !short_spikes.empty(), lone_fall, out);
  out.bad_mean_square_V2 /= static_cast<double>(n);
  // a rail cuts noise off: what comes near it is bent too
  const double bent_V = out.at_rail > 0 ? out.rail_V - std::max(1.5 * out.lsb_U_V, 3.0 * out.noise_U_V) : std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < n; ++i)
    if (out.bad[i] == 0 && (U[i] >= bent_V || ends.holds(U[i]))) out.bad[i] = static_cast<std::uint8_t>(BadSample::censored);
  const MainsLine line = find_mains_line(t, F, U, scales.gain_V_per_N);
  out.hum_V = line.amplitude_V;
  out.hum_Hz = line.frequency_Hz;
  out.hum_ratio = line.ratio;
  out.mains_Hz = line.mains_Hz;
  out.rate_Hz = line.rate_Hz;
  return out;
}

}  // namespace forcegate::diagnose
