#include "hil/trace/compression.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "hil/base/evenly_chosen.h"
#include "hil/base/parallel.h"
#include "hil/base/quantile.h"

namespace forcegate {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::array kNone = {kInfinity, -kInfinity};

// Ends that a hundredth of the samples lie beyond: a glitch is no end.
std::array<double, 2> ends_of(const Channel& force) {
  constexpr std::size_t kLookedAt = 10000;
  constexpr double kRare = 0.01;
  std::vector<double> seen;
  EvenlyChosen choice(force.value.size(), kLookedAt);
  for (const double F : force.value)
    if (choice.next() && std::isfinite(F)) seen.push_back(F);
  if (seen.empty()) return kNone;
  return quantiles(std::move(seen), kRare, 1.0 - kRare);
}

// The note of it; empty: it was not.
std::string turn_over(const char* name, const std::vector<Trace*>& traces, unsigned threads) {
  constexpr double kSmall = 0.05;  // of the other end: zeros of cells are off by some per cent
  std::vector<std::array<double, 2>> ends(traces.size());
  parallel_for(traces.size(), threads, [&](std::size_t k) {
    const Channel* force = traces[k]->find(name);
    ends[k] = force != nullptr ? ends_of(*force) : kNone;
  });
  auto [lowest, highest] = kNone;
  for (const auto& [low, high] : ends) {
    lowest = std::min(lowest, low);
    highest = std::max(highest, high);
  }
  if (!(lowest < 0.0) || highest > kSmall * -lowest) return {};
  for (Trace* trace : traces)
    if (Channel* force = trace->find(name))
      for (double& F : force->value) F = -F;
  return fmt::format("{} lies below zero ({:.3g} to {:.3g} N): it was turned over, a force that presses is positive", name, lowest, highest);
}

void add_note(std::vector<std::string>& notes, std::string note) {
  if (!note.empty()) notes.push_back(std::move(note));
}

}  // namespace

void turn_compression_over(Campaign& campaign, unsigned threads) {
  std::vector<Trace*> traces;
  for (Record& record : campaign.records) traces.push_back(&record.trace);
  std::string note = turn_over("F_ref", traces, threads);
  BenchFacts& bench = campaign.bench;
  for (Record& record : campaign.records)
    if (!note.empty() && record.m_N && *record.m_N < 0.0) record.m_N = -*record.m_N;
  if (!note.empty() && bench.force_max_N <= 0.0) {
    const double declared_min_N = bench.force_min_N;
    bench.force_min_N = -bench.force_max_N;
    bench.force_max_N = -declared_min_N;
  }
  add_note(campaign.notes, std::move(note));
  add_note(campaign.notes, turn_over("F_cmd", traces, threads));
}

void turn_compression_over(TraceFile& file) {
  for (const char* name : {"F_ref", "F_cmd"}) add_note(file.notes, turn_over(name, {&file.trace}, 1));
}

}  // namespace forcegate
