#include "hil/diagnose/pictures.h"

#include <algorithm>

#include "hil/diagnose/claim_evidence.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kPoints = 700;

}  // namespace

void add_pictures(const Workspace& w, const Search& search, const std::vector<std::vector<double>>& after, Diagnosis& out) {
  for (std::size_t k = 0; k < w.output.rows.size(); ++k) {
    const RecordInput& r = w.input.records[w.output.record_of[k]];
    const auto& rows = w.output.rows[k].row;
    EvidenceSeries s;
    s.record = r.name;
    s.title = "measured (before) and modelled (after)";
    s.x_name = "time";
    s.x_unit = "s";
    s.y_unit = w.output.unit;
    const std::size_t stride = std::max<std::size_t>(1, rows.size() / kPoints);
    for (std::size_t j = 0; j < rows.size(); j += stride) {
      s.x.push_back(r.t_s[rows[j]]);
      s.before.push_back(r.U_V[rows[j]]);
      s.after.push_back(r.U_V[rows[j]] - after[k][j]);
    }
    out.overlays.push_back(std::move(s));
  }
  add_claim_evidence(w, w.output, search.output, {{"force", "time", "rate"}, "residual"}, out.findings);
  add_claim_evidence(w, w.rig, search.rig, {{"angle", "force", "time", "rate"}, "F_ref less the rig's law"}, out.findings);
  add_claim_evidence(w, w.command, search.drive, {{"command", "time", "rate"}, "force less the command"}, out.findings);
}

}  // namespace forcegate::diagnose
