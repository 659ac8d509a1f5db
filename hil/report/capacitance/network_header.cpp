#include "hil/report/capacitance/network_header.h"

#include <fmt/format.h>

namespace forcegate {

std::string network_header(const characterize::WeightStudy& study) {
  std::string out = fmt::format(
      "/* Networks of the sensors of one pack, written by `forcegate characterize --plan capacitance` (networks.h of its output);\n"
      "   {} loadings of training. Capacitances in pF. */\n"
      "#ifndef FORCEGATE_FIRMWARE_NETWORKS_H\n#define FORCEGATE_FIRMWARE_NETWORKS_H\n\n#include \"compensator.h\"\n\n"
      "#define FW_PACK_ID \"{}/{}\"\n#define FW_PACK_SENSORS {}\n\nstatic const FwNetwork kNetworks[FW_PACK_SENSORS] = {{\n",
      study.plan.training, study.plan.seed, study.exemplar_set.set, study.exemplar.size());
  for (const auto& e : study.exemplar) {
    const impedance::Network& n = e.network;
    out += "    {{";
    for (std::size_t k = 0; k < n.weights.size(); ++k)
      out += fmt::format("{}{:.9e}f", k == 0 ? "" : k == 3 || k == 6 ? ",\n      " : ", ", n.weights[k]);
    out += fmt::format("}},\n     {:.9e}f, {:.9e}f, {:.9e}f, {:.9e}f, {:.9e}f, {:.9e}f}},\n", n.mean_V,
                       n.scale_V, 1e12 * n.mean_F, 1e12 * n.scale_F, n.mean_N, n.scale_N);
  }
  return out + "};\n\n#endif\n";
}

}  // namespace forcegate
