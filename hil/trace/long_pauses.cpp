#include "hil/trace/long_pauses.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "hil/trace/time_base.h"

namespace forcegate {
namespace {

struct Part {
  std::size_t begin, end;
  double pause_before_s;
};

double finite_beside(const std::vector<double>& values, std::size_t from, int step, std::size_t stop) {
  for (std::size_t i = from; i != stop; i = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(i) + step))
    if (std::isfinite(values[i])) return values[i];
  return kMissing;
}

// One load from before the pause to behind it.
bool stands_through(const std::vector<double>& force, std::size_t behind, double low, double high) {
  constexpr double kLoaded = 0.05, kSame = 0.05;  // of the span
  const double before = finite_beside(force, behind - 1, -1, static_cast<std::size_t>(-1)), after = finite_beside(force, behind, 1, force.size());
  return std::min(before, after) > low + kLoaded * (high - low) && std::abs(after - before) < kSame * (high - low);
}

std::vector<Part> parts_of(const Trace& trace, const Channel& force) {
  constexpr double kPause_s = 60.0, kSteps = 50.0;
  const TimeBase& clock = trace.time_bases.front();
  const double least_s = std::max(kPause_s, clock.nominal_rate_Hz > 0.0 ? kSteps / clock.nominal_rate_Hz : HUGE_VAL);
  double low = kMissing, high = kMissing;
  for (const double F : force.value)
    if (std::isfinite(F)) low = std::fmin(low, F), high = std::fmax(high, F);
  std::vector<Part> out{{0, 0, 0.0}};
  for (std::size_t i = 1; i < clock.t_s.size(); ++i) {
    const double pause_s = clock.t_s[i] - clock.t_s[i - 1];
    if (pause_s < least_s || stands_through(force.value, i, low, high)) continue;
    out.back().end = i;
    out.push_back({i, 0, pause_s});
  }
  out.back().end = clock.t_s.size();
  return out;
}

template <class T>
std::vector<T> slice(const std::vector<T>& all, const Part& part) {
  return {all.begin() + static_cast<std::ptrdiff_t>(part.begin), all.begin() + static_cast<std::ptrdiff_t>(part.end)};
}

Record record_of(const Record& whole, const Part& part, std::size_t number) {
  Record out;
  out.name = whole.name + "_" + std::to_string(number);
  out.file = whole.file;
  out.header_line = whole.header_line;
  out.headers = whole.headers;
  out.rate_Hz = whole.rate_Hz;
  if (part.pause_before_s > 0.0) out.rest_before_s = part.pause_before_s;
  out.trace.name = out.name;
  out.trace.provenance = whole.trace.provenance;
  const TimeBase& clock = whole.trace.time_bases.front();
  out.trace.time_bases = {with_rate_and_gaps(slice(clock.t_s, part))};
  out.trace.time_bases.front().device = clock.device;
  for (const Channel& channel : whole.trace.channels) {
    Channel& own = out.trace.channels.emplace_back(Channel{channel.name, channel.unit, channel.quantity, 0, slice(channel.value, part), {}});
    if (!channel.raw.empty()) own.raw = slice(channel.raw, part);
  }
  return out;
}

}  // namespace

std::vector<Record> records_between_pauses(const Record& record, std::vector<std::string>& notes) {
  constexpr std::size_t kFewestSamples = 64, kFewestRecords = 3;
  const Channel* force = record.trace.find("F_ref");
  if (force == nullptr || record.trace.time_bases.size() != 1 || record.trace.size() < kFewestRecords * kFewestSamples) return {};
  std::vector<Part> parts = parts_of(record.trace, *force);
  const std::size_t all = parts.size();
  std::erase_if(parts, [](const Part& p) { return p.end - p.begin < kFewestSamples; });
  if (parts.size() < kFewestRecords) return {};
  std::vector<Record> out;
  double shortest_s = HUGE_VAL, longest_s = 0.0;
  for (const Part& part : parts) {
    out.push_back(record_of(record, part, out.size() + 1));
    if (part.pause_before_s > 0.0) shortest_s = std::min(shortest_s, part.pause_before_s), longest_s = std::max(longest_s, part.pause_before_s);
  }
  notes.push_back(fmt::format("{}: the logger paused, for {:.2g} to {:.2g} min: what lies between the pauses is read as {} records, {} to {}; a file that campaign.json lists stays one",
                              record.name, shortest_s / 60.0, longest_s / 60.0, out.size(), out.front().name, out.back().name));
  if (all > parts.size())
    notes.push_back(fmt::format("{} of its parts between two pauses {} fewer than {} samples and {} left out", all - parts.size(), all - parts.size() == 1 ? "has" : "have", kFewestSamples,
                                all - parts.size() == 1 ? "is" : "are"));
  return out;
}

}  // namespace forcegate
