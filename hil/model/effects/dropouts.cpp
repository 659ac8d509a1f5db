// Dropouts: runs of identical samples, or of zeros, while the force moves.
// Seen in the samples at full rate; the detector is in hil/diagnose/raw/raw_health.cpp, so there is no column to fit.

#include "hil/model/effect.h"

namespace forcegate {
namespace {

const Registration<EffectKind> kRegistered{
    EffectKind{.name = "dropouts",
               .side = "instrument",
               .channel = EffectChannel::raw,
               .summary = "runs of samples repeat the last value or fall to zero",
               .equation = "U held or zero",
               .source = "lost frames of a serial link",
               .look_alikes = {"outliers"},
               .separates = "a frame counter beside the samples",
               .needs = {},
               .forms = {}}};

}  // namespace
}  // namespace forcegate
