#include "hil/trace/common_clock.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "hil/base/quantile.h"
#include "hil/base/text.h"
#include "hil/trace/time_base.h"

namespace forcegate {
namespace {

constexpr std::size_t kFewestSamples = 16;

std::vector<std::size_t> rows_with_sample(const Channel& channel) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < channel.value.size(); ++i)
    if (std::isfinite(channel.value[i])) out.push_back(i);
  return out;
}

// Most of its samples stand in the row behind the one before.
bool has_sample_in_every_row(const Channel& channel) {
  std::size_t samples = 0, neighbours = 0;
  bool before = false;
  for (const double v : channel.value) {
    const bool here = std::isfinite(v);
    samples += here ? 1 : 0;
    neighbours += here && before ? 1 : 0;
    before = here;
  }
  return samples > 0 && neighbours > (samples - 1) / 2;
}

double median_distance(const std::vector<double>& at) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < at.size(); ++i) steps.push_back(at[i] - at[i - 1]);
  return steps.empty() ? 0.0 : median(std::move(steps));
}

// Rows from one sample to the next.
std::size_t pace(const std::vector<std::size_t>& samples) {
  return static_cast<std::size_t>(median_distance({samples.begin(), samples.end()}));
}

// What the channel reads at the rows `at`; how many of them lie between its samples.
std::size_t read_at(Channel& channel, const std::vector<double>& t_s, const std::vector<std::size_t>& at) {
  constexpr double kLongestLine = 2.0;  // of its own steps
  const std::vector<std::size_t> own = rows_with_sample(channel);
  std::vector<double> own_s;
  for (const std::size_t i : own) own_s.push_back(t_s[i]);
  const double longest_s = kLongestLine * median_distance(own_s);
  std::vector<double> value;
  std::vector<std::int32_t> raw;
  std::size_t between = 0, next = 0;
  for (const std::size_t i : at) {
    if (!channel.raw.empty()) raw.push_back(channel.raw[i]);
    value.push_back(channel.value[i]);
    if (std::isfinite(value.back())) continue;
    while (next < own.size() && own[next] < i) ++next;
    if (next == 0 || next == own.size() || own_s[next] - own_s[next - 1] > longest_s) continue;
    const double before = channel.value[own[next - 1]], after = channel.value[own[next]];
    const double share = channel.quantity == "angle" ? 0.0 : (t_s[i] - own_s[next - 1]) / (own_s[next] - own_s[next - 1]);
    value.back() = before + share * (after - before);
    ++between;
  }
  channel.value = std::move(value);
  channel.raw = std::move(raw);
  return between;
}

std::string every_row(std::size_t n) {
  const bool teen = n % 100 / 10 == 1;
  const char* const ending = teen ? "th" : n % 10 == 1 ? "st" : n % 10 == 2 ? "nd" : n % 10 == 3 ? "rd" : "th";
  return "every " + std::to_string(n) + ending + " row";
}

// The channel at instants of another clock, along straight lines between two samples that are there and no more than two steps apart.
std::vector<double> read_at_instants(const Channel& channel, const std::vector<double>& own_s, const std::vector<double>& t_s) {
  constexpr double kLongestLine = 2.0;
  const double longest_s = kLongestLine * median_distance(own_s), turn = 2.0 * std::numbers::pi;
  const bool is_angle = channel.quantity == "angle";
  std::vector<double> out(t_s.size(), kMissing);
  const std::size_t n = std::min(own_s.size(), channel.value.size());
  std::size_t next = 0;
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    while (next < n && own_s[next] < t_s[i]) ++next;
    if (next == n) break;
    if (own_s[next] == t_s[i]) {
      out[i] = channel.value[next];
      continue;
    }
    if (next == 0 || own_s[next] - own_s[next - 1] > longest_s) continue;
    const double share = (t_s[i] - own_s[next - 1]) / (own_s[next] - own_s[next - 1]);
    const double step = channel.value[next] - channel.value[next - 1];
    out[i] = channel.value[next - 1] + share * (is_angle ? std::remainder(step, turn) : step);
  }
  return out;
}

// Force and output that two devices stamped: everything is read at the samples of the slower of the two while both run.
std::string read_on_clock_of(const Channel& slow, const Channel& fast, Trace& trace) {
  const std::vector<double>&own_s = trace.time_bases[slow.time_base].t_s, &other_s = trace.time_bases[fast.time_base].t_s;
  const auto begin = std::ranges::lower_bound(own_s, other_s.front()), end = std::ranges::upper_bound(own_s, other_s.back());
  // clocks that hardly meet leave rows without the other channel, which is told where rows are judged
  const bool both_run = end - begin >= static_cast<std::ptrdiff_t>(kFewestSamples);
  std::vector<double> t_s = both_run ? std::vector<double>(begin, end) : own_s;
  std::string text = slow.name + " and " + fast.name + " have clocks of their own: the record is read at the samples of " + slow.name + ", " + fast.name +
                     " along straight lines";
  for (Channel& channel : trace.channels) {
    channel.value = read_at_instants(channel, trace.time_bases[channel.time_base].t_s, t_s);
    channel.raw.clear();
  }
  TimeBase common = with_rate_and_gaps(std::move(t_s));
  common.device = trace.time_bases[slow.time_base].device;
  for (Channel& channel : trace.channels) channel.time_base = 0;
  trace.time_bases.assign(1, std::move(common));
  return text;
}

}  // namespace

std::optional<std::string> put_on_common_clock(Trace& trace) {
  Channel *force = trace.find("F_ref"), *output = trace.find("U");
  if (force == nullptr || output == nullptr) return {};
  if (force->time_base != output->time_base) {
    const std::vector<double>&of_force_s = trace.time_bases[force->time_base].t_s, &of_output_s = trace.time_bases[output->time_base].t_s;
    if (of_force_s.empty() || of_output_s.empty()) return {};
    const bool output_is_slow = median_distance(of_output_s) > median_distance(of_force_s);
    return read_on_clock_of(output_is_slow ? *output : *force, output_is_slow ? *force : *output, trace);
  }
  TimeBase& base = trace.time_bases[force->time_base];
  const auto fits = [&](const Channel& c) { return c.time_base != force->time_base || c.value.size() == base.t_s.size(); };
  if (!std::ranges::all_of(trace.channels, fits)) return {};
  if (has_sample_in_every_row(*force) && has_sample_in_every_row(*output)) return {};
  const std::vector<std::size_t> of_force = rows_with_sample(*force), of_output = rows_with_sample(*output);
  const bool force_is_slow = of_force.size() < of_output.size();
  const std::vector<std::size_t>& samples = force_is_slow ? of_force : of_output;
  if (samples.size() < kFewestSamples || std::max(pace(of_force), pace(of_output)) < 2) return {};

  const Channel& slow = force_is_slow ? *force : *output;
  const Channel& fast = force_is_slow ? *output : *force;
  std::string text = slow.name + " has a sample in " + every_row(pace(samples)) + " only: the record is read at its " +
                     std::to_string(samples.size()) + " samples";
  std::size_t between = 0;
  for (Channel& channel : trace.channels) {
    if (channel.time_base != force->time_base) continue;
    const std::size_t n = read_at(channel, base.t_s, samples);
    if (&channel == &fast) between = n;
  }
  if (between > 0) text += ", " + fast.name + " along straight lines at " + std::to_string(between) + " of them";
  std::vector<double> t_s;
  for (const std::size_t i : samples) t_s.push_back(base.t_s[i]);
  TimeBase common = with_rate_and_gaps(std::move(t_s));
  common.device = base.device;
  common.invented = base.invented;
  base = std::move(common);
  return text;
}

}  // namespace forcegate
