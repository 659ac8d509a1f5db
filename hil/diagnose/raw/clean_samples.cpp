#include "hil/diagnose/raw/clean_samples.h"

#include <algorithm>
#include <cmath>

#include "hil/base/plain_number.h"
#include "hil/diagnose/raw/denoise.h"
#include "hil/diagnose/raw/hum_claim.h"
#include "hil/diagnose/raw/mains_removal.h"
#include "hil/diagnose/raw/matched_lowpass.h"
#include "hil/diagnose/raw/reference_scatter.h"
#include "hil/diagnose/raw/smoothed_reference.h"

namespace forcegate::diagnose {

namespace {

// Only where force and output share a clock.
void take_hum_off(Record& record, RecordHealth& health) {
  const Channel* force = record.trace.find("F_ref");
  const std::vector<double>& t_s = record.trace.time_bases[force->time_base].t_s;
  for (Channel& channel : record.trace.channels)
    if (channel.name == "U" && channel.value.size() == t_s.size() && force->value.size() == t_s.size())
      health.bad_mean_square_V2 += remove_mains_line(t_s, force->value, health.bad, health.mains_Hz, health.rate_Hz, channel.value);
}

std::vector<double> values_of(const Record& record, std::string_view name) {
  const Channel* channel = record.trace.find(name);
  return channel != nullptr ? channel->value : std::vector<double>{};
}

// Windows that agree better and better, until the output no longer follows what they take: a force that turns too quickly for them would
// be flattened in the same way in every cycle.
void smooth_reference(Record& record, Channel& force, double sd_N, const HealthScales& scales, RecordHealth& health) {
  constexpr double kOfNoise = 0.25, kErrors = 2.0;  // of the mean square that smoothing leaves; standard errors
  constexpr double kAgreements[] = {kAgree, 1.0, 0.6, 0.4};
  const Channel* output = record.trace.find("U");
  const std::vector<double> recorded = std::move(force.value);
  const bool tells = output != nullptr && output->value.size() == recorded.size() && health.bad.size() == recorded.size();
  const OutputFacts facts{.range_V = scales.U_range_V, .gain_V_per_N = scales.gain_V_per_N, .noise_V = health.noise_U_V};
  const std::vector<double>& t_s = record.trace.time_bases[force.time_base].t_s;
  for (const double agree : kAgreements) {
    force.value = smooth_within_noise(recorded, sd_N, &health.smoothed_F_N, agree);
    if (!tells) return;
    // of noise that hangs together more is left than of white noise
    if (facts.gain_V_per_N != 0.0) health.smoothed_F_N = std::max(health.smoothed_F_N, left_where_still(t_s, recorded, force.value, output->value, facts));
    const SharedPart taken = shared_with_output(recorded, force.value, output->value, health.bad);
    if (taken.share <= kErrors * taken.standard_error || taken.share * taken.taken_N2 <= kOfNoise * health.smoothed_F_N * health.smoothed_F_N) return;
  }
}

void smooth_noisy_reference(Record& record, const HealthScales& scales, bool draw, CleanedSamples& out) {
  constexpr double kSmoothed = 1e-4;  // of the span
  RecordHealth& health = out.health;
  Channel* force = record.trace.find("F_ref");
  // differences of neighbours do not see noise that hangs together; where the output stands still it is seen whole
  const double sd_N = std::max(std::hypot(health.noise_F_N, health.lsb_F_N / std::sqrt(12.0)), health.scatter_F.still_N);
  if (force == nullptr || !(sd_N > kSmoothed * scales.range_N)) return;
  const std::vector<double> recorded_N = draw ? force->value : std::vector<double>{};
  smooth_reference(record, *force, sd_N, scales, health);
  const double burst_N = std::isfinite(health.scatter_F.burst_N) ? health.scatter_F.burst_N : 0.0;
  if (draw) out.cuts.push_back(cut_out_reference_noise(record, recorded_N, std::max({health.noise_F_N, health.scatter_F.quartile_N, burst_N})));
}

}  // namespace

void note_cleaning(const BenchFacts& bench, std::vector<std::string>& notes) {
  if (std::isfinite(bench.reference_lowpass_Hz))
    notes.push_back("the output is taken through the low-pass of " + plain_number(bench.reference_lowpass_Hz) +
                    " Hz that campaign.json declares of the reference: both are as late");
}

CleanedSamples clean_samples(Record& record, const HealthScales& scales, const BenchFacts& bench, bool draw) {
  CleanedSamples out;
  RecordHealth& health = out.health;
  health = check_raw_health(record, scales, bench);
  if (draw) out.cuts = cut_out_bad_samples(record, health, scales);
  if (shows_hum(health, scales)) {
    const std::vector<double> before_V = draw ? values_of(record, "U") : std::vector<double>{};
    take_hum_off(record, health);
    if (draw) out.cuts.push_back(cut_out_hum(record, before_V, health.hum_Hz, health.hum_V));
  }
  smooth_noisy_reference(record, scales, draw, out);
  if (std::isfinite(bench.reference_lowpass_Hz)) match_reference_lowpass(record, health.bad, bench.reference_lowpass_Hz);
  return out;
}

}  // namespace forcegate::diagnose
