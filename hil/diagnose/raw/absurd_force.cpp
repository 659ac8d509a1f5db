#include "hil/diagnose/raw/absurd_force.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/base/evenly_chosen.h"
#include "hil/base/parallel.h"

namespace forcegate::diagnose {

namespace {

struct Span {
  double low = 0.0, high = 0.0;
  double width() const { return high - low; }
  double outside(double x) const { return std::max({0.0, low - x, x - high}); }
};

// Of samples over the whole record: a glitch is in none of a hundred of them. `but`: samples that do not count.
Span span_of(const std::vector<double>& values, const std::vector<char>& but) {
  constexpr std::size_t kLookedAt = 2000, kHundredth = 100;
  std::vector<double> x;
  EvenlyChosen choice(values.size(), kLookedAt);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::isfinite(values[i]) && (i >= but.size() || but[i] == 0) && choice.next()) x.push_back(values[i]);
  if (x.empty()) return {};
  std::ranges::sort(x);
  return {x[x.size() / kHundredth], x[x.size() - 1 - x.size() / kHundredth]};
}

// A logger's word for "no value" (-9999) is one number again and again, at an end of what was recorded: it is asked whether the rest knows of it.
std::vector<char> same_extremes(const std::vector<double>& force) {
  constexpr std::ptrdiff_t kAgain = 3;
  constexpr double kMost = 0.25;  // of the samples
  std::vector<char> out(force.size(), 0);
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double F : force)
    if (std::isfinite(F)) low = std::min(low, F), high = std::max(high, F);
  for (const double end : {low, high}) {
    const auto n = std::ranges::count(force, end);
    if (n < kAgain || static_cast<double>(n) > kMost * static_cast<double>(force.size())) continue;
    for (std::size_t i = 0; i < force.size(); ++i)
      if (force[i] == end) out[i] = 1;
  }
  return out;
}

// The note of a record; empty: nothing was left out.
std::string leave_out(Record& record) {
  constexpr double kSpans = 10.0, kOfOutput = 0.1;
  Channel* force = record.trace.find("F_ref");
  const Channel* output = record.trace.find("U");
  if (force == nullptr) return {};
  const std::vector<char> ends = same_extremes(force->value);
  const Span of_force = span_of(force->value, ends);
  if (!(of_force.width() > 0.0)) return {};
  const bool tells = output != nullptr && output->value.size() == force->value.size();
  const Span of_output = tells ? span_of(output->value, ends) : Span{};
  std::size_t count = 0;
  double farthest = 0.0, at_s = 0.0;
  for (std::size_t i = 0; i < force->value.size(); ++i) {
    double& F = force->value[i];
    if (!(of_force.outside(F) > kSpans * of_force.width())) continue;
    if (tells && of_output.outside(output->value[i]) > kOfOutput * of_output.width()) continue;
    if (++count == 1 || of_force.outside(F) > of_force.outside(farthest)) farthest = F, at_s = record.trace.time_bases[force->time_base].t_s[i];
    F = std::numeric_limits<double>::quiet_NaN();
  }
  if (count == 0) return {};
  return fmt::format("{}: {} of F_ref left out, the farthest {:.6g} N at {:.6g} s, where the force runs from {:.3g} to {:.3g} N and the output knows nothing of it", record.name,
                     count == 1 ? "one sample" : fmt::format("{} samples", count), farthest, at_s, of_force.low, of_force.high);
}

}  // namespace

void leave_out_absurd_force(Campaign& campaign, unsigned threads, std::vector<std::string>& notes) {
  std::vector<std::string> of_record(campaign.records.size());
  parallel_for(of_record.size(), threads, [&](std::size_t k) { of_record[k] = leave_out(campaign.records[k]); });
  for (std::string& note : of_record)
    if (!note.empty()) notes.push_back(std::move(note));
}

}  // namespace forcegate::diagnose
