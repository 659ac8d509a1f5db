#include "hil/app/diagnose/what_next.h"

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "hil/app/diagnose/diagnose.h"
#include "hil/app/export/recorded_rate.h"
#include "hil/app/files/find_plan.h"
#include "hil/trace/clock_unit.h"

namespace forcegate {
namespace {

// What a person must mend who cannot mend it in the model: the side of the first claim.
std::string word_of(const Diagnosis& d) {
  if (d.verdict == DiagnosisVerdict::none) return "none";
  if (d.verdict == DiagnosisVerdict::unknown) return d.not_separable.empty() ? "unknown" : "not separable";
  for (const Finding& f : d.findings)
    if (f.claimed()) return f.effect == "drift" ? "drift" : f.side;
  return "known";
}

// Whether a further record can settle it. What the evidence of the ranking leaves open beside a claim, or where nothing is missing, is for
// who asks `next` for it; so is what was refused because it explains too little.
bool competes(const Diagnosis& d) {
  constexpr double kOpen = 0.25;
  if (!d.not_separable.empty()) return true;
  return d.verdict == DiagnosisVerdict::unknown && !d.next_experiment.segments.empty() &&
         std::ranges::any_of(d.findings, [](const Finding& f) { return f.probability >= kOpen; });
}

// An effect of the sensor is claimed, and a model that takes it in is no better for the held-out records: only more of them tell.
bool is_of_no_use_yet(const Diagnosis& d) {
  return d.verdict == DiagnosisVerdict::known && is_described_worse(d) && std::ranges::any_of(d.findings, [](const Finding& f) {
    const EffectKind* kind = EffectRegistry::instance().find(f.effect);
    return f.claimed() && f.of_output() && kind != nullptr && kind->channel == EffectChannel::output;
  });
}

}  // namespace

std::string map_of_doubtful_clock(const Diagnosis& d) { return map_of_clock(d.notes); }

bool leads_to_add(const Diagnosis& d, const std::string& effect) {
  const Finding* first = worth_adding(d);
  return first != nullptr && first->effect == effect;
}

std::string plan_that_settles(const Diagnosis& d) {
  constexpr const char* kInCampaign[] = {"creep", "hysteresis"};  // long holds at two levels; triangles at two speeds, minor loops
  std::vector<std::string> asked;
  if (!d.not_separable.empty()) asked = d.not_separable.front();
  else
    for (const Finding* f : suspicions_beside_none(d)) asked.push_back(f->effect);
  if (asked.empty() && d.verdict == DiagnosisVerdict::none) return "campaign";  // what these records do not play at all
  const bool plays = std::ranges::any_of(asked, [&](const std::string& effect) { return std::ranges::find(kInCampaign, effect) != std::end(kInCampaign); });
  return plays ? "campaign" : "";
}

WhatNext after_diagnosis(const Diagnosis& d, const Standing& at) {
  for (const Finding& f : d.findings)
    if (f.claimed() && (f.form == kBehindLag || f.form == kBehindCurve)) return {Step::align, "", f.parameters.front().value};
  const Finding* first = worth_adding(d);
  if (first != nullptr && std::ranges::find(at.in_model, first->effect) == at.in_model.end())
    return {Step::add, first->effect};
  if (competes(d)) return {at.experiment ? Step::record : Step::experiment, ""};
  if (d.verdict == DiagnosisVerdict::none) {
    if (at.experiment) return {Step::record, ""};
    if (!at.page && !beside_none(d).empty()) return {Step::page, ""};
    if (!suspicions_beside_none(d).empty()) return {Step::experiment, ""};
    if (!(d.force_range_N > 0.0)) return {Step::explain, "none"};  // recordings without an input: there is no law to fit
    if (at.is_exportable && at.is_exportable()) return {Step::compensate, ""};
    return at.model_file ? WhatNext{Step::explain, "none"} : WhatNext{Step::fit, ""};
  }
  if (!at.page) return {Step::page, ""};
  if (is_of_no_use_yet(d)) return {Step::record, ""};
  // what was added before is worth having, though not all is understood
  if (d.verdict == DiagnosisVerdict::unknown && !at.in_model.empty() && at.is_exportable && at.is_exportable()) return {Step::compensate, ""};
  return {Step::explain, word_of(d)};
}

bool is_shipped_model(const std::string& model) {
  const std::vector<std::string> known = library_model_names();
  return model.empty() || std::ranges::find(known, model) != known.end();
}

std::optional<ExportOffer> export_offer(const std::string& model, const CampaignRequest* campaign) {
  ExportRequest request;
  request.model = model;
  ExportOffer offer{.refit = campaign != nullptr};
  if (!find_plan(request.plan)) {
    offer.plan = false;
    request.plan = "none";
  }
  for (const bool refit : {true, false}) {
    if (refit && !offer.refit) continue;
    offer.refit = refit;
    request.fit.reset();
    if (refit) request.fit = *campaign;
    const Result<ExportResult> made = export_model(request);
    if (!made) {
      offer.check = refit && made.error().text == diagnose::kEffectsOfNoUse;
      continue;
    }
    if (offer.plan || campaign == nullptr) return offer;
    // made again: one that runs fast enough for its lags at 1000 Hz may not at 20 Hz
    double recorded_Hz = made->recorded_Hz;
    if (!refit)
      if (const Result<Campaign> records = load_campaign(*campaign)) recorded_Hz = recorded_rate_Hz(*records);
    if (!is_other_rate(request.rate_Hz, recorded_Hz)) return offer;
    request.rate_Hz = recorded_Hz;
    if (export_model(request)) offer.rate_Hz = recorded_Hz;
    return offer;
  }
  return std::nullopt;
}

std::string better_model_name(const std::string& model) {
  constexpr std::string_view kStem = "better", kEnding = ".toml";
  const std::string file = std::filesystem::path(model).filename().string();
  if (!file.starts_with(kStem) || !file.ends_with(kEnding) || file.size() < kStem.size() + kEnding.size())
    return std::string(kStem) + std::string(kEnding);
  const std::string digits = file.substr(kStem.size(), file.size() - kStem.size() - kEnding.size());
  int number = digits.empty() ? 1 : 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (!digits.empty() && (error != std::errc() || end != digits.data() + digits.size())) return "better.toml";
  const std::filesystem::path folder = std::filesystem::path(model).parent_path();
  return (folder / (std::string(kStem) + std::to_string(number + 1) + std::string(kEnding))).string();
}

}  // namespace forcegate
