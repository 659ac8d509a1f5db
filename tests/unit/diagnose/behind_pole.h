#pragma once

#include <cmath>
#include <vector>

namespace forcegate::diagnose {

/// F behind one pole.
inline std::vector<double> behind_pole(const std::vector<double>& t, const std::vector<double>& F, double tau_s) {
  std::vector<double> out;
  double y = F.front();
  for (std::size_t i = 0; i < F.size(); ++i) {
    if (i > 0) y += (F[i] - y) * -std::expm1(-(t[i] - t[i - 1]) / tau_s);
    out.push_back(y);
  }
  return out;
}

}  // namespace forcegate::diagnose
