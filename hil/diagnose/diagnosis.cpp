#include "hil/diagnose/diagnosis.h"

#include <fmt/format.h>

#include "hil/base/plain_number.h"
#include "hil/base/slug.h"
#include "hil/base/text.h"

namespace forcegate {

std::string to_string(DiagnosisVerdict verdict) {
  switch (verdict) {
    case DiagnosisVerdict::none: return "none";
    case DiagnosisVerdict::known: return "known";
    case DiagnosisVerdict::unknown: return "unknown";
  }
  return "none";
}

std::string to_string(JudgedBy by) {
  switch (by) {
    case JudgedBy::heldout: return "heldout";
    case JudgedBy::left_out: return "left_out";
    case JudgedBy::whole: return "whole";
  }
  return "heldout";
}

std::string profile_name(const ExperimentSegment& segment, std::size_t number) { return fmt::format("profiles/{}_{}.csv", number, slug(segment.name)); }

std::string parameters_text(const ExperimentSegment& segment, std::size_t number, const std::string& equals, const std::string& between) {
  if (segment.stimulus == "replay") return "path" + equals + profile_name(segment, number);
  std::vector<std::string> words;
  for (const auto& [name, value] : segment.numbers) words.push_back(name + equals + shortest(value));
  for (const auto& [name, values] : segment.lists) {
    std::vector<std::string> list;
    for (const double value : values) list.push_back(shortest(value));
    words.push_back(name + equals + join(list, ","));
  }
  return join(words, between);
}

std::string error_name(JudgedBy by) { return by == JudgedBy::whole ? "error of the whole recording" : "held-out error"; }

std::string probability_text(double probability) {
  return fmt::format("{:.2f}", probability < kClaim ? std::min(probability, kClaim - 0.01) : probability);
}

bool Finding::limit(double most, const std::string& why) {
  if (!(probability > most)) return false;
  probability = most;
  reservations.push_back({most, why});
  evidence += (most < kClaim ? "; not claimed: " : "; less sure: ") + why;
  return true;
}

void Finding::not_claimed(const std::string& why) {
  reservations.push_back({probability, why});
  evidence += "; not claimed: " + why;
}

std::vector<const Finding*> suspicions_beside_none(const Diagnosis& d) {
  std::vector<const Finding*> out;
  if (d.verdict != DiagnosisVerdict::none) return out;
  for (const Finding& f : d.findings)
    if (!f.claimed() && !f.in_model && f.of_output() && f.effect_rms > kFarAboveNoise * d.floor) out.push_back(&f);
  return out;
}

const Finding* open_name(const Diagnosis& d) {
  if (d.verdict != DiagnosisVerdict::unknown || !d.not_separable.empty()) return nullptr;
  const auto found = std::ranges::find_if(d.findings, [](const Finding& f) { return f.name_is_open && !f.claimed() && !f.in_model && f.probability >= kNoClaim; });
  return found == d.findings.end() ? nullptr : &*found;
}

std::string beside_none(const Diagnosis& d) {
  constexpr std::size_t kNamed = 3;
  if (d.verdict != DiagnosisVerdict::none) return {};
  std::string out;
  const std::vector<const Finding*> suspicions = suspicions_beside_none(d);
  for (std::size_t k = 0; k < suspicions.size(); ++k) {
    out += (k == 0 ? "" : " and ") + suspicions[k]->effect;
    for (const Finding& rival : d.findings)
      if (rival.rival_of == suspicions[k]->effect) out += " or " + rival.effect;
  }
  if (!out.empty()) out += suspicions.size() > 1 ? " are suspected and not claimed" : " is suspected and not claimed";
  std::string records;
  for (std::size_t k = 0; k < std::min(kNamed, d.far_above.size()); ++k)
    records += fmt::format("{}{} ({})", k == 0 ? "" : ", ", d.far_above[k].record, so_many_times(d.far_above[k].times));
  if (d.far_above.size() > kNamed) records += " and others";
  if (!records.empty()) out += (out.empty() ? "far above its noise stands " : ", and far above its noise stands ") + records;
  return out;
}

}  // namespace forcegate
