#include "hil/diagnose/pictures.h"

#include <algorithm>
#include <cmath>

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kPoints = 700;

EvidenceSeries series(const Workspace& w, std::size_t k, const std::string& x_name,
                      const std::vector<std::vector<double>>& before,
                      const std::vector<std::vector<double>>& after) {
  const RecordInput& r = w.input.records[w.output.record_of[k]];
  const auto& rows = w.output.rows[k].row;
  EvidenceSeries s;
  s.record = r.name;
  s.x_name = x_name;
  s.y_unit = w.output.unit;
  s.x_unit = x_name == "force" ? "N" : x_name == "rate" ? "N/s" : "s";
  s.title = "residual against " + x_name + ", coloured by direction";
  const std::size_t stride = std::max<std::size_t>(1, rows.size() / kPoints);
  for (std::size_t j = 0; j < rows.size(); j += stride) {
    const std::size_t i = rows[j];
    s.x.push_back(x_name == "force" ? r.F_N[i] : x_name == "rate" ? r.rate_N_per_s[i] : r.t_s[i]);
    s.before.push_back(before[k][j]);
    s.after.push_back(after[k][j]);
    s.colour.push_back(r.rate_N_per_s[i] > 0.0 ? 1.0 : r.rate_N_per_s[i] < 0.0 ? -1.0 : 0.0);
  }
  return s;
}

}  // namespace

void add_pictures(const Workspace& w, const Selection& selection,
                  const std::vector<std::vector<double>>& before,
                  const std::vector<std::vector<double>>& after, Diagnosis& out) {
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
  if (selection.chosen.empty()) return;
  // the held-out record that gains most, and the record that gains most of all
  std::size_t best = 0, best_heldout = 0;
  double gain = -1.0, gain_heldout = -1.0;
  for (std::size_t k = 0; k < before.size(); ++k) {
    const double g = selection.base.adapted[k] - selection.final.adapted[k];
    if (g > gain) {
      gain = g;
      best = k;
    }
    if (w.output.problem.records[k].heldout && g > gain_heldout) {
      gain_heldout = g;
      best_heldout = k;
    }
  }
  for (Finding& f : out.findings) {
    if (f.effect != selection.chosen.front().kind->name) continue;
    for (const char* x : {"force", "time", "rate"}) f.series.push_back(series(w, best, x, before, after));
    if (gain_heldout > 0.0 && best_heldout != best)
      f.series.push_back(series(w, best_heldout, "force", before, after));
  }
}

}  // namespace forcegate::diagnose
