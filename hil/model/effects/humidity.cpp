// Humidity: dU = g (c_gain W + c_offset R)(h_s - h_ref), h_s the measured humidity behind a slow lag. Where it was not recorded, a gain
// that moves smoothly; the temperature does the same where that was not recorded either. Water goes into a film within hours.
// Hot and humid +10 % resistance, storage +30 % (Interlink FSR 400 data sheet).

#include "hil/model/lagged_channel.h"

namespace forcegate {
namespace {

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "humidity",
    .side = "sensor",
    .summary = "gain or offset follows the humidity, slowly and across records",
    .equation = "dU = g (c_gain W + c_offset R)(h_s - h_ref), tau h_s' + h_s = h",
    .source = "Interlink FSR 400 data sheet",
    .look_alikes = {"thermal", "creep", "wear", "reference_drift", "self_heating"},
    .separates = "one ramp repeated over hours with the humidity recorded",
    .needs = {},
    .traits = {.between_records = true},
    .forms = {unrecorded_form([](const CampaignInput& c) { return !c.has_humidity; }),
              lagged_form(&RecordInput::humidity, &CampaignInput::has_humidity, "pct", "%", {0.0, 240.0, 800.0, 2400.0, 7200.0, 21600.0}),
              bent_form("isotherm", &RecordInput::humidity, &CampaignInput::has_humidity, "pct", "%", {0.0, 1200.0}, 0.03)}}};

}  // namespace
}  // namespace forcegate
