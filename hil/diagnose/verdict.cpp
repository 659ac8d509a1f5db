#include "hil/diagnose/verdict.h"

#include <algorithm>
#include <cmath>

namespace forcegate::diagnose {

Structure structure_of(const ResidualChannel& channel, const std::vector<std::vector<double>>& residual) {
  Structure out;
  double sum = 0.0, total = 0.0;
  for (std::size_t k = 0; k < residual.size(); ++k) {
    if (residual[k].size() < 100) continue;
    ++out.of_records;
    double square = 0.0;
    for (double e : residual[k]) square += e * e;
    square /= static_cast<double>(residual[k].size());
    const RecordGram& record = channel.problem.records[k];
    const double scale2 = channel.scale * channel.scale, noise2 = (record.allowed_variance + record.smoothed_variance) * scale2;
    // neighbours in time that agree, or more than the noise can make
    const double smooth = std::max(0.0, autocorrelated_share({residual[k]}, 5)) * square;
    const double excess = std::max(0.0, square - 1.3 * noise2);
    const double structure = std::min(std::max(smooth, 0.7 * excess), excess);
    sum += structure / scale2;
    total += square / scale2;
    if (structure > 0.3 * noise2 && std::sqrt(structure / scale2) > 5e-4) ++out.records;
  }
  if (out.of_records == 0) return out;
  out.rms = std::sqrt(sum / static_cast<double>(out.of_records));
  out.share = total > 0.0 ? sum / total : 0.0;
  return out;
}

std::vector<std::string> depends_on(const std::vector<ResidualMap>& maps) {
  std::vector<std::string> out;
  const double top = maps.empty() ? 0.0 : maps.front().share;
  for (const ResidualMap& map : maps) {
    if (map.share < std::max(0.04, 0.35 * top)) break;
    if (std::find(out.begin(), out.end(), map.group) == out.end()) out.push_back(map.group);
    if (out.size() == 3) break;
  }
  if (out.empty()) out.push_back("time");
  return out;
}

}  // namespace forcegate::diagnose
