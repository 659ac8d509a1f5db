#include "hil/model/lagged_channel.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "hil/model/model_frame.h"
#include "hil/model/states.h"

namespace forcegate {

namespace {

constexpr double kWalk_s = 1.0;  // step through earlier records: the lags are minutes

double reference_of(const CampaignInput& c, AirChannel channel) {
  return channel == &RecordInput::temp_C ? reference_temperature_C(c) : reference_humidity_pct(c);
}

double state_at_start(const CampaignInput& c, const RecordInput& record, AirChannel channel, double tau_s, FilmStart start) {
  LowPass film(tau_s, 0.0);
  double before = 0.0, at_s = 0.0;
  bool running = false;
  const auto to = [&](double x, double t_s) {
    if (!running)
      film = LowPass(tau_s, start == FilmStart::mean ? reference_of(c, channel) : x);
    else if (t_s > at_s)
      film.step(before, x, t_s - at_s);
    running = true;
    before = x;
    at_s = std::max(at_s, t_s);
  };
  for (const RecordInput& r : c.records) {
    const std::vector<double>& x = r.*channel;
    if (r.recording == record.recording) break;
    if (x.empty()) continue;
    const auto stride = static_cast<std::size_t>(std::max(1.0, kWalk_s / r.row_step_s));
    for (std::size_t i = 0; i < x.size(); i += stride) to(x[i], r.start_s + r.t_s[i]);
    to(x.back(), r.start_s + r.t_s.back());
  }
  to((record.*channel).front(), record.start_s + record.t_s.front());
  return film.state();
}

}  // namespace

double bent(double k, double d) { return std::abs(k) > 1e-9 ? std::expm1(std::clamp(k * d, -20.0, 20.0)) / k : d; }

std::vector<double> lagged_channel(const CampaignInput& campaign, const RecordInput& record,
                                   AirChannel channel, double tau_s, FilmStart start) {
  const std::vector<double>& x = record.*channel;
  if (x.empty() || !(tau_s > 0.0)) return x;
  return low_pass_channel(record, x, tau_s, state_at_start(campaign, record, channel, tau_s, start));
}

namespace {

std::vector<ParameterSpec> gain_and_offset(const std::string& suffix, const std::string& unit) {
  return {{"c_gain_per_" + suffix, "1/" + unit, -0.1, 0.1, 0.0, "relative change of gain"},
          {"c_offset_per_" + suffix, "1/" + unit, -0.1, 0.1, 0.0, "change of offset, shares of the span"}};
}

ParameterSpec lag_of_film() {
  return {"tau_s", "s", 0.0, 1e5, 60.0, "time constant of the sensor behind the instrument in the air"};
}

// Columns of gain and zero, `phi` of the lagged channel's distance from its reference.
template <class Phi>
void fill(AirChannel channel, const CampaignInput& c, const RecordInput& r, double tau_s, FilmStart start, ColumnsRef out, const Phi& phi) {
  out.setZero();
  if ((r.*channel).empty()) return;
  const double reference = reference_of(c, channel);
  const std::vector<double> x = lagged_channel(c, r, channel, tau_s, start);
  for (std::size_t i = 0; i < r.rows(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double of_film = phi(x[i] - reference);
    out(row, 0) = of_film * r.base_force_N(i);
    out(row, 1) = of_film * c.range_N;
  }
}

// Highest less lowest value within one record.
double longest_run(const CampaignInput& c, AirChannel channel) {
  double out = 0.0;
  for (const RecordInput& r : c.records) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const double x : r.*channel)
      if (std::isfinite(x)) low = std::min(low, x), high = std::max(high, x);
    out = std::max(out, high - low);
  }
  return out;
}

RecordedCause reading_of(AirChannel channel, const std::string& unit, const std::function<FilmStart(std::span<const double>)>& start) {
  constexpr double kPlain_C = 2.0, kPlain_pct = 5.0;
  const bool warm = channel == &RecordInput::temp_C;
  return {warm ? "temperature" : "humidity", unit, [channel](const RecordInput& r) {
            double sum = 0.0, n = 0.0;
            for (const double x : r.*channel)
              if (std::isfinite(x)) sum += x, n += 1.0;
            return n > 0.0 ? sum / n : kMissing;
          }, warm ? kPlain_C : kPlain_pct,
          [channel, start](const CampaignInput& c, const RecordInput& r, std::span<const double> shape) {
            return lagged_channel(c, r, channel, shape[0], start(shape));
          }};
}

FilmStart as_shaped(std::span<const double> shape) { return shape[1] != 0.0 ? FilmStart::mean : FilmStart::equilibrium; }
FilmStart in_equilibrium(std::span<const double>) { return FilmStart::equilibrium; }

}  // namespace

EffectForm lagged_form(AirChannel channel, bool CampaignInput::*recorded, const std::string& suffix,
                       const std::string& unit, std::vector<double> taus_s) {
  return {.name = "lagged",
          .shape = {lag_of_film(), {"from_mean", "1", 0.0, 1.0, 0.0, "1: the film begins at the mean of the channel; 0: in equilibrium with its first reading", true}},
          .strength = gain_and_offset(suffix, unit),
          .sign = StrengthSign::either,
          .grid =
              [recorded, taus_s = std::move(taus_s)](const CampaignInput& c) {
                std::vector<std::vector<double>> out;
                if (!(c.*recorded)) return out;
                for (const double tau_s : taus_s) {
                  out.push_back({tau_s, 0.0});
                  if (tau_s > 0.0 && !c.single) out.push_back({tau_s, 1.0});
                }
                return out;
              },
          .columns = [channel](const CampaignInput& c, const RecordInput& r, std::span<const double> shape,
                               ColumnsRef out) {
            fill(channel, c, r, shape[0], as_shaped(shape), out, [](double x) { return x; });
          },
          .singles = true,
          .cause = reading_of(channel, unit, as_shaped)};
}

EffectForm bent_form(std::string name, AirChannel channel, bool CampaignInput::*recorded, const std::string& suffix,
                         const std::string& unit, std::vector<double> taus_s, double bend, double least_run) {
  return {.name = std::move(name),
          .shape = {lag_of_film(), {"bend_per_" + suffix, "1/" + unit, -0.2, 0.2, bend, "bend: the change of its slope, as a share, with one more of the unit"}},
          .strength = gain_and_offset(suffix, unit),
          .sign = StrengthSign::either,
          .grid =
              [channel, recorded, taus_s = std::move(taus_s), bend, least_run](const CampaignInput& c) {
                std::vector<std::vector<double>> out;
                if (!(c.*recorded) || longest_run(c, channel) < least_run) return out;
                for (const double tau_s : taus_s)
                  for (const double k : {-bend, bend}) out.push_back({tau_s, k});
                return out;
              },
          .columns =
              [channel](const CampaignInput& c, const RecordInput& r, std::span<const double> shape,
                        ColumnsRef out) {
                const double k = shape[1];
                fill(channel, c, r, shape[0], FilmStart::equilibrium, out, [k](double x) { return bent(k, x); });
              },
          .singles = true,
          .cause = reading_of(channel, unit, in_equilibrium)};
}

EffectForm unrecorded_form(std::function<bool(const CampaignInput&)> possible) {
  return {.name = kUnrecorded,
          .shape = {},
          .strength = {{"k1", "1", -1.0, 1.0, 0.0, "half wave of the gain over the campaign"},
                       {"k2", "1", -1.0, 1.0, 0.0, "one wave"},
                       {"k3", "1", -1.0, 1.0, 0.0, "one and a half waves"},
                       {"k4", "1", -1.0, 1.0, 0.0, "two waves"}},
          .sign = StrengthSign::either,
          .grid =
              [possible = std::move(possible)](const CampaignInput& c) {
                return !c.single && possible(c) ? std::vector<std::vector<double>>{{}}
                                                : std::vector<std::vector<double>>{};
              },
          .columns =
              [](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
                double T = 1.0;
                for (const RecordInput& other : c.records) T = std::max(T, other.start_s + other.duration_s);
                r.for_each_wanted([&](std::size_t i) {
                  for (int k = 1; k <= 4; ++k)
                    out(static_cast<Eigen::Index>(i), k - 1) =
                        r.base_force_N(i) * std::cos(k * std::numbers::pi * (r.start_s + r.t_s[i]) / T);
                });
              }};
}

}  // namespace forcegate
