#include "hil/report/characterization/paper_page.h"

#include <fmt/format.h>

#include <cmath>

#include "hil/report/characterization/paper_claims.h"
#include "hil/report/characterization/paper_tables.h"

namespace forcegate {
namespace {

using characterize::SensorStudy;
using characterize::SessionSheet;

constexpr std::string_view kEquations =
    R"(| equation | what it is | where in the code | what this study does with it |
|---|---|---|---|
| (1) F = G U + F0 | static law | `hil/characterize/procedures/static_calibration.cpp`, `hil/gate/calibrate.cpp` | two sweeps per session, least squares |
| (2) F = A sin(2 pi f t) + m | sine load | `stimuli/sine.cpp` | Table II and the validation sines |
| (3) Umax = Umin + a e^(-bt) + c | decay of the maxima | `hil/trace/decay_fit.h` | fitted to every dynamic record |
| (4) Umin = (m - A - F0)/G | minima | `hil/characterize/laws.cpp` | with G, F0 of the session, in the model of the maxima |
| (5) a(A), b(f), c/a(A) | parameter-variation laws | `hil/characterize/laws.h` | refitted, see below |
| (6) sum of two sines | load | `stimuli/multisine.cpp` | Table III |
| (7) compensation | force from voltage | `docs/algorithm.md`, `golden/compare/lebosse_oracle.h` | force control |
| (8) RMSE, (9) MRE | errors | `hil/trace/extrema.h` | everywhere |
)";

std::string value_text(double value, const std::string& unit) {
  return short_number(value) + (unit.empty() || unit == "1" || !std::isfinite(value) ? "" : " " + unit);
}

std::string claims_table(const std::vector<PaperClaim>& claims) {
  std::string out =
      "| where | sensor | quantity | the paper | ours, mean ± sd of specimens | n | ratio | rig window | to know |\n|---|---|---|---|---|---|---|---|---|\n";
  for (const PaperClaim& c : claims) {
    const bool ratio = std::isfinite(c.paper_value) && c.paper_value != 0.0 && std::isfinite(c.ours);
    std::string window = "-";
    if ((c.low || c.high) && std::isfinite(c.ours))
      window = std::string(c.inside() ? "inside " : "**OUTSIDE** ") + (c.low ? short_number(*c.low) : "") +
               " .. " + (c.high ? short_number(*c.high) : "");
    out += fmt::format("| {} | {} | {} | {} | {}{} | {} | {} | {} | {} |\n", c.place,
                       c.sensor == "fsr" ? "FSR" : "FlexiForce", c.subject, c.paper.empty() ? "-" : c.paper,
                       value_text(c.ours, c.unit),
                       std::isfinite(c.spread) ? " ± " + short_number(c.spread, 2) : "", c.specimens,
                       ratio ? fmt::format("{:.2f}", c.ours / c.paper_value) : "-", window,
                       c.why.empty() ? "-" : c.why);
  }
  return out;
}

std::string head(const std::vector<SensorStudy>& studies, const characterize::StudyPlan& plan,
                 const std::string& command) {
  double hours = 0.0;
  std::size_t sessions = 0, failed = 0;
  for (const SensorStudy& s : studies) {
    hours += s.rig_time_s / 3600.0;
    sessions += s.sheets.size();
    for (const SessionSheet& sheet : s.sheets) failed += sheet.failure ? 1u : 0u;
  }
  std::string out = fmt::format(
      "# The paper on our rig\n\n"
      "C. Lebossé, P. Renaud, B. Bayle, M. de Mathelin: Modeling and Evaluation of Low-Cost Force Sensors. IEEE Trans. Robotics 27 (2011) 815. This page is written by\n\n"
      "    {}\n\n"
      "It plays the paper's own procedures on the emulated rig: {} specimen(s) in {} session(s) each, {} sessions in all, {:.0f} h of bench time, seed {}. ",
      command, plan.specimens.size(), plan.sessions, sessions, hours, plan.seed);
  out += failed == 0 ? "No session failed.\n"
                     : fmt::format("{} sessions failed and are in no statistic.\n", failed);
  out +=
      "\nThe specimens are drawn from the spreads that the paper states (`rigs/emulated/population.h`); nothing is tuned for a test. The film has no clock and is told no "
      "frequency: its decay is a state that the force drives (`rigs/emulated/loading_memory.h`). Means are over sessions, then specimens; ± is the standard deviation between "
      "specimens. Where the paper gives no number, or our copy lost it (Table I), ours stands alone.\n";
  return out;
}

}  // namespace

std::string paper_markdown(const std::vector<SensorStudy>& studies, const characterize::StudyPlan& plan,
                           const std::vector<PaperPicture>& pictures, const std::string& command,
                           const std::string& folder) {
  const SensorStudy* flexi = study_of(studies, "flexiforce");
  std::string out = head(studies, plan, command);
  out += "\n## Every figure of the text\n\n" + claims_table(compare_with_paper(studies));
  out +=
      "\n\"Rig window\" is the range in which the emulated rig must stay to count as a reproduction; a value outside of it is said, not hidden.\n";
  out += "\n## Equations\n\n" + std::string(kEquations);
  if (flexi != nullptr && flexi->find("harmonic.loss") != nullptr) {
    out +=
        "\n## Table II\n\nMean ± standard deviation over all sessions. a and c in volts differ by the clash stated under the laws; "
        "b and c/a are what compares. The rig's maxima scatter less about the exponential than the paper's (RMSE): "
        "its noise is that of amplifier and converter, and the film repeats itself from cycle to cycle.\n\n" +
        table_II_markdown(*flexi, plan);
    out += "\n## The laws (5)\n\n" + laws_markdown(flexi->laws);
    if (const std::string table = table_III_markdown(*flexi); !table.empty())
      out +=
          "\n## Table III\n\nErrors of the laws on sums of two sines (amplitudes ours: the paper does not print them).\n\n" +
          table;
  }
  out += "\n## The printed Table II on its own\n\n" + printed_table_markdown();
  if (flexi != nullptr && flexi->find("control.identified_maxima") != nullptr) {
    out +=
        "\n## Where the paper's specimen lies\n\nForce control, 1.1 to 3.2 N at 0.5 Hz, 20 min, compensation by eq. (7). "
        "The paper's one specimen had 4.5 % (maxima) and 7.5 % (minima).\n\n" +
        levels_markdown(*flexi);
    const auto stopped = flexi->share_where("control.raw_stopped", [](double v) { return v > 50.0; });
    const auto window =
        flexi->share_where("control.raw_stop", [](double v) { return v >= 100.0 && v <= 320.0; });
    if (stopped.n > 0)
      out += fmt::format(
          "\nWithout compensation the wheel comes to its stop in {:.0f} of {} sessions, in {:.0f} ({:.0f} %) between 100 and 320 s.\n",
          stopped.share * static_cast<double>(stopped.n), stopped.n,
          window.share * static_cast<double>(window.n), 100.0 * window.share);
  }
  if (!pictures.empty())
    out += "\n## Figures, drawn from our rig\n\nThe exemplar specimen " + plan.exemplar +
           "; it is in no statistic.\n";
  for (const PaperPicture& p : pictures)
    out +=
        fmt::format("\n### {}\n\n![{}]({}/{})\n\n{}\n", p.place, p.figure.title, folder, p.file, p.caption);
  return out;
}

}  // namespace forcegate
