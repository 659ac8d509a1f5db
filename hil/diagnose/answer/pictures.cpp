#include "hil/diagnose/answer/pictures.h"

#include "hil/base/parallel.h"
#include "hil/diagnose/answer/claim_evidence.h"
#include "hil/diagnose/answer/record_course.h"

namespace forcegate::diagnose {

void add_pictures(const Workspace& w, const Search& search, const MixedFit& shown, unsigned threads, Diagnosis& out) {
  std::vector<std::vector<EvidenceSeries>> courses(w.output.rows.size());
  parallel_for(courses.size(), threads, [&](std::size_t k) { courses[k] = record_course(w, shown, k); });
  for (std::vector<EvidenceSeries>& course : courses)
    for (EvidenceSeries& s : course) out.overlays.push_back(std::move(s));
  add_claim_evidence(w, w.output, search.output, {{"force", "time", "rate"}, "residual"}, out.findings);
  add_claim_evidence(w, w.rig, search.rig, {{"angle", "force", "time", "rate"}, "F_ref less the rig's law"}, out.findings);
  add_claim_evidence(w, w.command, search.drive, {{"command", "time", "rate"}, "force less the command"}, out.findings);
}

}  // namespace forcegate::diagnose
