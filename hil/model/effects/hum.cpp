// Mains hum: lines at 50 and 150 Hz or their aliases, larger at high sensor resistance.
// Seen in the samples at full rate; the detector is in hil/diagnose/raw/raw_health.cpp, so there is no column to fit.

#include "hil/model/effect.h"

namespace forcegate {
namespace {

const Registration<EffectKind> kRegistered{
    EffectKind{.name = "hum",
               .side = "instrument",
               .channel = EffectChannel::raw,
               .summary = "a line at mains frequency or its alias stands in the output and not in the force",
               .equation = "dU = a sin(2 pi 50 t + phase)",
               .source = "mains coupling into a high-impedance node",
               .look_alikes = {"outliers"},
               .separates = "the same rest record with the drive off; another sampling rate moves the alias",
               .needs = {},
               .forms = {}}};

}  // namespace
}  // namespace forcegate
