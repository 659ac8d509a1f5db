#include "hil/trace/said_in_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>

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

// What is said of mountings in words, where no record has the key: names of theirs, or from which record on the sensor was mounted anew.
void take_mountings(std::vector<DescribedRecord>& records, std::vector<std::string>& notes) {
  bool some_named = false, some_anew = false;
  for (const DescribedRecord& r : records) {
    if (!r.facts.mounting.empty()) return;
    some_named |= !r.notes.mounting.empty();
    some_anew |= r.notes.remounted;
  }
  if (!some_named && !some_anew) return;
  std::vector<DescribedRecord*> in_order;
  for (DescribedRecord& r : records) in_order.push_back(&r);
  std::ranges::stable_sort(in_order, {}, [](const DescribedRecord* r) { return r->facts.start_s.value_or(0.0); });
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

}  // namespace

void take_words(std::vector<DescribedRecord>& records, std::vector<std::string>& notes) {
  take_stamps(records, notes);
  take_mountings(records, notes);
  take_air(records, notes);
}

}  // namespace forcegate
