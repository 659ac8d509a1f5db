#include "hil/gate/judge_conformance.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "hil/base/text.h"
#include "hil/interface/comparator.h"

namespace forcegate {
namespace {

// A slip in an id that is known; "" for one that is another algorithm's.
std::string meant_algorithm(const std::string& id) {
  std::vector<std::string> known;
  for (const ComparatorKind& kind : Registry<ComparatorKind>::instance().all()) known.insert(known.end(), kind.algorithms.begin(), kind.algorithms.end());
  return nearest_name(id, known);
}

// What the plan asks for by name is owed. An algorithm of its own is let off only where the plan judges its values, and the
// decision says so: a slip in the id, or none, switches nothing off.
void without_oracle(const Plan& plan, const PlanCase& planned, const std::string& id, CaseChecks& checks) {
  const auto values = [](const PlanCase& c) { return (c.checks & (kCheckAccuracy | kCheckPromise)) != 0; };
  const bool judged = values(planned) || std::any_of(plan.cases.begin(), plan.cases.end(), values);
  const std::string meant = id.find('+') == std::string::npos ? meant_algorithm(id) : std::string();  // "KNOWN+NAME" extends one
  Check& c = checks.final_check("conformance", "Conformance with the declared algorithm", Verdict::not_run, Blame::user,
                                fmt::format("no independent implementation of '{}' is known", id));
  if (!id.empty() && meant.empty() && judged) {
    c.required = false;
    c.blame = Blame::none;
    c.evidence += ", its values alone are judged";
  } else if (id.empty() || !meant.empty()) {
    c.blame = Blame::firmware;
    c.evidence += meant.empty() ? ": the image announces no algorithm" : "; is '" + meant + "' meant?";
  } else {
    c.evidence += ", and no case of the plan judges values: add the check 'accuracy', or sign a waiver (--waivers)";
  }
}

}  // namespace

void judge_conformance(const Plan& plan, const PlanCase& planned, const CaseRecord& record, bool link_sound, CaseChecks& checks) {
  if (!(planned.checks & kCheckConformance)) return;
  if (!record.conformance_known) return without_oracle(plan, planned, record.firmware.algorithm_id, checks);
  checks.value_check("conformance", "Conformance with the declared algorithm", record.conformance,
                     record.conformance_unit, 0.0, record.conformance_n,
                     {Limit::Kind::upper, record.conformance_limit, record.conformance_source},
                     record.conformance_evidence);
  // Arithmetic does not depend on the rig: on a sound link the same codes went to both.
  JudgedCheck& j = checks.list.back();
  if (link_sound && std::isfinite(record.conformance) && !j.judgeable && record.conformance > record.conformance_limit) {
    j.judgeable = true;
    j.check.blame = Blame::firmware;
  }
}

}  // namespace forcegate
