// Reference noise above its declared value. What the data sheet allows is not an effect.
// Seen in the samples at full rate; the detector is in hil/diagnose/raw/raw_health.cpp, so there is no column to fit.

#include "hil/model/effect.h"

namespace forcegate {
namespace {

const Registration<EffectKind> kRegistered{
    EffectKind{.name = "reference_noise",
               .side = "reference",
               .channel = EffectChannel::raw,
               .summary = "the reference is noisier than its declared resolution and noise allow",
               .equation = "F_ref = F + n",
               .source = "Nano17: resolution 0.025 N (Lebosse et al. 2011)",
               .look_alikes = {"outliers"},
               .separates = "a record at rest: the noise of F_ref against its declared value",
               .needs = {},
               .forms = {}}};

}  // namespace
}  // namespace forcegate
