#include "hil/diagnose/partly_told.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "hil/base/some_of.h"
#include "hil/model/missing_facts.h"

namespace forcegate::diagnose {

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

double mean_of(const Channel* channel) {
  if (channel == nullptr) return kUnknown;
  double sum = 0.0, n = 0.0;
  for (const double v : channel->value)
    if (std::isfinite(v)) sum += v, n += 1.0;
  return n > 0.0 ? sum / n : kUnknown;
}

struct Fact {
  const char* effect;
  const char* key;
  const char* channel;
  std::optional<double> Record::* declared;
  double same, same_of_it;  // values that differ by less, and by less than this share of them, are one
};

constexpr Fact kFacts[] = {{"bias", "drive_V", "drive", &Record::drive_V, 0.0, 0.02},
                           {"thermal", "temp_C", "temp", &Record::temp_C, 1.0, 0.0},
                           {"humidity", "humidity_pct", "humidity", &Record::humidity_pct, 2.0, 0.0}};

double value_of(const Fact& fact, const Record& record) {
  const std::optional<double>& declared = record.*fact.declared;
  return declared ? *declared : mean_of(record.trace.find(fact.channel));
}

}  // namespace

std::vector<PartlyTold> partly_told(const Campaign& campaign) {
  std::vector<PartlyTold> out;
  for (const Fact& fact : kFacts) {
    std::vector<std::string> silent;
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const Record& r : campaign.records) {
      const double value = value_of(fact, r);
      if (!std::isfinite(value)) silent.push_back(r.name);
      else low = std::min(low, value), high = std::max(high, value);
    }
    if (silent.empty() || !enough_tell(campaign.records.size() - silent.size(), campaign.records.size())) continue;
    if (!(high - low > std::max(fact.same, fact.same_of_it * std::abs(high)))) continue;
    PartlyTold part{fact.effect, fact.key, std::move(silent), campaign};
    std::erase_if(part.told.records, [&](const Record& r) { return std::ranges::find(part.silent, r.name) != part.silent.end(); });
    out.push_back(std::move(part));
  }
  return out;
}

bool take_partly_told(const PartlyTold& of, const Diagnosis& whole, Diagnosis& answer) {
  constexpr double kPlainly = 0.9;
  if (std::ranges::any_of(whole.findings, [](const Finding& f) { return f.claimed() && f.between_records; })) return false;
  if (std::ranges::none_of(answer.findings, [&](const Finding& f) { return f.effect == of.effect && f.probability >= kPlainly; })) return false;
  answer.notes.push_back(some_of(of.silent) + (of.silent.size() > 1 ? " have no " : " has no ") + of.fact + ", as a key or a column: this is the answer of the other " +
                         std::to_string(of.told.records.size()) + " records alone");
  return true;
}

}  // namespace forcegate::diagnose
