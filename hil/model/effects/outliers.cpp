// Outliers: single samples far off their neighbours while the force is smooth.
// Seen in the samples at full rate; the detector is in hil/diagnose/raw/raw_health.cpp, so there is no column to fit.

#include "hil/model/effect.h"

namespace forcegate {
namespace {

const Registration<EffectKind> kRegistered{
    EffectKind{.name = "outliers",
               .side = "instrument",
               .channel = EffectChannel::raw,
               .summary = "single samples, or a few that fade, stand far off their neighbours",
               .equation = "U + spikes",
               .source = "electrostatic discharge, loose contacts",
               .look_alikes = {"dropouts"},
               .separates = "a longer record; spikes come at random, dropouts in runs",
               .needs = {},
               .forms = {}}};

}  // namespace
}  // namespace forcegate
