#include "hil/diagnose/laws/no_input.h"

#include <algorithm>
#include <cmath>

#include "hil/base/plain_number.h"
#include "hil/trace/campaign_checks.h"
#include "hil/diagnose/laws/recorded_cause.h"

namespace forcegate::diagnose {

namespace {

constexpr double kPlainly = 8.0;  // times the white noise of a sample

const std::vector<double>& clock_of(const Record& record, const Channel& channel) { return record.trace.time_bases[channel.time_base].t_s; }

std::vector<double> at_samples_of(const Record& record, const Channel& clock, const Channel& channel) {
  if (channel.time_base == clock.time_base && channel.value.size() == clock.value.size() &&
      std::ranges::all_of(channel.value, [](double v) { return std::isfinite(v); }))
    return channel.value;
  return at_times(clock_of(record, channel), channel.value, clock_of(record, clock));
}

// Volts per newton from zero, where the load is more than the force moves by; 0: not known.
double gain_from_zero(const Movement& F, const Movement& U, std::size_t samples) {
  constexpr double kOfExcursion = 0.25, kStandardErrors = 5.0;
  const double least = kOfExcursion * F.excursion + kStandardErrors * F.noise / std::sqrt(static_cast<double>(std::max<std::size_t>(1, samples)));
  return std::abs(F.level) > least ? std::abs(U.level / F.level) : 0.0;
}

bool is_near(const Response& response, double gain, double factor) {
  return response.at_most > gain / factor && response.at_least < gain * factor;
}

// A slow system that is sampled a few times a time constant answers samples later.
template <class Answers>
bool answers_late(const std::vector<double>& F, const std::vector<double>& U, const Answers& answers) {
  constexpr std::size_t kOfRecord = 20, kMost = 64;
  const std::size_t n = std::min(F.size(), U.size());
  for (std::size_t late = 1; late <= std::min(kMost, n / kOfRecord); late += 1 + late / 4)
    if (answers(response_by_scale({F.begin(), F.begin() + static_cast<std::ptrdiff_t>(n - late)},
                                  {U.begin() + static_cast<std::ptrdiff_t>(late), U.begin() + static_cast<std::ptrdiff_t>(n)})))
      return true;
  return false;
}

// Two steady drifts go together whatever they are, so that the course as a whole must have about the gain that the load has. A scale of its
// own only tells a common disturbance from an input by it. A cell that was not tared, or an output with an offset, has no gain from zero: one
// course needs none.
bool follows(const std::vector<double>& F, const std::vector<double>& U, double gain, bool moves) {
  constexpr double kByScale = 10.0, kAsAWhole = 3.0;
  const auto answers = [&](const Response& r) { return r.found && (gain == 0.0 || is_near(r, gain, kByScale)); };
  if (answers(response_by_scale(F, U)) || answers_late(F, U, answers)) return true;
  if (!moves) return false;
  if (is_one_course(F, U)) return true;
  if (gain == 0.0) return false;
  const Response r = response_as_a_whole(F, U);
  return r.found && is_near(r, gain, kAsAWhole);
}

bool is_moved(const Record& record, const char* name) {
  const Channel* c = record.trace.find(name);
  if (c == nullptr) return false;
  const Movement m = movement_of(c->value);
  return m.excursion > kPlainly * m.noise;
}

// Holds at several loads tell of the law together.
bool levels_differ(const Campaign& campaign) {
  constexpr double kOfLevel = 0.1;
  double low = 1e300, high = -1e300, noise = 0.0;
  for (const Record& record : campaign.records) {
    const Channel* F = record.trace.find("F_ref");
    if (F == nullptr) continue;
    const Movement m = movement_of(F->value);
    low = std::min(low, m.level), high = std::max(high, m.level), noise = std::max(noise, m.noise);
  }
  return high > low && high - low > std::max(kOfLevel * std::max(std::abs(low), std::abs(high)), kPlainly * noise);
}

}  // namespace

const Channel* output_of(const Record& record) {
  if (const Channel* U = record.trace.find("U")) return U;
  const Channel* only = nullptr;
  for (const Channel& c : record.trace.channels) {
    if (c.name == "F_ref") continue;
    if (only != nullptr) return nullptr;
    only = &c;
  }
  return only;
}

Stillness stillness_of_force(const Record& record) {
  constexpr double kSmall = 0.1;       // of the load
  constexpr double kNoWander = 30.0;  // times the white noise of a sample: above it goes no reference by itself
  const Channel* F = record.trace.find("F_ref");
  if (F == nullptr) return Stillness::exact;
  const Movement force = movement_of(F->value);
  if (force.noise == 0.0 && !force.stands_out()) return Stillness::exact;
  const Channel* U = output_of(record);
  if (U == nullptr) return force.stands_out() ? Stillness::moves : Stillness::noise;
  const Movement output = movement_of(U->value);
  const double gain = gain_from_zero(force, output, F->value.size());
  const bool small = force.excursion < kSmall * std::abs(force.level) && gain * force.excursion > output.noise;
  const bool far = force.excursion > 0.0 && force.excursion >= kNoWander * force.noise;
  if (far && !small && !is_noise_that_hangs_together(F->value)) return Stillness::moves;
  if (follows(F->value, at_samples_of(record, *F, *U), gain, force.stands_out())) return Stillness::moves;
  return force.stands_out() ? Stillness::wanders : Stillness::noise;
}

bool is_drift_only(const Campaign& campaign) {
  bool exact = true;
  for (const Record& record : campaign.records) {
    const Stillness still = stillness_of_force(record);
    if (still == Stillness::moves) return false;
    exact &= still == Stillness::exact;
  }
  if (exact) return true;
  if (levels_differ(campaign)) return false;
  return std::ranges::none_of(campaign.records, [](const Record& record) {
    return is_moved(record, "theta") || is_moved(record, "F_cmd") || tells_of_output(record, "temp") || tells_of_output(record, "humidity") ||
           tells_of_output(record, "drive");
  });
}

std::string what_the_force_shows(const Campaign& campaign) {
  constexpr const char* kOnlyTime = "these records show what time does, drift and noise, and nothing of the law between force and output";
  double noise = 0.0, wander = 0.0;
  for (const Record& record : campaign.records) {
    const Channel* F = record.trace.find("F_ref");
    if (F == nullptr) continue;
    const Movement m = movement_of(F->value);
    noise = std::max(noise, m.noise), wander = std::max(wander, m.excursion);
  }
  if (wander > 0.0)
    return "the force wanders by " + plain_number(1e3 * wander) + " mN beside noise of " + plain_number(1e3 * noise) +
           " mN, and the output does not follow it, as where the zero of the reference moves: " + kOnlyTime;
  if (noise > 0.0) return "the force shows no more than noise of its reference, " + plain_number(1e3 * noise) + " mN: " + kOnlyTime;
  return std::string("the force stands still: ") + kOnlyTime;
}

Result<void> check_output_moves(const Campaign& campaign) {
  double low = 1e300, high = -1e300, noise = 0.0, excursion = 0.0;
  std::string unit;
  for (const Record& record : campaign.records) {
    const Channel *F = record.trace.find("F_ref"), *U = record.trace.find("U");
    if (F == nullptr || U == nullptr) return {};
    const Movement output = movement_of(U->value);
    if (output.stands_out() || response_by_scale(F->value, at_samples_of(record, *F, *U)).found) return {};
    if (stillness_of_force(record) == Stillness::moves) excursion = std::max(excursion, movement_of(F->value).excursion);
    low = std::min(low, output.level), high = std::max(high, output.level), noise = std::max(noise, output.noise);
    unit = U->unit;
  }
  if (excursion == 0.0 || high - low > noise) return {};
  const double level = noise > 0.0 ? noise * std::round(0.5 * (low + high) / noise) : low;
  return fail(ErrorCode::parse,
              "the output never moves while the force does, by " + plain_number(excursion) + " N: it stands at " + plain_number(level) + " " + unit +
                  (noise > 0.0 ? " beside white noise of " + plain_number(noise) + " " + unit : ""),
              campaign.name,
              "is the sensor connected, is its amplifier at the end of its range, and is this its column? --map NAME=U_V names another");
}

Result<void> check_shows_a_law(const Campaign& campaign) {
  for (const Record& record : campaign.records)
    if (const std::string reason = unfit(record.trace).too_short; !reason.empty())
      return fail(ErrorCode::parse, reason, record.place(), "record more of it, or leave the record out");
  if (is_drift_only(campaign))
    return fail(ErrorCode::parse, what_the_force_shows(campaign), campaign.name,
                "there is no law to fit: record a force that moves; forcegate diagnose tells what the output does with time");
  return check_output_moves(campaign);
}

}  // namespace forcegate::diagnose
