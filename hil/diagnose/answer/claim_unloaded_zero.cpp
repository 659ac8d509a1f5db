#include "hil/diagnose/answer/claim_unloaded_zero.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/base/plain_number.h"
#include "hil/diagnose/answer/findings.h"
#include "hil/diagnose/between/unloaded_zero.h"

namespace forcegate::diagnose {

void claim_unloaded_zero(const Workspace& w, const MixedFit& fit, Diagnosis& out) {
  constexpr double kSure = 0.9;
  const EffectKind* kind = EffectRegistry::instance().find("reference_drift");
  const auto claims_it = [](const Finding& f) { return f.claimed() && (f.effect == "reference_drift" || (f.between_records && f.side != "sensor")); };
  if (kind == nullptr || std::ranges::any_of(out.findings, claims_it)) return;
  const std::optional<UnloadedZero> found = unloaded_zero_of_reference(w, fit);
  if (!found) return;
  Finding drift = finding_about(*kind, w.output);
  drift.form = kUnloadedZero;
  drift.between_records = !w.input.single;
  drift.probability = kSure;
  drift.parameters.push_back({"zero_sd_N", found->spread_N, found->spread_N / std::sqrt(2.0 * static_cast<double>(found->records) - 2.0), "N"});
  drift.evidence = fmt::format("{} of {} {} come down to one and the same output, that of no load, and the reference shows there forces that differ by {} N (standard "
                               "deviation), as their zeros do: it is its own zero that moves, the sensor's would move the output",
                               found->records, found->of, w.input.single ? "stretches of the recording" : "records", plain_number(found->spread_N));
  EvidenceSeries zeros;
  zeros.title = "what the reference shows without load";
  zeros.x_name = w.input.single ? "time" : "record";
  zeros.x_unit = w.input.single ? "s" : "";
  zeros.y_unit = "N";
  zeros.x = found->at;
  zeros.before = found->shown_N;
  zeros.after = found->left_N;
  drift.series.push_back(std::move(zeros));
  std::erase_if(out.findings, [&](const Finding& f) { return f.effect == drift.effect; });
  out.findings.insert(std::ranges::find_if(out.findings, [](const Finding& f) { return !f.claimed(); }), std::move(drift));
  if (out.verdict == DiagnosisVerdict::known) return;
  // what made the answer unknown stands within the records, which a zero of each does not explain
  out.residual_unknown = out.residual_unknown || out.verdict == DiagnosisVerdict::unknown;
  out.verdict = DiagnosisVerdict::known;
}

}  // namespace forcegate::diagnose
