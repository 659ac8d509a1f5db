#include "hil/app/export/self_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/base/text.h"

namespace forcegate {
namespace {

constexpr double kRowRate_Hz = 200.0, kLongest_s = 24.0, kMostSamples = 3e5;
constexpr double kOfTheSpan = 2e-3;

Record swing(const std::string& name, const SelfCheck& range, double period_s, bool decays, double temperature_C) {
  Record r;
  r.name = name;
  r.dynamic = decays;
  const double middle = 0.5 * (range.low_N + range.high_N), half = 0.5 * (range.high_N - range.low_N);
  if (decays) {
    r.excitation_start_s = 0.0;
    r.f_min_Hz = 1.0 / period_s;
    r.A_N = half;
    r.m_N = middle;
  }
  TimeBase clock;
  clock.nominal_rate_Hz = kRowRate_Hz;
  Channel F{"F_ref", "N", "force", 0, {}, {}}, U{"U", "V", "voltage", 0, {}, {}}, T{"temp", "degC", "temperature", 0, {}, {}};
  for (int i = 0; i < static_cast<int>(kRowRate_Hz * kLongest_s); ++i) {
    const double t = i / kRowRate_Hz;
    clock.t_s.push_back(t);
    F.value.push_back(middle - half * std::cos(2.0 * std::numbers::pi * t / period_s));
    U.value.push_back(F.value.back());  // the recorded output is no matter here
    T.value.push_back(temperature_C + 2.0 * std::sin(t));
  }
  r.trace.time_bases.push_back(std::move(clock));
  r.trace.channels = {std::move(F), std::move(U)};
  if (std::isfinite(temperature_C)) r.trace.channels.push_back(std::move(T));
  return r;
}

bool has_states(const Model& model) {
  return std::ranges::any_of(model.user_effects, [](const UserEffect& effect) { return !effect.states.empty(); });
}

// As recorded forces do, by their noise and by a motor that hums; where the film has lost most of its swing, what a state is off counts most.
Record rattling(Record r, const SelfCheck& range) {
  constexpr double kInside = 0.9, kInsideDecayed = 0.7, kRattle = 0.015, kHz = 7.3, kLong_s = 1e3;
  const double inside = r.excitation_start_s ? kInsideDecayed : kInside;
  const double middle = 0.5 * (range.low_N + range.high_N);
  Channel& F = r.trace.channels[0];
  for (std::size_t i = 0; i < F.value.size(); ++i) {
    const double rattle = std::sin(2.0 * std::numbers::pi * kHz * static_cast<double>(i) / kRowRate_Hz);
    F.value[i] = middle + inside * (F.value[i] - middle) + kRattle * (range.high_N - range.low_N) * rattle;
  }
  r.trace.channels[1].value = F.value;
  if (r.excitation_start_s) r.excitation_start_s = -kLong_s, r.A_N = inside * r.A_N.value_or(0.0);
  return r;
}

}  // namespace

Result<SelfCheck> self_check(const Model& model, const Compensator& compensator, double rate_Hz) {
  if (compensator.needs_temperature && !std::isfinite(model.frame.temperature_C))
    return fail(ErrorCode::config, "the model needs a temperature, and says of none at which the header is held against its own inverse", join(compensator.effects, "; "),
                "temperature_C under [law] says it, which forcegate fit writes; or give the campaign with --fit, or --reference-temperature 23");
  SelfCheck out;
  const double lowest = std::isfinite(model.frame.lowest_N) ? model.frame.lowest_N : 0.0;
  out.low_N = std::min(0.0, lowest);  // a firmware is unloaded at times, whatever the records show
  out.high_N = lowest + model.frame.span_N;
  Campaign forces;
  forces.name = "the model's own answers";
  const double T = compensator.needs_temperature ? model.frame.temperature_C : kMissing;
  forces.records = {swing("slow swing", out, 20.0, false, T), swing("fast swing", out, 2.0, false, T), swing("decay", out, 2.0, true, T)};
  // What an equation switches or follows within a few samples no smooth swing shows.
  if (has_states(model))
    for (const bool decays : {false, true}) forces.records.push_back(rattling(swing(decays ? "rattling, decayed" : "rattling swing", out, 4.0, decays, T), out));
  const Result<CompensatorCheck> check = check_compensator(model, compensator, rate_Hz, forces, std::min(kLongest_s, kMostSamples / rate_Hz));
  if (!check) {
    if (check.error().code != ErrorCode::io) return tl::unexpected(check.error());
    out.why_not = check.error().text + (check.error().where.empty() ? "" : " (" + check.error().where + ")");
    return out;
  }
  out.made = true;
  for (const ReplayedRecord& r : check->records)
    if (r.largest_N >= out.largest_N) out.largest_N = r.largest_N, out.at_N = r.largest_at_N;
  if (out.largest_N > kOfTheSpan * (out.high_N - out.low_N))
    return fail(ErrorCode::config,
                fmt::format("the header would not undo this model: at {:.2g} N it is {:.2g} N beside the model's own inverse, and is not written", out.at_N, out.largest_N),
                join(compensator.effects, "; "), "the output of the model falls or stands still there while the force rises: export a model without the effect that does so");
  return out;
}

}  // namespace forcegate
