#include "hil/app/diagnose/what_next.h"

#include <algorithm>
#include <charconv>
#include <filesystem>

#include "hil/app/diagnose/diagnose.h"
#include "hil/app/files/find_plan.h"

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

}  // namespace

WhatNext after_diagnosis(const Diagnosis& d, const Standing& at) {
  const Finding* first = worth_adding(d);
  if (first != nullptr && std::ranges::find(at.in_model, first->effect) == at.in_model.end())
    return {Step::add, first->effect};
  if (competes(d)) return {at.experiment ? Step::record : Step::experiment, ""};
  if (d.verdict == DiagnosisVerdict::none) {
    if (at.experiment) return {Step::record, ""};
    if (!(d.force_range_N > 0.0)) return {Step::explain, "none"};  // recordings without an input: there is no law to fit
    if (at.is_exportable && at.is_exportable()) return {Step::compensate, ""};
    return at.model_file ? WhatNext{Step::explain, "none"} : WhatNext{Step::fit, ""};
  }
  if (!at.page) return {Step::page, ""};
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
    if (export_model(request)) return offer;
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
