// Thermal gain and offset: dU = g (c_gain W + c_offset R) (T_s - T_ref), T_s = the measured temperature behind a lag; `activated`: along an
// exponential of T_s, as a film that conducts by activated hopping does over more than a few degrees.
// Up to 0.36 %/C (maker's figure for FlexiForce); resistance -15 % at +85 C, -5 % at -40 C for FSR (Interlink).

#include "hil/model/lagged_channel.h"

namespace forcegate {
namespace {

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "thermal",
    .side = "sensor",
    .summary = "gain or offset follows the temperature, smoothly and across records",
    .equation = "dU = g (c_gain W + c_offset R)(T_s - T_ref), tau T_s' + T_s = T",
    .source = "Tekscan FlexiForce manual rev. G; Interlink FSR 400 data sheet; Sensors 20 (2020) 6863",
    .look_alikes = {"creep", "wear", "reference_drift", "humidity", "self_heating"},
    .separates = "one ramp repeated over hours with the temperature recorded; heating without loading",
    .needs = {},
    .traits = {.between_records = true},
    .forms = {unrecorded_form([](const CampaignInput& c) { return !c.has_temp; }),
              lagged_form(&RecordInput::temp_C, &CampaignInput::has_temp, "C", "degC", {0.0, 7.0, 15.0, 30.0, 60.0, 240.0, 800.0, 2400.0}),
              bent_form("activated", &RecordInput::temp_C, &CampaignInput::has_temp, "C", "degC", {0.0, 7.0, 15.0, 30.0, 60.0, 240.0}, 0.03, 3.0)}}};

}  // namespace
}  // namespace forcegate
