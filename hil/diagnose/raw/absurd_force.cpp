#include "hil/diagnose/raw/absurd_force.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace forcegate::diagnose {

namespace {

struct Span {
  double low = 0.0, high = 0.0;
  double width() const { return high - low; }
  double outside(double x) const { return std::max({0.0, low - x, x - high}); }
};

Span span_of(const std::vector<double>& values) {
  constexpr std::ptrdiff_t kHundredth = 100;
  std::vector<double> x;
  for (const double v : values)
    if (std::isfinite(v)) x.push_back(v);
  if (x.empty()) return {};
  const std::ptrdiff_t k = std::ssize(x) / kHundredth;
  std::ranges::nth_element(x, x.begin() + k);
  const double low = x[static_cast<std::size_t>(k)];
  std::ranges::nth_element(x, x.end() - 1 - k);
  return {low, *(x.end() - 1 - k)};
}

}  // namespace

void leave_out_absurd_force(Campaign& campaign, std::vector<std::string>& notes) {
  constexpr double kSpans = 10.0, kOfOutput = 0.1;
  for (Record& record : campaign.records) {
    Channel* force = record.trace.find("F_ref");
    const Channel* output = record.trace.find("U");
    if (force == nullptr) continue;
    const Span of_force = span_of(force->value);
    if (!(of_force.width() > 0.0)) continue;
    const bool tells = output != nullptr && output->value.size() == force->value.size();
    const Span of_output = tells ? span_of(output->value) : Span{};
    std::size_t count = 0;
    double farthest = 0.0, at_s = 0.0;
    for (std::size_t i = 0; i < force->value.size(); ++i) {
      double& F = force->value[i];
      if (!(of_force.outside(F) > kSpans * of_force.width())) continue;
      if (tells && of_output.outside(output->value[i]) > kOfOutput * of_output.width()) continue;
      if (++count == 1 || of_force.outside(F) > of_force.outside(farthest)) farthest = F, at_s = record.trace.time_bases[force->time_base].t_s[i];
      F = std::numeric_limits<double>::quiet_NaN();
    }
    if (count > 0)
      notes.push_back(fmt::format("{}: {} of F_ref left out, the farthest {:.3g} N at {:.6g} s, where the force runs from {:.3g} to {:.3g} N and the output knows nothing of it", record.name,
                                  count == 1 ? "one sample" : fmt::format("{} samples", count), farthest, at_s, of_force.low, of_force.high));
  }
}

}  // namespace forcegate::diagnose
