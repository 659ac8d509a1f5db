#include "hil/trace/conductance.h"

#include <cmath>

#include "hil/base/plain_number.h"

namespace forcegate {
namespace {

struct Correlation {
  double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;

  void add(double u, double v) {  // about running means: a conductance is small beside its own size
    n += 1.0;
    const double du = u - x, dv = v - y;
    x += du / n;
    y += dv / n;
    xx += du * (u - x);
    yy += dv * (v - y);
    xy += du * (v - y);
  }
  double value() const { return xx > 0.0 && yy > 0.0 ? xy / std::sqrt(xx * yy) : 0.0; }
};

}  // namespace

void read_resistance_as_conductance(Campaign& campaign) {
  Correlation of_resistance, of_conductance;
  for (const Record& record : campaign.records) {
    const Channel *U = record.trace.find("U"), *F = record.trace.find("F_ref");
    if (U == nullptr || U->quantity != "resistance") return;
    if (F == nullptr || F->value.size() != U->value.size()) continue;
    for (std::size_t i = 0; i < U->value.size(); ++i)
      if (U->value[i] > 0.0 && std::isfinite(F->value[i])) {
        of_resistance.add(F->value[i], U->value[i]);
        of_conductance.add(F->value[i], 1.0 / U->value[i]);
      }
  }
  if (!(std::abs(of_conductance.value()) > std::abs(of_resistance.value()))) return;
  for (Record& record : campaign.records) {
    Channel& U = *record.trace.find("U");
    for (double& v : U.value) v = v > 0.0 ? 1.0 / v : kMissing;
    U.unit = "S";
    U.quantity = "conductance";
    U.raw.clear();
  }
  campaign.notes.push_back("the output is read as conductance 1/R, siemens, which goes with the force more straightly than R (correlation " +
                           plain_number(of_conductance.value()) + " against " + plain_number(of_resistance.value()) +
                           "); --map NAME=U_ohm keeps the resistance");
}

}  // namespace forcegate
