#include "hil/trace/said_in_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "hil/trace/cycle_words.h"

namespace forcegate {
namespace {

// Stamps that every record has stand in for start times that none has.
void take_stamps(std::vector<DescribedRecord>& records, std::vector<std::string>& notes) {
  double first_s = std::numeric_limits<double>::infinity();
  for (const DescribedRecord& r : records) {
    if (r.facts.start_s || !r.notes.stamp_s) return;
    first_s = std::min(first_s, *r.notes.stamp_s);
  }
  for (DescribedRecord& r : records) r.facts.start_s = *r.notes.stamp_s - first_s;
  notes.emplace_back("the records have no start_s; it is taken from the dates and times that campaign.json has of them");
}

std::vector<DescribedRecord*> in_order_of_time(std::vector<DescribedRecord>& records) {
  std::vector<DescribedRecord*> out;
  for (DescribedRecord& r : records) out.push_back(&r);
  std::ranges::stable_sort(out, {}, [](const DescribedRecord* r) { return r->facts.start_s.value_or(0.0); });
  return out;
}

// What is said of mountings in words, where no record has the key: names of theirs, or from which record on the sensor was mounted anew.
void take_mountings(std::vector<DescribedRecord>& records, std::vector<std::string>& notes) {
  bool some_named = false, some_anew = false;
  for (const DescribedRecord& r : records) {
    if (!r.facts.mounting.empty()) return;
    some_named |= !r.notes.mounting.empty();
    some_anew |= r.notes.remounted;
  }
  if (!some_named && !some_anew) return;
  const std::vector<DescribedRecord*> in_order = in_order_of_time(records);
  int number = 1;
  for (DescribedRecord* r : in_order) {
    if (r != in_order.front() && r->notes.remounted) ++number;
    r->facts.mounting = some_named ? r->notes.mounting : std::to_string(number);
  }
  notes.emplace_back("mountings are taken from what campaign.json says of the records in words");
}

// Keys, and the columns of the files, go before words.
void take_air(std::vector<DescribedRecord>& records, std::vector<std::string>& notes) {
  const auto take = [&](std::optional<double> AirNotes::*said, std::optional<double> Record::*fact, const char* quantity) {
    std::size_t n = 0;
    for (DescribedRecord& r : records) {
      if (r.facts.*fact || !(r.air.*said)) continue;
      r.facts.*fact = r.air.*said;
      ++n;
    }
    if (n > 0)
      notes.push_back(fmt::format("{} of {} record{} is taken from what campaign.json says of {} in words", quantity, n, n == 1 ? "" : "s", n == 1 ? "it" : "them"));
  };
  take(&AirNotes::temp_C, &Record::temp_C, "the temperature");
  take(&AirNotes::humidity_pct, &Record::humidity_pct, "the humidity");
  take(&AirNotes::drive_V, &Record::drive_V, "the drive");
}

// Cycles that nobody recorded: out of words where no record has the key, and of a running count what each record adds to it.
void take_cycles(std::vector<DescribedRecord>& records, std::vector<std::string>& notes) {
  const bool declared = std::ranges::any_of(records, [](const DescribedRecord& r) { return r.facts.cycles_before.has_value(); });
  std::size_t n = 0;
  if (!declared)
    for (DescribedRecord& r : records) {
      r.facts.cycles_before = r.cycles_before;
      n += r.cycles_before.value_or(0.0) > 0.0;
    }
  if (n > 0) notes.push_back(fmt::format("the cycles before {} record{} are taken from what campaign.json says of {} in words", n, n == 1 ? "" : "s", n == 1 ? "it" : "them"));
  std::vector<double> counts;
  const std::vector<DescribedRecord*> order = in_order_of_time(records);
  for (const DescribedRecord* r : order)
    if (r->facts.cycles_before) counts.push_back(*r->facts.cycles_before);
  if (counts.size() < records.size() || !is_running_count(counts)) return;
  for (std::size_t k = 1; k < order.size(); ++k) *order[k]->facts.cycles_before = counts[k] - counts[k - 1];
  notes.emplace_back("cycles_before never falls from record to record: it is read as a count of all cycles until then");
}

}  // namespace

void take_words(std::vector<DescribedRecord>& records, std::vector<std::string>& notes) {
  take_stamps(records, notes);
  take_mountings(records, notes);
  take_air(records, notes);
  take_cycles(records, notes);
}

}  // namespace forcegate
