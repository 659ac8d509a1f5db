#include "hil/diagnose/reference_scatter.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

namespace forcegate::diagnose {

double reference_scatter_N(std::span<const double> t_s, std::span<const double> F_N,
                           std::span<const double> U_V) {
  constexpr double kWindow_s = 0.25;
  constexpr std::size_t kFewestSamples = 24, kMostWindows = 400, kFewestWindows = 8;
  const std::size_t n = std::min({t_s.size(), F_N.size(), U_V.size()});
  if (n < kFewestSamples * kFewestWindows) return 0.0;
  const double step = (t_s[n - 1] - t_s[0]) / static_cast<double>(n - 1);
  const std::size_t length =
      std::max(kFewestSamples, static_cast<std::size_t>(std::max(0.0, kWindow_s / std::max(step, 1e-9))));
  const std::size_t windows = n / length, stride = std::max<std::size_t>(1, windows / kMostWindows);
  // the place in the window is the same in all of them
  Eigen::Matrix3d places = Eigen::Matrix3d::Zero();
  std::vector<double> place;
  place.reserve(length);
  for (std::size_t k = 0; k < length; ++k) {
    const double x = 2.0 * static_cast<double>(k) / static_cast<double>(length - 1) - 1.0;
    const Eigen::Vector3d v(1.0, x, x * x);
    places += v * v.transpose();
    place.push_back(x);
  }
  std::vector<double> scatter;
  for (std::size_t w = 0; w < windows; w += stride) {
    Eigen::Vector3d with_U = Eigen::Vector3d::Zero(), with_F = with_U;
    double UU = 0.0, UF = 0.0, FF = 0.0;
    for (std::size_t k = 0; k < length; ++k) {
      const std::size_t i = w * length + k;
      const Eigen::Vector3d v(1.0, place[k], place[k] * place[k]);
      with_U += v * U_V[i];
      with_F += v * F_N[i];
      UU += U_V[i] * U_V[i];
      UF += U_V[i] * F_N[i];
      FF += F_N[i] * F_N[i];
    }
    // a missing sample is missing in these sums
    if (!std::isfinite(UU) || !std::isfinite(FF)) continue;
    Eigen::Matrix<double, 5, 5> M;
    M << places, with_U, with_F, with_U.transpose(), UU, UF, with_F.transpose(), UF, FF;
    // U may stand still to the last code: its share is then nothing
    M(3, 3) += 1e-12 * (1.0 + M(3, 3));
    const Eigen::Vector4d c = M.topLeftCorner<4, 4>().ldlt().solve(M.topRightCorner<4, 1>());
    scatter.push_back(std::sqrt(std::max(0.0, M(4, 4) - c.dot(M.topRightCorner<4, 1>())) /
                                static_cast<double>(length - 4)));
  }
  if (scatter.size() < kFewestWindows) return 0.0;
  const auto quarter = scatter.begin() + static_cast<std::ptrdiff_t>(scatter.size() / 4);
  std::nth_element(scatter.begin(), quarter, scatter.end());
  return *quarter;
}

}  // namespace forcegate::diagnose
