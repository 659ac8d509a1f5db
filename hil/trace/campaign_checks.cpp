#include "hil/trace/campaign_checks.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "hil/base/plain_number.h"
#include "hil/base/some_of.h"
#include "hil/base/text.h"
#include "hil/trace/columns.h"
#include "hil/trace/row_length.h"

namespace forcegate {
namespace {

constexpr double kRounding_s = 60.0, kShareOfTime = 0.1;  // times are written down to the minute; of the shorter record, of the gap

// NaN included, which stands for the same missing sample in both.
bool same_values(const Channel* a, const Channel* b) {
  if (a == nullptr || b == nullptr) return a == b;
  return std::ranges::equal(a->value, b->value, [](double x, double y) { return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y); });
}

// An output that rests at one code, or that a loop of few codes repeats, is the same twice without being a copy.
bool tells_copies(const Channel& output) {
  constexpr std::size_t kFewestSteps = 50;
  std::size_t steps = 0;
  for (std::size_t i = 1; i < output.value.size() && steps < kFewestSteps; ++i) steps += output.value[i] != output.value[i - 1];
  return steps >= kFewestSteps;
}

bool is_copy(const Record& record, const Record& of) {
  const Channel* output = record.trace.find("U");
  return output != nullptr && same_values(output, of.trace.find("U")) && same_values(record.trace.find("F_ref"), of.trace.find("F_ref")) &&
         tells_copies(*output);
}

void note_beyond(Campaign& campaign, const char* name, const char* unit, const char* key, double low, double high) {
  constexpr double kMargin = 0.02;  // of the range: noise, and a zero that is a little off
  constexpr double kShare = 0.001;  // of the samples
  if (!(low < high)) return;
  const double margin = kMargin * (high - low);
  std::vector<std::string> names;
  double lowest = HUGE_VAL, highest = -HUGE_VAL;
  for (const Record& record : campaign.records) {
    const Channel* channel = record.trace.find(name);
    if (channel == nullptr || channel->unit != unit) continue;
    std::size_t beyond = 0;
    for (const double v : channel->value) beyond += v < low - margin || v > high + margin;
    if (static_cast<double>(beyond) <= kShare * static_cast<double>(channel->value.size())) continue;
    names.push_back(record.name);
    for (const double v : channel->value)
      if (std::isfinite(v)) lowest = std::min(lowest, v), highest = std::max(highest, v);
  }
  if (names.empty()) return;
  campaign.notes.push_back(some_of(names) + ": " + name + " runs from " + plain_number(lowest) + " to " + plain_number(highest) + " " + unit + ", beyond the declared " +
                           key + " [" + shortest(low) + ", " + shortest(high) + "]: is it that of this instrument?");
}

// What is said of a converter in volts says nothing of an output that somebody has turned into something else.
void drop_facts_in_volts(Campaign& campaign) {
  BenchFacts& bench = campaign.bench;
  const Channel* output = campaign.records.empty() ? nullptr : campaign.records.front().trace.find("U");
  if (output == nullptr || output->unit.empty() || output->quantity == "voltage" || output->quantity == "code") return;
  if (!std::isfinite(bench.voltage_max_V) && bench.adc_bits == 0) return;
  campaign.notes.push_back("voltage_range_V and adc_bits are of volts, and the output is in " + output->unit + ": they are not used");
  bench.forget_converter();
}

// Of an output in counts the range is one of counts.
void drop_range_in_volts(Campaign& campaign) {
  constexpr double kFarBeyond = 2.0, kShare = 0.001;  // of its end; of the samples
  BenchFacts& bench = campaign.bench;
  if (!std::isfinite(bench.voltage_max_V) || !is_in_counts(campaign)) return;
  std::size_t beyond = 0, all = 0;
  double highest = -HUGE_VAL;
  for (const Record& record : campaign.records) {
    const Channel* output = record.trace.find("U");
    if (output == nullptr) continue;
    all += output->value.size();
    for (const double v : output->value) {
      beyond += v > kFarBeyond * bench.voltage_max_V;
      if (std::isfinite(v)) highest = std::max(highest, v);
    }
  }
  if (static_cast<double>(beyond) <= kShare * static_cast<double>(all)) return;
  campaign.notes.push_back("the output is in counts, up to " + plain_number(highest) + ", and voltage_range_V [" +
                           shortest(bench.voltage_min_V) + ", " + shortest(bench.voltage_max_V) +
                           "] is hardly theirs: it is not used; say the range in counts, [0, 4096] for 12 bits");
  bench.voltage_min_V = bench.voltage_max_V = kMissing;
}

/// Lowest and highest sample of all records that move; NaN: there is none in that unit.
std::pair<double, double> range_of(const Campaign& campaign, const char* name, const char* unit) {
  constexpr double kMoves = 20.0;  // mean steps from sample to sample, and smallest ones: noise and flickering codes span fewer
  double low = kMissing, high = kMissing;
  for (const Record& record : campaign.records) {
    const Channel* channel = record.trace.find(name);
    if (channel == nullptr || channel->unit != unit) continue;
    double least = kMissing, most = kMissing, way = 0.0, steps = 0.0, finest = kMissing, before = kMissing;
    for (const double v : channel->value) {
      if (!std::isfinite(v)) continue;
      least = std::fmin(least, v), most = std::fmax(most, v);
      if (std::isfinite(before)) way += std::fabs(v - before), steps += 1.0;
      if (v != before) finest = std::fmin(finest, std::fabs(v - before));
      before = v;
    }
    if ((most - least) * steps > kMoves * way && most - least > kMoves * finest) low = std::fmin(low, least), high = std::fmax(high, most);
  }
  return {low, high};
}

// What is declared counts; of another unit it would be a thousand times too large.
void note_facts_beyond_spans(Campaign& campaign) {
  constexpr double kHardlyUsed = 200.0;  // ranges as wide as so many spans
  const BenchFacts& bench = campaign.bench;
  const auto note = [&](const std::string& declared, const char* name, const char* unit, std::pair<double, double> range) {
    campaign.notes.push_back(declared + " " + unit + " is declared, and " + name + " of these records runs from " +
                             plain_number(range.first) + " to " + plain_number(range.second) + " " + unit + ": is it in " + unit +
                             "? It counts as it stands");
  };
  const auto force = range_of(campaign, "F_ref", "N"), output = range_of(campaign, "U", "V");
  const double force_N = force.second - force.first;
  for (const auto& [key, value] : {std::pair{"reference_noise_N", bench.reference_noise_N}, std::pair{"reference_resolution_N", bench.reference_resolution_N}})
    if (force_N > 0.0 && value > force_N) note(std::string(key) + " " + shortest(value), "F_ref", "N", force);
  const auto range = [&](const std::string& key, double low, double high, const char* name, const char* unit,
                         std::pair<double, double> seen) {
    if (const double span = seen.second - seen.first; span > 0.0 && high - low > kHardlyUsed * span)
      note(key + " [" + shortest(low) + ", " + shortest(high) + "]", name, unit, seen);
  };
  range("voltage_range_V", bench.voltage_min_V, bench.voltage_max_V, "U", "V", output);
  range("force_range_N", bench.force_min_N, bench.force_max_N, "F_ref", "N", force);
}

void drop_overlapping_starts(Campaign& campaign) {
  struct Span {
    const Record* record;
    double begin_s, end_s;
  };
  std::vector<Span> spans;
  for (const Record& record : campaign.records)
    if (record.start_s && record.trace.size() > 0) {
      const std::vector<double>& t_s = record.trace.time_bases.front().t_s;
      spans.push_back({&record, *record.start_s, *record.start_s + (t_s.back() - t_s.front())});
    }
  std::ranges::stable_sort(spans, {}, &Span::begin_s);
  for (std::size_t k = 1; k < spans.size(); ++k) {
    const Span &first = spans[k - 1], &second = spans[k];
    const double shorter_s = std::min(first.end_s - first.begin_s, second.end_s - second.begin_s);
    if (first.end_s - second.begin_s <= std::max(kRounding_s, kShareOfTime * shorter_s) && !(first.begin_s == second.begin_s && shorter_s > 0.0)) continue;
    campaign.notes.push_back("start_s of " + second.record->name + " (" + shortest(second.begin_s) + ") lies before the end of " + first.record->name + " (" +
                             plain_number(first.end_s) + "), and one sensor cannot be in two records: the start times are not used");
    for (Record& record : campaign.records) record.start_s.reset();
    return;
  }
}

// Records of rest that lie between count for it: the specimen was not cycled in them.
void note_rests_beyond_starts(Campaign& campaign) {
  std::vector<const Record*> order;
  for (const Record& record : campaign.records)
    if (record.start_s && record.trace.size() > 0) order.push_back(&record);
  std::ranges::stable_sort(order, {}, [](const Record* r) { return *r->start_s; });
  const Record* former = nullptr;
  double end_s = 0.0;
  std::string first;
  std::vector<std::string> others;
  for (const Record* record : order) {
    const double gap_s = *record->start_s - end_s;
    if (former != nullptr && record->rest_before_s && *record->rest_before_s > gap_s + std::max(kRounding_s, kShareOfTime * gap_s)) {
      if (first.empty())
        first = "rest_before_s of " + record->name + " (" + shortest(*record->rest_before_s) + " s) is longer than the " +
                plain_number(std::max(0.0, gap_s)) + " s from the end of " + former->name + " to its start_s";
      else
        others.push_back(record->name);
    }
    if (record->kind == "rest" || record->kind == "hold") continue;
    const std::vector<double>& t_s = record->trace.time_bases.front().t_s;
    former = record;
    end_s = *record->start_s + (t_s.back() - t_s.front());
  }
  if (!first.empty())
    campaign.notes.push_back(first + (others.empty() ? "" : ", and the like in " + some_of(others)) +
                             ": start_s counts for order and times, the rest for where a session begins (an hour or more); mend one of them");
}

// 5 %, 50 % and 95 % of the samples.
std::array<double, 3> spread_of(const Channel& channel) {
  std::vector<double> values;
  for (const double v : channel.value)
    if (std::isfinite(v)) values.push_back(v);
  if (values.empty()) return {kMissing, kMissing, kMissing};
  std::ranges::sort(values);
  const auto at = [&](double q) { return values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))]; };
  return {at(0.05), at(0.5), at(0.95)};
}

}  // namespace

Unfit unfit(const Trace& trace) {
  Unfit out;
  const double rate_Hz = trace.time_bases.empty() ? 0.0 : trace.time_bases.front().nominal_rate_Hz;
  const double needed = kFewestRows * (rate_Hz > 0.0 ? samples_of_row(1.0 / rate_Hz) : 1.0);
  if (static_cast<double>(trace.size()) < needed)
    out.too_short = "the record has only " + std::to_string(trace.size()) + (trace.size() == 1 ? " sample" : " samples") + ", at least " +
                    shortest(needed) + " are needed" + (needed > kFewestRows ? " at this rate" : "");
  std::vector<std::string> columns;
  for (const Channel& channel : trace.channels) columns.push_back(header_of(channel.name, channel.unit));
  for (const auto& [name, what] : {std::pair{"F_ref", "reference force"}, std::pair{"U", "output"}})
    if (trace.find(name) == nullptr && out.no_column.empty()) out.no_column = std::string("no column is the ") + what + ": there are " + some_columns(columns);
  return out;
}

void drop_copies(Campaign& campaign) {
  std::vector<Record> kept;
  std::vector<std::vector<std::string>> copies;
  bool other_role = false;
  for (Record& record : campaign.records) {
    const auto original = std::ranges::find_if(kept, [&](const Record& other) { return is_copy(record, other); });
    if (original == kept.end()) {
      kept.push_back(std::move(record));
      copies.emplace_back();
      continue;
    }
    other_role |= record.role != original->role;
    copies[static_cast<std::size_t>(original - kept.begin())].push_back(record.name);
  }
  for (std::size_t k = 0; k < kept.size(); ++k)
    if (!copies[k].empty())
      campaign.notes.push_back(some_of(copies[k]) + (copies[k].size() > 1 ? " repeat " : " repeats ") + kept[k].name +
                               " sample by sample; a copy is no second measurement, and it is used once");
  if (other_role) campaign.notes.push_back("a record cannot be fitted and held out at once: of copies with two roles that of the first listed counts");
  campaign.records = std::move(kept);
}

void note_contradictions(Campaign& campaign) {
  const BenchFacts& bench = campaign.bench;
  drop_facts_in_volts(campaign);
  drop_range_in_volts(campaign);
  note_beyond(campaign, "U", "V", "voltage_range_V", bench.voltage_min_V, bench.voltage_max_V);
  note_beyond(campaign, "F_ref", "N", "force_range_N", bench.force_min_N, bench.force_max_N);
  note_facts_beyond_spans(campaign);
  drop_overlapping_starts(campaign);
  note_rests_beyond_starts(campaign);
  if (!campaign.records.empty() && std::ranges::all_of(campaign.records, [](const Record& r) { return r.role == RecordRole::heldout; }))
    campaign.notes.push_back("every record is held out, and none is left to be fitted: the roles are not used, records are fitted and left out in turn");
}

void note_unused_rate(Campaign& campaign, double given_Hz) {
  constexpr double kAgrees = 1.05;
  if (!(given_Hz > 0.0)) return;
  std::vector<std::string> names;
  double rate_Hz = 0.0;
  for (const Record& record : campaign.records) {
    if (record.trace.time_bases.empty()) continue;
    const TimeBase& base = record.trace.time_bases.front();
    if (base.invented || (base.nominal_rate_Hz < kAgrees * given_Hz && given_Hz < kAgrees * base.nominal_rate_Hz)) continue;
    if (names.empty()) rate_Hz = base.nominal_rate_Hz;
    names.push_back(record.name);
  }
  if (names.empty()) return;
  campaign.notes.push_back(some_of(names) + ": the rate of " + shortest(given_Hz) + " Hz that was given is not used, for the clock of the file " +
                           (rate_Hz > 0.0 ? "has " + plain_number(rate_Hz) + " Hz" : "has no one rate") + "; where that clock is wrong: --map NAME=unused");
}

Result<void> check_outputs_alike(const Campaign& campaign) {
  struct OutputUnit {
    std::string name;
    std::size_t records = 0;
  };
  std::vector<OutputUnit> units;
  const auto unit_of = [](const Record& record) {
    const Channel* output = record.trace.find("U");
    return output == nullptr ? std::string() : output->unit.empty() || output->unit == "1" ? output->quantity : output->unit;
  };
  for (const Record& record : campaign.records) {
    const std::string name = unit_of(record);
    if (name.empty()) continue;
    auto at = std::ranges::find(units, name, &OutputUnit::name);
    if (at == units.end()) at = units.insert(units.end(), {name, 0});
    ++at->records;
  }
  if (units.size() < 2) return {};
  const OutputUnit& common = *std::ranges::max_element(units, {}, &OutputUnit::records);
  for (const Record& record : campaign.records) {
    const std::string name = unit_of(record);
    if (name.empty() || name == common.name) continue;
    return fail(ErrorCode::parse,
                "the output of " + record.name + " is in " + name + ", that of " + (common.records > 1 ? "the others" : "another") +
                    " in " + common.name + ": one campaign is one output",
                record.place_of_header(),
                "take the record out, or convert it; where only its header is wrong: --map NAME=U_" + common.name);
  }
  return {};
}

void take_varied_supply(Campaign& campaign) {
  constexpr double kSet = 0.05;  // of the largest
  double lowest_V = HUGE_VAL, highest_V = -HUGE_VAL, within_V = 0.0;
  std::vector<Channel*> supplies;
  for (Record& record : campaign.records) {
    if (record.trace.find("drive") != nullptr || record.drive_V) return;
    Channel* supply = record.trace.find("supply");
    if (supply == nullptr) continue;
    supplies.push_back(supply);
    const auto [low_V, middle_V, high_V] = spread_of(*supply);
    if (!std::isfinite(middle_V)) continue;
    lowest_V = std::min(lowest_V, middle_V);
    highest_V = std::max(highest_V, middle_V);
    within_V = std::max(within_V, high_V - low_V);
  }
  if (supplies.empty()) return;
  const bool was_set = highest_V - lowest_V > std::max(kSet * std::max(std::fabs(lowest_V), std::fabs(highest_V)), within_V);
  for (Channel* supply : supplies)
    if (was_set) supply->name = "drive";
  campaign.notes.push_back(
      was_set ? "the supply was set from " + plain_number(lowest_V) + " to " + plain_number(highest_V) +
                    " V from record to record: it was taken for the sensor's drive"
              : "not used: the supply, which nobody set from record to record; is it the sensor's drive, map it: --map NAME=drive_V");
}

}  // namespace forcegate
