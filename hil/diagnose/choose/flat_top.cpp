#include "hil/diagnose/choose/flat_top.h"

#include <cmath>
#include <limits>

namespace forcegate::diagnose {

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();

struct Slope {
  double value = 0.0, u = kInf;
  double moved_N = 0.0;  ///< standard deviation of the force within the records
};

class PooledSlope {
 public:
  void add(const RecordInput& r, double from_N, double to_N) {
    constexpr double kFewest = 8.0;
    double n = 0.0, W = 0.0, U = 0.0, WW = 0.0, WU = 0.0, UU = 0.0;
    for (std::size_t i = 0; i < r.rows(); ++i) {
      const double w = r.base_force_N(i), u = r.U_V[i];
      if (r.ok[i] == 0 || !std::isfinite(u) || !(w >= from_N && w < to_N)) continue;
      // about the first row: sums of squares of what is far from zero cancel
      const double dw = w - from_N, du = n > 0.0 ? u - first_V_ : 0.0;
      if (n == 0.0) first_V_ = u;
      n += 1.0, W += dw, U += du, WW += dw * dw, WU += dw * du, UU += du * du;
    }
    if (n < kFewest) return;
    rows_ += n, records_ += 1.0;
    WW_ += WW - W * W / n, WU_ += WU - W * U / n, UU_ += UU - U * U / n;
  }

  Slope slope() const {
    constexpr double kFewest = 30.0;
    const double freedom = rows_ - records_ - 1.0;
    if (rows_ < kFewest || !(WW_ > 0.0)) return {};
    const double value = WU_ / WW_;
    return {value, std::sqrt(std::max(0.0, UU_ - value * WU_) / freedom / WW_), std::sqrt(WW_ / rows_)};
  }

 private:
  double first_V_ = 0.0, rows_ = 0.0, records_ = 0.0, WW_ = 0.0, WU_ = 0.0, UU_ = 0.0;
};

}  // namespace

bool stands_still_above(const CampaignInput& c, double corner_N) {
  constexpr double kCorner = 0.01, kBelow = 0.1, kMoves = 0.005;  // shares of the range
  constexpr double kStill = 0.2, kErrors = 2.0;
  PooledSlope above, below;
  for (const RecordInput& r : c.records) {
    if (r.U_V.size() != r.rows()) continue;
    above.add(r, corner_N + kCorner * c.range_N, kInf);
    below.add(r, corner_N - (kBelow + kCorner) * c.range_N, corner_N - kCorner * c.range_N);
  }
  const Slope up = above.slope(), down = below.slope();
  return up.moved_N > kMoves * c.range_N && down.u < kInf && std::abs(up.value) + kErrors * up.u < kStill * std::abs(down.value);
}

}  // namespace forcegate::diagnose
