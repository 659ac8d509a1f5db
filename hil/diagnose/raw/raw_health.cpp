#include "hil/diagnose/raw/raw_health.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "hil/diagnose/raw/falls_to_floor.h"
#include "hil/diagnose/raw/lone_samples.h"
#include "hil/diagnose/raw/mains_line.h"
#include "hil/diagnose/raw/range_ends.h"
#include "hil/diagnose/raw/record_scales.h"
#include "hil/diagnose/raw/repeated_blocks.h"
#include "hil/diagnose/raw/sample_marks.h"
#include "hil/diagnose/raw/sample_noise.h"
#include "hil/diagnose/raw/silent_runs.h"
#include "hil/diagnose/raw/suspect_runs.h"

namespace forcegate::diagnose {

namespace {

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
double gain_of_record(const JointSquares& squares, const RecordScales& scales) {
  constexpr double kEnough = 0.1;  // RMS, of the range
  const bool tells = squares.FF > kEnough * kEnough * scales.range_N * scales.range_N * squares.n;
  return tells ? *squares.gain_V_per_N() : scales.gain_V_per_N;
}

// The output as it is where it tells of the force: one that is held stands still whatever the force does.
std::vector<double> telling_output(const std::vector<double>& U, const std::vector<std::uint8_t>& bad) {
  std::vector<double> out = U;
  for (std::size_t i = 0; i < out.size(); ++i)
    if (bad[i] == static_cast<std::uint8_t>(BadSample::held) || bad[i] == static_cast<std::uint8_t>(BadSample::zero)) out[i] = std::numeric_limits<double>::quiet_NaN();
  return out;
}

// After the bad samples are found.
void measure_reference(const ForceAndOutput& samples, const RecordScales& scales, RecordHealth& out) {
  const JointSquares squares = joint_squares(samples.F_N(), samples.U_V());
  out.scatter_F = reference_scatter(samples.t_s(), samples.F_N(), telling_output(samples.U_V(), out.bad),
                                    {.range_V = scales.U_range_V,
                                     .gain_V_per_N = gain_of_record(squares, scales),
                                     .noise_V = scales.noise_U_V,
                                     .step_N = value_step(samples.F_N())});
  if (squares.n > 0.0 && squares.UU > 0.0)
    out.beside_line_N = std::sqrt(std::max(0.0, squares.FF - squares.FU * squares.FU / squares.UU) / squares.n);
}

void mark_falls(const ForceAndOutput& samples, const StepsOfOutput& steps, const RecordScales& scales, SampleMarks& marks) {
  const std::vector<double>& U = samples.U_V();
  for (const Fall& fall : falls_to_floor(samples.F_N(), U, steps, scales.near_V, scales.U_range_V))
    for (std::size_t i = fall.begin; i < fall.end; ++i) marks.mark(i, BadSample::zero, std::min(U[fall.begin - 1], U[fall.end]) - U[i]);
}

// Like lone samples, not at the very ends of the record.
void mark_missing(const std::vector<double>& U, SampleMarks& marks) {
  for (std::size_t i = 2; i + 2 < U.size(); ++i)
    if (!std::isfinite(U[i])) marks.mark(i, BadSample::missing, 0.0);
}

// A line repeats itself: beside one as large as the noise an equal block says nothing.
void mark_repeated(const ForceAndOutput& samples, const RecordScales& scales, SampleMarks& marks, RecordHealth& out) {
  constexpr double kOfNoise = 0.5;
  if (out.hum_ratio > kPlainLine && out.hum_V > kOfNoise * scales.noise_U_V) return;
  const std::vector<double>& U = samples.U_V();
  for (const RepeatedBlock& block : find_repeated_blocks(U, samples.F_N(), scales.lsb_U_V, scales.noise_U_V)) {
    ++out.repeated_blocks;
    out.repeated += block.end - block.begin;
    // from where it came to where it goes on, along a straight line
    const double before_V = U[block.begin - 1], after_V = block.end < U.size() ? U[block.end] : before_V;
    const double step_V = (after_V - before_V) / static_cast<double>(block.end - block.begin + 1);
    for (std::size_t i = block.begin; i < block.end; ++i)
      marks.mark(i, BadSample::held, U[i] - before_V - step_V * static_cast<double>(i - block.begin + 1));
  }
}

void mark_lone(const std::vector<double>& U, const LoneSamples& lone, BadSample why, SampleMarks& marks) {
  for (std::size_t k = 0; k < lone.at.size(); ++k) marks.mark(lone.at[k], why, U[lone.at[k]] - lone.level_V[k]);
}

// Whether there are some.
bool mark_short_spikes(const ForceAndOutput& samples, const RecordScales& scales, bool thrown, const LoneSamples& lone, SampleMarks& marks,
                       RecordHealth& out) {
  std::vector<ShortSpike> spikes = find_short_spikes(samples.t_s(), samples.F_N(), samples.U_V(),
                                                     {.quiet_V = scales.quiet_V, .gain_V_per_N = std::abs(scales.gain_V_per_N), .thrown = thrown},
                                                     jumps_of({samples.U_V(), lone.at, lone.level_V}));
  std::erase_if(spikes, [&](const ShortSpike& s) { return marks.at(s.begin) == BadSample::zero; });
  for (const ShortSpike& s : spikes)
    for (std::size_t i = s.begin; i < s.begin + s.length; ++i) {
      marks.mark(i, BadSample::outlier, s.peak_V);
      ++out.outliers;
      out.outlier_square_V2 += s.peak_V * s.peak_V;
    }
  return !spikes.empty();
}

// The first sample of a short spike that falls quickly stands alone too.
LoneSamples unmarked(const LoneSamples& lone, const SampleMarks& marks) {
  LoneSamples out;
  for (std::size_t k = 0; k < lone.at.size(); ++k) {
    if (marks.at(lone.at[k]) != BadSample::none) continue;
    out.at.push_back(lone.at[k]);
    out.level_V.push_back(lone.level_V[k]);
  }
  return out;
}

std::size_t parts_of_record(const std::vector<std::size_t>& samples, std::size_t n) {
  constexpr std::size_t kParts = 8;
  std::array<bool, kParts> in{};
  for (const std::size_t i : samples) in[kParts * i / n] = true;
  return static_cast<std::size_t>(std::ranges::count(in, true));
}

// Outliers, or errors of one bit of the converter; steps of its curve are neither.
void mark_lone_spikes(const ForceAndOutput& samples, const RecordScales& scales, const LoneSamples& spikes, SampleMarks& marks, RecordHealth& out) {
  const std::vector<double>& U = samples.U_V();
  const LoneSpikes lone{U, spikes.at, spikes.level_V};
  const double bit_V = common_bit_V(lone, scales.high_V - scales.low_V, scales.U_range_V);
  const bool of_bit = bit_V > 0.0;
  if (sit_at_fixed_levels(lone) && !(of_bit && stay_on_one_side(lone, samples.F_N(), scales.gain_V_per_N, bit_V))) return;
  out.bit_V = bit_V;
  out.outlier_parts = parts_of_record(spikes.at, samples.size());
  mark_lone(U, spikes, of_bit ? BadSample::bit : BadSample::outlier, marks);
  if (of_bit) {
    out.bit_errors += spikes.at.size();
    return;
  }
  out.outliers += spikes.at.size();
  out.lone_jumps = jumps_of(lone);
  for (const Jump& jump : out.lone_jumps) out.outlier_square_V2 += (jump.to_V - jump.from_V) * (jump.to_V - jump.from_V);
}

// What a spike throws above a rail is no top of the output.
double largest_unmarked(const std::vector<double>& values, const SampleMarks& marks) {
  double out = -1e300;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (marks.at(i) == BadSample::none && std::isfinite(values[i])) out = std::max(out, values[i]);
  return out;
}

void mark_suspect_runs(const ForceAndOutput& samples, const RecordScales& scales, SampleMarks& marks, RecordHealth& out) {
  const std::vector<double>& U = samples.U_V();
  const RunScales of_runs{.gain_V_per_N = std::abs(scales.gain_V_per_N),
                          .U_range_V = scales.U_range_V,
                          .noise_F_N = scales.noise_F_N,
                          .noise_U_V = scales.noise_U_V,
                          .lsb_U_V = scales.lsb_U_V,
                          .rises = scales.gain_V_per_N >= 0.0,
                          .low_V = scales.low_V,
                          .high_V = scales.high_V,
                          .top_V = out.top_V,
                          .quiet_V = scales.quiet_V};
  for (const SuspectRun& run : find_suspect_runs(samples.F_N(), U, of_runs)) {
    if (marks.at(run.begin) == BadSample::zero) continue;  // a fall to the record's floor
    for (std::size_t k = run.begin; k < run.end; ++k) marks.mark(k, run.why, run.error_V);
    const std::size_t length = run.end - run.begin;
    if (run.why == BadSample::zero) continue;  // count_zeros
    if (run.begin > 0) out.runs.push_back({U[run.begin], U[run.begin - 1], length, run.error_V});
    (run.why == BadSample::rail ? out.at_rail : out.held) += length;
    if (run.why == BadSample::rail) out.rail_V = U[run.begin];
  }
}

void mark_silent_runs(const ForceAndOutput& samples, const RecordScales& scales, SampleMarks& marks, RecordHealth& out) {
  for (const SilentRun& run : find_silent_runs(samples.U_V(), scales.lsb_U_V, scales.noise_U_V)) {
    const BadSample marked = marks.at(run.begin);
    if (marked != BadSample::none && marked != BadSample::held) continue;
    ++out.silent_runs;
    if (marked == BadSample::held) continue;
    out.silent += run.end - run.begin;
    for (std::size_t k = run.begin; k < run.end; ++k) marks.mark(k, BadSample::held, 0.0);
  }
}

// Among spikes with tails, a short one at the low end is one of them that the end of the range cuts off. Lone ones that all fall to one level
// (`lone_fall`) are lost samples, others may be spikes.
void count_zeros(const SampleMarks& marks, bool among_spikes, bool lone_fall, RecordHealth& out) {
  const auto is_zero = [&](std::size_t i) { return marks.at(i) == BadSample::zero; };
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (!is_zero(i)) continue;
    std::size_t end = i + 1;
    while (end < marks.size() && is_zero(end)) ++end;
    const std::size_t length = end - i;
    const bool of_spikes = among_spikes && length <= kLongestSpike;
    (of_spikes || (length == 1 && !lone_fall) ? out.lone_zeros : out.zeros) += length;
    out.zero_runs += of_spikes ? 0 : 1;
    i = end;
  }
}

// A rail cuts noise off: what comes near it is bent too.
void mark_bent(const std::vector<double>& U, const RecordScales& scales, const RecordHealth& found, SampleMarks& marks) {
  const RangeEnds ends = ends_of_range(U, scales.low_V, scales.high_V, scales.lsb_U_V, scales.noise_U_V);
  const double bent_V = found.at_rail > 0 ? found.rail_V - std::max(1.5 * scales.lsb_U_V, 3.0 * scales.noise_U_V)
                                          : std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < U.size(); ++i)
    if (marks.at(i) == BadSample::none && (U[i] >= bent_V || ends.holds(U[i]))) marks.mark(i, BadSample::censored, 0.0);
}

void measure_hum(const ForceAndOutput& samples, const RecordScales& scales, RecordHealth& out) {
  const MainsLine line = find_mains_line(samples.t_s(), samples.F_N(), samples.U_V(), scales.gain_V_per_N);
  out.hum_V = line.amplitude_V;
  out.hum_Hz = line.frequency_Hz;
  out.hum_ratio = line.ratio;
  out.mains_Hz = line.mains_Hz;
  out.rate_Hz = line.rate_Hz;
}

// What marks a sample first decides: a later step leaves alone what an earlier one has explained.
void find_bad_samples(const ForceAndOutput& samples, const RecordScales& scales, bool thrown, RecordHealth& out) {
  const std::vector<double>&F = samples.F_N(), &U = samples.U_V();
  const StepsOfOutput steps(F, U, std::abs(scales.gain_V_per_N), scales.quiet_V);
  SampleMarks marks(samples, scales);
  mark_falls(samples, steps, scales, marks);
  mark_missing(U, marks);
  mark_repeated(samples, scales, marks, out);
  const OffTheirNeighbours off = find_lone_samples(samples, steps, scales);
  mark_lone(U, off.at_low_end, BadSample::zero, marks);
  const bool has_short_spikes = mark_short_spikes(samples, scales, thrown, off.spikes, marks, out);
  const LoneSamples spikes = unmarked(off.spikes, marks);
  const bool lone_fall = fall_to_one_level({U, spikes.at, spikes.level_V}, scales.near_V);
  if (lone_fall)
    mark_lone(U, spikes, BadSample::zero, marks);
  else
    mark_lone_spikes(samples, scales, spikes, marks, out);
  out.top_V = largest_unmarked(U, marks);
  mark_suspect_runs(samples, scales, marks, out);
  mark_silent_runs(samples, scales, marks, out);
  count_zeros(marks, thrown || has_short_spikes, lone_fall, out);
  mark_bent(U, scales, out, marks);
  out.bad = marks.all();
  out.bad_mean_square_V2 = marks.mean_square_V2();
}

}  // namespace

RecordHealth check_raw_health(const Record& record, const HealthScales& campaign, const BenchFacts& bench) {
  constexpr std::size_t kFewest = 16;
  RecordHealth out;
  out.record = record.name;
  const std::optional<ForceAndOutput> samples = ForceAndOutput::of(record.trace);
  if (!samples) return out;
  assert(record.trace.find("F_ref")->time_base == record.trace.find("U")->time_base);
  out.samples = samples->size();
  out.bad.assign(out.samples, 0);
  out.gaps = samples->clock().gaps.size();
  if (out.samples < kFewest) return out;
  const RecordScales scales = record_scales(*samples, campaign, bench);
  out.noise_U_V = scales.noise_U_V;
  out.noise_F_N = scales.noise_F_N;
  out.lsb_U_V = scales.lsb_U_V;
  out.lsb_F_N = scales.lsb_F_N;
  out.near_V = scales.near_V;
  count_missing(samples->F_N(), samples->U_V(), out);
  measure_hum(*samples, scales, out);
  find_bad_samples(*samples, scales, campaign.thrown, out);
  measure_reference(*samples, scales, out);
  return out;
}

}  // namespace forcegate::diagnose
