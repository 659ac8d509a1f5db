#include "hil/diagnose/raw/missing_code.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/base/plain_number.h"
#include "hil/base/quantile.h"

namespace forcegate::diagnose {

bool is_code_for_missing(double value) {
  constexpr double kNoNumber = 1e30;
  constexpr int kFewest = 3, kMost = 9;  // nines
  const double size = std::fabs(value);
  if (size > kNoNumber) return true;
  if (!(size > 0.0)) return false;
  for (int digits = kFewest; digits <= kMost; ++digits) {
    const double nines = std::pow(10.0, digits) - 1.0;
    const double scale = std::pow(10.0, std::round(std::log10(size / nines)));
    if (std::fabs(size / (nines * scale) - 1.0) < 1e-12) return true;
  }
  return false;
}

namespace {

// The note of a record; empty: nothing was left out.
std::string leave_out(Record& record) {
  constexpr double kHundredth = 0.01;
  Channel* output = record.trace.find("U");
  if (output == nullptr) return {};
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const double U : output->value)
    if (!std::isnan(U)) lowest = std::min(lowest, U), highest = std::max(highest, U);
  const bool low_is = is_code_for_missing(lowest), high_is = is_code_for_missing(highest);
  if (!low_is && !high_is) return {};
  const auto is_code = [&](double U) { return (low_is && U == lowest) || (high_is && U == highest); };
  std::vector<double> rest;
  for (const double U : output->value)
    if (!std::isnan(U) && !is_code(U)) rest.push_back(U);
  if (rest.empty()) return {};
  const auto [low, high] = quantiles(std::move(rest), kHundredth, 1.0 - kHundredth);
  std::size_t count = 0;
  double code = 0.0, at_s = 0.0;
  for (std::size_t i = 0; i < output->value.size(); ++i) {
    double& U = output->value[i];
    if (!is_code(U) || std::max(low - U, U - high) <= high - low) continue;
    if (++count == 1) code = U, at_s = record.trace.time_bases[output->time_base].t_s[i];
    U = std::numeric_limits<double>::quiet_NaN();
  }
  if (count == 0) return {};
  return fmt::format("{}: {} of U left out that {} a logger's word for no value, {} at {:.6g} s; leave such cells empty", record.name,
                     count == 1 ? "one sample" : fmt::format("{} samples", count), count == 1 ? "looks like" : "look like", plain_number(code), at_s);
}

}  // namespace

void leave_out_missing_codes(Campaign& campaign, std::vector<std::string>& notes) {
  for (Record& record : campaign.records)
    if (std::string note = leave_out(record); !note.empty()) notes.push_back(std::move(note));
}

}  // namespace forcegate::diagnose
