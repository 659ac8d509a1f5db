#include "hil/app/diagnose/diagnose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "hil/app/diagnose/with_claims.h"
#include "hil/app/pictures/record_pictures.h"
#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/diagnose/laws/drift.h"
#include "hil/diagnose/next/next_experiment.h"
#include "hil/report/finding_side.h"
#include "hil/trace/channels.h"

namespace forcegate {

namespace {

// A column that Forcegate knows nothing of may be the force: where nobody mapped it, only drift could be judged, and wrongly.
bool has_unknown_column(const Campaign& campaign) {
  for (const Record& record : campaign.records)
    for (const Channel& channel : record.trace.channels)
      if (known_channel(channel.name) == nullptr) return true;
  return false;
}

// What parts several of them is said once.
std::string look_alikes(const Finding& f) {
  std::string out;
  std::vector<std::string> told;
  for (const LookAlike& a : f.confounded_with) {
    if (a.cosine == 0.0) {
      out += fmt::format("      {} fits nearly as well; {}\n", a.effect, a.separates);
      continue;
    }
    if (std::ranges::find(told, a.separates) != told.end()) continue;
    told.push_back(a.separates);
    std::vector<std::string> names;
    for (const LookAlike& other : f.confounded_with)
      if (other.cosine != 0.0 && other.separates == a.separates)
        names.push_back(fmt::format("{}{} (cos {:.2f})", other.effect, names.empty() ? " on these records" : "", other.cosine));
    out += "      looks like " + join(names, ", ") + "; " + a.separates + "\n";
  }
  return out;
}

// An amplifier bends the output of such a sensor by a percent or two.
void tell_of_divider(const diagnose::Workspace& w, Diagnosis& d) {
  constexpr double kMuch = 0.03;  // of the span
  const auto bends = [&](const Finding& f) { return f.claimed() && f.effect == "static_nonlinearity" && f.effect_rms > kMuch * w.output.scale; };
  if ((d.unit == "V" || d.unit == "counts") && std::ranges::any_of(d.findings, bends))
    d.notes.push_back(
        "an output that is bent so much may be that of a divider: --divider OHMS:SUPPLY (:below with the sensor between output and ground) reads the sensor's conductance");
}

Result<Diagnosis> diagnose_recordings(const CampaignRequest& request, Campaign campaign, const Model& model, RecordPictures* pictures) {
  if (request.maps.empty() && has_unknown_column(campaign)) FORCEGATE_CHECK_OK(check_channels(campaign, request.maps));
  if (diagnose::is_drift_only(campaign)) {
    FORCEGATE_TRY(Diagnosis drift, diagnose::diagnose_drift(campaign));
    if (pictures != nullptr) *pictures = drift_pictures(campaign, drift.findings.empty() ? "" : drift.findings.front().form);
    return drift;
  }
  FORCEGATE_CHECK_OK(check_channels(campaign, request.maps));
  FORCEGATE_CHECK_OK(diagnose::check_output_moves(campaign));
  diagnose::EngineOptions options = engine_options(model, request.threads);
  options.pictures = pictures != nullptr;
  FORCEGATE_TRY(diagnose::Diagnosed found, diagnose::diagnose_campaign_in(std::move(campaign), options));
  found.diagnosis.next_experiment = diagnose::propose_experiment(*found.workspace, found.diagnosis);
  tell_of_divider(*found.workspace, found.diagnosis);
  const bool plain = is_plain_refitted(*found.workspace, found.diagnosis);
  const std::optional<diagnose::Refit> after = pictures != nullptr ? with_claims(*found.workspace, model, found.diagnosis, request.threads) : std::nullopt;
  if (plain) tell_plain_as_refitted(*found.workspace, options, after, found.diagnosis);
  if (pictures != nullptr) *pictures = record_pictures(*found.workspace, model, after ? &after->model : nullptr);
  return std::move(found.diagnosis);
}

}  // namespace

Result<Diagnosis> diagnose_request(const CampaignRequest& request, RecordPictures* pictures) {
  FORCEGATE_TRY(Campaign campaign, load_recordings(request));
  FORCEGATE_TRY(const Model model, load_model(request, campaign));
  const PlacesOf places(campaign, request.campaign);
  Result<Diagnosis> out = diagnose_recordings(request, std::move(campaign), model, pictures);
  if (!out) return Unexpected(places.with_file(std::move(out.error())));
  return out;
}

const Finding* worth_adding(const Diagnosis& d) {
  if (is_described_worse(d)) return nullptr;
  for (const Finding& f : d.findings) {
    const EffectKind* kind = EffectRegistry::instance().find(f.effect);
    if (f.claimed() && f.of_output() && f.effect != "drift" &&
        f.error_after < f.error_before && (kind == nullptr || kind->channel == EffectChannel::output))
      return &f;
  }
  return nullptr;
}

std::string diagnosis_text(const Diagnosis& d) {
  std::string out;
  const PrintedUnit unit = printed_unit(d.unit);
  const auto number = [&](double v) { return plain_number(unit.factor * v); };
  const std::string it_follows = d.follows.empty() ? "" : "; it follows " + join(d.follows, " and ");
  if (d.verdict == DiagnosisVerdict::none) {
    const std::string beside = beside_none(d);
    out += "verdict: nothing is missing that these records could show" + (beside.empty() ? "" : "; but " + beside) + "\n";
  } else if (d.verdict == DiagnosisVerdict::unknown && !d.not_separable.empty()) {
    out += "verdict: something is missing, and these records cannot tell which: " +
           join(d.not_separable.front(), " or ") + "\n";
  } else if (const Finding* open = open_name(d); open != nullptr) {
    out += "verdict: something is missing; " + open->effect + " would explain it and is not claimed" + it_follows + "\n";
  } else if (d.verdict == DiagnosisVerdict::unknown) {
    out += "verdict: structure remains that no effect of the library explains" +
           (d.depends_on.empty() ? "" : "; it depends on " + join(d.depends_on, ", ")) +
           it_follows + "\n";
  } else {
    out += "verdict: something is missing\n";
  }
  for (const Finding& f : d.findings) {
    if (f.probability < 0.05) continue;
    out += fmt::format("  {} {:<20} {:<11} {}\n", f.claimed() ? "*" : " ", f.effect, shown_side(f),
                       f.in_model ? "in the model already" : "probability " + probability_text(f.probability));
    out += "      " + f.evidence + "\n";
    if (!f.claimed()) continue;
    for (const FoundParameter& p : f.parameters)
      out += fmt::format("      {} = {} {}\n", p.name, with_uncertainty(p.value, p.u),
                         p.unit == "1" ? "" : p.unit);
    out += look_alikes(f);
  }
  if (d.residual_unknown)
    out += "  besides, structure remains that depends on " + join(d.depends_on, ", ") +
           it_follows + "\n";
  out += fmt::format(
      "{}{}: {} -> {} {}{} (floor {} {}); with one gain, offset and decay for all of them {}{} {}\n",
      error_name(d.judged_by), d.levels ? ", one gain and offset for all" : "",
      number(d.error_before), number(d.error_after), unit.name, unclaimed_share(d), number(d.floor), unit.name,
      number(d.plain_before), std::isfinite(d.plain_after) ? " -> " + number(d.plain_after) : "", unit.name);
  if (const auto F = d.errors.find("F"); F != d.errors.end())
    out += fmt::format("reference against the rig's law: {} -> {} mN\n", plain_number(1e3 * F->second.before),
                       plain_number(1e3 * F->second.after));
  constexpr double kHardlyAny = 0.05;
  if (d.expected_false > kHardlyAny)
    out += fmt::format("with the signs of what is left turned over by chance, {:.2g} {} the threshold: what ranks without a claim may be a leftover\n",
                       d.expected_false, fmt::format("{:.2g}", d.expected_false) == "1" ? "effect passes" : "effects pass");
  if (!d.maps.empty() && d.maps.front().share > 0.02)
    out += fmt::format("where it fails most: {} ({:.0f} % of the residual's variance)\n",
                       d.maps.front().sentence, 100.0 * d.maps.front().share);
  if (!d.next_experiment.sentence.empty()) out += "measure next: " + d.next_experiment.sentence + "\n";
  // what hardly shows is no doubt of the verdict: the page and the JSON list it
  for (const RefusedEffect& r : refused_beside_findings(d)) out += "not taken: " + r.effect + ": " + std::string(diagnose::traits_of(r.reason).sentence) + "\n";
  return out;
}

}  // namespace forcegate
