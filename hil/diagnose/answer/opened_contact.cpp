#include "hil/diagnose/answer/opened_contact.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "hil/diagnose/workspace.h"
#include "hil/model/effect.h"

namespace forcegate::diagnose {

namespace {

constexpr double kSure = 0.9;  // of sixteen files without an angle or a command all were right

// What any course at low load is taken for.
bool is_of_any_course(const Finding& f) { return f.claimed() && (f.effect == "hysteresis" || f.effect == "static_nonlinearity"); }

bool claims_of_model(const Diagnosis& d) {
  return std::ranges::any_of(d.findings, [](const Finding& f) { return f.claimed() && !f.of_samples(); });
}

bool has_no_name(const Diagnosis& d) { return d.verdict == DiagnosisVerdict::unknown && !claims_of_model(d) && d.error_after > kFarAboveNoise * d.floor; }

bool is_silent(const Diagnosis& d) { return d.verdict == DiagnosisVerdict::none && !claims_of_model(d) && d.error_after < kToItsNoise * d.floor; }

// Of the law alone, mains and bad samples set aside: these stand in the open rows as elsewhere.
double left_by_law(const Diagnosis& d) { return d.steps.empty() ? d.error_before : d.steps.front().error; }

bool doubt(const Diagnosis& while_closed, Diagnosis& out) {
  bool doubted = false;
  for (Finding& f : out.findings) {
    const bool stays = std::ranges::any_of(while_closed.findings, [&](const Finding& other) { return other.effect == f.effect && other.claimed(); });
    if (is_of_any_course(f) && !stays) doubted |= f.limit(kNoClaim, "it is not seen without the rows in which the contact is open or was just made");
  }
  return doubted;
}

}  // namespace

bool asks_for_closed_contact(const Diagnosis& answer) { return std::ranges::any_of(answer.findings, is_of_any_course) || has_no_name(answer); }

void judge_by_closed_contact(const OpenContact& open, const Diagnosis& while_closed, Diagnosis& out) {
  constexpr double kOfContact = 0.75, kPlainly = 0.6;  // of what the law leaves, without these rows: more, and it is not of the contact
  const EffectKind* kind = EffectRegistry::instance().find("contact_loss");
  const double left = left_by_law(while_closed) / left_by_law(out);
  if (kind == nullptr || !(left < kOfContact)) return;
  const bool plainly = left < kPlainly, nameless = plainly && has_no_name(out) && is_silent(while_closed);
  if (!doubt(while_closed, out) && !nameless) return;
  const bool sure = plainly && !claims_of_model(while_closed);
  Finding contact = finding_about(*kind, out.unit);
  contact.form = "without_witness";
  contact.probability = sure ? kSure : kNoClaim;
  contact.name_is_open = !sure;
  contact.evidence = fmt::format("the force came to rest at its lowest {} times, for {:.2g} % of the recording, and the output goes its own way while it rests and just after: "
                                 "the contact opens{}",
                                 open.times, 100.0 * open.share,
                                 sure ? ", and without these rows no effect is left to be named; an angle or a command would show whether the drive goes on meanwhile"
                                      : ", it seems; not claimed: no angle or command says that the drive went on");
  std::erase_if(out.findings, [&](const Finding& f) { return f.effect == contact.effect; });
  out.findings.insert(std::ranges::find_if(out.findings, [](const Finding& f) { return !f.claimed(); }), std::move(contact));
  const bool claims = std::ranges::any_of(out.findings, [](const Finding& f) { return f.claimed(); });
  out.verdict = claims ? DiagnosisVerdict::known : DiagnosisVerdict::unknown;
  if (sure) {
    out.residual_unknown = false;
    out.depends_on.clear();
    out.follows.clear();
  } else if (!claims) {
    out.residual_unknown = false;
    if (out.depends_on.empty()) out.depends_on = {"force"};
  }
}

}  // namespace forcegate::diagnose
