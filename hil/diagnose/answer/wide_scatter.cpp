#include "hil/diagnose/answer/wide_scatter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace forcegate::diagnose {

namespace {

constexpr double kGain = 0.03, kZero = 0.01;        // of the gain, of the span
constexpr double kFarZero = 0.03;
constexpr std::size_t kFewestRecords = 4;

// +1: up from record to record, -1: down, 0: neither. Kendall's tau of six in a chance order is beyond 0.86 once in 60 times, of eight once in 2500.
int direction(const std::vector<double>& of_record) {
  constexpr std::size_t kFewest = 6;
  constexpr double kTau = 0.86;
  if (of_record.size() < kFewest) return 0;
  double sum = 0.0, pairs = 0.0;
  for (std::size_t i = 0; i < of_record.size(); ++i)
    for (std::size_t k = i + 1; k < of_record.size(); ++k, pairs += 1.0) sum += of_record[k] > of_record[i] ? 1.0 : of_record[k] < of_record[i] ? -1.0 : 0.0;
  const double tau = sum / pairs;
  return tau > kTau ? 1 : tau < -kTau ? -1 : 0;
}

struct Level {
  const char* name;
  double sd, ordinary, far;
  std::string size;  // "12 %"
  std::vector<double> of_record;
};

bool is_far_from_zero(const CampaignInput& input) { return std::abs(input.lowest_N) > input.range_N; }

// Of each record, at no force; or, where the load cell was never tared and the records are far from it, at the lowest of them: a gain that scatters a
// little moves a zero that is far away.
std::vector<double> zeros_of(const Workspace& w, const MixedFit& fit) {
  const double per_gain = is_far_from_zero(w.input) ? w.gain_V_per_N * w.input.lowest_N / w.output.scale : 0.0;
  std::vector<double> out;
  for (const Eigen::VectorXd& zeta : fit.zeta) out.push_back(zeta[1] + per_gain * zeta[0]);
  return out;
}

double spread_of(const std::vector<double>& x) {
  double mean = 0.0, square = 0.0;
  for (const double v : x) mean += v / static_cast<double>(x.size());
  for (const double v : x) square += (v - mean) * (v - mean);
  return std::sqrt(square / std::max(1.0, static_cast<double>(x.size()) - 1.0));
}

std::string told(const Level& level) {
  const int way = direction(level.of_record);
  return fmt::format("the {} scatters by {}{}", level.name, level.size,
                     way == 0 ? "" : way > 0 ? ", and rises from record to record in their order" : ", and falls from record to record in their order");
}

}  // namespace

std::optional<WideScatter> wide_scatter(const Workspace& w, const MixedFit& fit, bool zeros_explained) {
  const auto sd = [&](int k) { return std::sqrt(fit.variance[k]); };
  const double gain = std::abs(w.gain_V_per_N);
  std::vector<double> zeros = zeros_of(w, fit);
  const double zero = is_far_from_zero(w.input) ? spread_of(zeros) : sd(1);
  Level levels[] = {
      {"gain", sd(0), kGain, kFarGain, fmt::format("{:.2g} %", 100.0 * sd(0)), {}},
      {"zero", zero, kZero, kFarZero,
       gain > 0.0 ? fmt::format("{:.2g} N", zero * w.output.scale / gain) : fmt::format("{:.2g} %", 100.0 * zero), std::move(zeros)}};
  for (const Eigen::VectorXd& zeta : fit.zeta) levels[0].of_record.push_back(zeta[0]);
  WideScatter out;
  bool as_sessions = true;
  for (const Level& level : levels) {
    if (level.sd < level.ordinary || (zeros_explained && &level == &levels[1])) continue;
    out.note += (out.note.empty() ? "from record to record " : " and ") + told(level);
    const bool far = level.sd >= level.far || direction(level.of_record) != 0;
    as_sessions = as_sessions && !far && &level == &levels[0];
    if (far && w.output.rows.size() >= kFewestRecords)
      out.follows += fmt::format("{} {} scatters by {}", out.follows.empty() ? "the record, whose" : " and", level.name, level.size);
  }
  if (out.note.empty()) return std::nullopt;
  out.note +=
      as_sessions
          ? ", more than a specimen repeats to within a session and no more than one does from session to session (9 %, Lebosse 2011)"
          : ", far more than a specimen repeats to";
  out.note += ", and nothing that was recorded goes with it: is it mounted, zeroed or driven anew in between, or was its temperature or humidity not recorded?";
  return out;
}

}  // namespace forcegate::diagnose
