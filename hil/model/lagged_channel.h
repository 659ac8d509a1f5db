#pragma once
// Gain and zero that follow a slow channel of the air (temperature, humidity) behind a first-order lag:
//   dU = g (c_gain W + c_offset R)(x_s - x_ref),  tau x_s' + x_s = x,  R the force span, x_ref the mean of x where the model was fitted.
// The state runs through the whole campaign: between two records x is taken along a straight line.

#include <string>
#include <vector>

#include "hil/model/effect.h"

namespace forcegate {

using AirChannel = std::vector<double> RecordInput::*;

/// What nobody saw before the first record: a film that has come to its first reading, or one so slow that it knows the mean only.
enum class FilmStart { equilibrium, mean };
/// phi(d) of the bent form; d where k is 0.
double bent(double k, double d);
/// x_s at every row of the record; `tau_s` 0: x itself.
std::vector<double> lagged_channel(const CampaignInput& campaign, const RecordInput& record,
                                   AirChannel channel, double tau_s, FilmStart start = FilmStart::equilibrium);

/// Form "lagged" with strengths c_gain_per_<unit>, c_offset_per_<unit>. `recorded`: whether a campaign has the channel. `taus_s`: lags tried.
EffectForm lagged_form(AirChannel channel, bool CampaignInput::*recorded, const std::string& suffix,
                       const std::string& unit, std::vector<double> taus_s);

/// Form `name` ("isotherm" of what a film takes up, "activated" of what conducts through it), strengths as "lagged": no straight line of the channel, it
/// bends up or down,
///   dU = g (c_gain W + c_offset R) phi(x_s - x_ref),  phi(d) = (exp(k d) - 1)/k,
/// k of either sign, tried at +-`bend` (1/<unit>) where the channel runs through `least_run` within one record at least: a handful of records that differ
/// have no number to spare for a bend.
EffectForm bent_form(std::string name, AirChannel channel, bool CampaignInput::*recorded, const std::string& suffix,
                         const std::string& unit, std::vector<double> taus_s, double bend, double least_run = 0.0);

inline constexpr const char* kUnrecorded = "unrecorded";

/// Nobody wrote the channel down: the gain moves smoothly over the campaign, whatever is done to the sensor; half waves of the
/// campaign's time. `possible`: whether the campaign may be explained so.
EffectForm unrecorded_form(std::function<bool(const CampaignInput&)> possible);

}  // namespace forcegate
