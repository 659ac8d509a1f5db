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

// A record that says nothing goes on in the mounting before it. What lies before the first name is of that name too, unless the sensor was mounted
// anew there.
void number_from_words(const std::vector<DescribedRecord*>& in_order) {
  const bool named = std::ranges::any_of(in_order, [](const DescribedRecord* r) { return !r->notes.mounting.empty(); });
  const std::string unnamed = named ? "unnamed " : "", first = unnamed + "1";
  std::string now = first;
  int number = 1;
  for (std::size_t k = 0; k < in_order.size(); ++k) {
    const LabNotes& said = in_order[k]->notes;
    if (!said.mounting.empty()) {
      if (now == first && !said.remounted)
        for (std::size_t before = 0; before < k; ++before) in_order[before]->facts.mounting = said.mounting;
      now = said.mounting;
    } else if (said.remounted && k > 0) {
      now = unnamed + std::to_string(++number);
    }
    in_order[k]->facts.mounting = now;
  }
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
  if (some_anew) {
    number_from_words(in_order_of_time(records));
  } else {
    for (DescribedRecord& r : records) r.facts.mounting = r.notes.mounting;
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

void take_lists(const CampaignMembers& members, std::vector<DescribedRecord>& records) {
  const std::vector<AirNotes> air = air_of_runs(members, records.size());
  for (std::size_t i = 0; i < air.size(); ++i) fill_in(records[i].air, air[i]);
  for (const auto& [key, text] : members.texts) {
    const std::vector<double> cycles = cycles_of_runs(key + " " + text, records.size());
    for (std::size_t i = 0; i < cycles.size(); ++i)
      if (!records[i].cycles_before) records[i].cycles_before = cycles[i];
  }
}

void take_words(std::vector<DescribedRecord>& records, std::vector<std::string>& notes) {
  take_stamps(records, notes);
  take_mountings(records, notes);
  take_air(records, notes);
  take_cycles(records, notes);
}

}  // namespace forcegate
