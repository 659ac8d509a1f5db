#include "hil/app/diagnose/force_character.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/base/plain_number.h"
#include "hil/base/quantile.h"

namespace forcegate {
namespace {

constexpr double kSlow_N_per_s = 0.02, kFast_N_per_s = 0.1;  // slower is all the same

// How far readings lie beside the force: from second differences, which motion hardly has, and no less than the step that they come in. Of
// coarsely sampled motion that is too much, so more than a small part of the range, or than a load cell scatters by, is not believed.
double play_of(const std::vector<double>& F) {
  constexpr double kStandardDeviations = 6.0, kMost_N = 0.2, kMostOfRange = 0.03;
  double sum = 0.0, n = 0.0, low = 1e300, high = -1e300, step = 1e300;
  for (std::size_t i = 0; i < F.size(); ++i) {
    if (std::isfinite(F[i])) low = std::min(low, F[i]), high = std::max(high, F[i]);
    if (const double change = i > 0 ? std::fabs(F[i] - F[i - 1]) : 0.0; change > 0.0) step = std::min(step, change);  // no NaN is
    if (i < 2) continue;
    if (const double bend = F[i] - 2.0 * F[i - 1] + F[i - 2]; std::isfinite(bend)) sum += std::fabs(bend), n += 1.0;
  }
  const double sd = n > 0.0 ? sum / n / std::sqrt(12.0 / std::numbers::pi) : 0.0;  // E|bend| = sd sqrt(6) sqrt(2 / pi)
  return std::min(std::max(kStandardDeviations * sd, n > 0.0 && step < 1e300 ? step : 0.0), std::max(kMost_N, kMostOfRange * (high - low)));
}

// Where the force begins, of readings that scatter.
double beginning_of(const std::vector<double>& F) {
  constexpr std::size_t kSome = 11;
  std::vector<double> first;
  for (std::size_t i = 0; i < F.size() && first.size() < kSome; ++i)
    if (std::isfinite(F[i])) first.push_back(F[i]);
  return first.empty() ? 0.0 : median(std::move(first));
}

}  // namespace

// A force behind play moves only where the readings leave it, so that their scatter is no motion, at whatever rate they come.
ForceCharacter character_of(const std::vector<double>& t_s, const std::vector<double>& F) {
  ForceCharacter c;
  const double play_N = play_of(F);
  double way_N = 0.0, force_N = beginning_of(F), last_N = 0.0, last_s = 0.0;
  bool begun = false;
  for (std::size_t i = 0; i < F.size(); ++i) {
    if (!std::isfinite(F[i])) continue;
    force_N = std::clamp(force_N, F[i] - play_N, F[i] + play_N);
    if (!begun) begun = true, last_N = force_N, last_s = t_s[i];
    c.low_N = std::min(c.low_N, force_N), c.high_N = std::max(c.high_N, force_N);
    if (const double passed_s = t_s[i] - last_s; passed_s >= 0.05) {
      way_N += std::fabs(force_N - last_N);
      c.fastest_N_per_s = std::max(c.fastest_N_per_s, std::fabs(force_N - last_N) / passed_s);
      last_N = force_N, last_s = t_s[i];
    }
  }
  c.seconds = std::max(1e-3, t_s.back() - t_s.front());
  c.average_N_per_s = way_N / c.seconds;
  // what is left of numbers that should be equal
  constexpr double kNone_N_per_s = 1e-9;
  if (c.fastest_N_per_s < kNone_N_per_s) c.fastest_N_per_s = c.average_N_per_s = 0.0;
  return c;
}

double distance(const ForceCharacter& a, const ForceCharacter& b) {
  const double apart[] = {std::log(a.seconds / b.seconds), std::log((kSlow_N_per_s + a.average_N_per_s) / (kSlow_N_per_s + b.average_N_per_s)),
                          std::log((kFast_N_per_s + a.fastest_N_per_s) / (kFast_N_per_s + b.fastest_N_per_s)), a.low_N - b.low_N, a.high_N - b.high_N};
  double sum = 0.0;
  for (const double d : apart) sum += d * d;
  return std::sqrt(sum);
}

std::string described(const ForceCharacter& c) {
  return plain_number(c.seconds) + " s, " + plain_number(c.low_N) + " to " + plain_number(c.high_N) + " N, " + plain_number(c.average_N_per_s) + " N/s on the average, " +
         plain_number(c.fastest_N_per_s) + " N/s at most";
}

}  // namespace forcegate
