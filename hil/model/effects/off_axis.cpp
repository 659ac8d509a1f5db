// Off-axis push: the eccentric wheel also pushes sideways.  dU = g D (c1 sin th + c2 F sin th / R).
// With a turning wheel a loop that keeps its width at any speed; in servo mode a single curve: the clash is the signature.

#include "hil/model/effect.h"

namespace forcegate {
namespace {

EffectForm form(const char* name, bool decayed) {
  return {
      .name = name,
      .shape = {},
      .strength = {{"c1_N", "N", -10.0, 10.0, 0.0, "sideways push, constant part"},
                   {"c2", "1", -2.0, 2.0, 0.0, "sideways push, part that grows with the force"}},
      .sign = StrengthSign::either,
      .grid = [](const CampaignInput&) { return std::vector<std::vector<double>>{{}}; },
      .columns =
          [decayed](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
            out.setZero();
            if (r.sin_theta.empty()) return;
            for (std::size_t i = 0; i < r.rows(); ++i) {
              const double s = (decayed ? r.decay[i] : 1.0) * r.sin_theta[i];
              out(static_cast<Eigen::Index>(i), 0) = s;
              out(static_cast<Eigen::Index>(i), 1) = s * r.F_N[i] / c.range_N;
            }
          },
      .singles = true};
}

const Registration<EffectKind> kRegistered{
    EffectKind{.name = "off_axis",
               .side = "rig",
               .summary = "the output depends on the side from which the wheel pushes",
               .equation = "dU = g D (c1 sin th + c2 F sin th / R)",
               .source = "geometry of an eccentric wheel; Lebosse et al. 2011, fig. 3",
               .look_alikes = {"hysteresis", "static_nonlinearity"},
               .separates = "the same cycle with the wheel turning the other way: the loop flips",
               .needs = {"theta"},
               .forms = {form("sine", true), form("sine_undecayed", false)}}};

}  // namespace
}  // namespace forcegate
