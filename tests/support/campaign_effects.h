#pragma once
// The names that the campaign format knows (docs/campaign.md), for the tests of both sides of the wall.

#include <set>
#include <string>

namespace forcegate::test {

inline const std::set<std::string> kCampaignEffects = {"hysteresis",
                                                       "creep",
                                                       "lag",
                                                       "delay",
                                                       "clock_skew",
                                                       "static_nonlinearity",
                                                       "dead_zone",
                                                       "wear",
                                                       "frequency_bump",
                                                       "slow_recovery",
                                                       "thermal",
                                                       "humidity",
                                                       "rc",
                                                       "piezocapacitance",
                                                       "bias",
                                                       "self_heating",
                                                       "spring_nonlinearity",
                                                       "backlash",
                                                       "off_axis",
                                                       "contact_loss",
                                                       "motor",
                                                       "reference_drift",
                                                       "reference_noise",
                                                       "clipping",
                                                       "hum",
                                                       "outliers",
                                                       "dropouts",
                                                       "adc_codes",
                                                       "mounting"};

}  // namespace forcegate::test
