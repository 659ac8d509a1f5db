#include "hil/diagnose/raw/sent_on_change.h"

#include "hil/base/quantile.h"

namespace forcegate::diagnose {

std::optional<double> step_of_sent_changes(const std::vector<RecordHealth>& health) {
  constexpr std::size_t kFewest = 50;
  constexpr double kLow = 0.1, kHigh = 0.9, kOneStep = 2.0, kManyLengths = 2.0;
  std::vector<double> moved_V, samples;
  for (const RecordHealth& h : health)
    for (const HeldRun& run : h.runs) {
      moved_V.push_back(2.0 * run.error_V);
      samples.push_back(static_cast<double>(run.samples));
    }
  if (moved_V.size() < kFewest) return std::nullopt;
  const auto ratio = [&](const std::vector<double>& x) { return quantile(x, kHigh) / quantile(x, kLow); };
  if (!(ratio(moved_V) < kOneStep) || !(ratio(samples) > kManyLengths)) return std::nullopt;
  return quantile(std::move(moved_V), 0.5);
}

}  // namespace forcegate::diagnose
