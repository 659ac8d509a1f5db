#include "hil/report/capacitance/weight_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "hil/report/figures/text.h"
#include "hil/report/html_page.h"

namespace forcegate {
namespace {

using namespace characterize;
using figures::escape;

// Table I of the paper, N^2 and percent.
constexpr std::array<double, 8> kConductance{0.547, 0.258, 0.285, 1.06, 2.01, 0.527, 1.17, 0.839};
constexpr std::array<double, 8> kNetwork{0.330, 0.107, 0.156, 0.118, 0.374, 0.145, 0.515, 0.249};
constexpr std::array<double, 8> kReduction{39.7, 58.2, 44.9, 88.8, 81.4, 72.4, 55.9, 70.2};

constexpr std::string_view kEquations = R"(| equation | what it is | where in the code |
|---|---|---|
| (1), (2), (10) sources | -5 V, and a sine | `hil/interface/weight_bench.h` |
| (3), (4) R_s parallel C_s in an inverting amplifier | the circuit, with a finite bandwidth and rails | `rigs/emulated/dead_weight_bench.h` |
| (5) amplitude and phase | lock-in detection | `hil/model/impedance/lock_in.h` |
| (6), (7) C_s and R_s | with uncertainty, corrected for the amplifier | `hil/model/impedance/rc_reading.h` |
| (8) conductance by direct voltage | mean of the samples | `hil/model/impedance/rc_reading.h` |
| (9) phase over frequency | Bode fit, divergence, frequency to work at | `hil/model/impedance/bode_fit.h` |
| (11) percentage of error reduction | network against conductance | `hil/model/impedance/force_models.h` |
)";

std::string table_I(const WeightStudy& study, const WeightSummary& s) {
  std::string out =
      "| sensor | conductance, paper | conductance, ours | network, paper | network, ours | PER %, paper | PER %, ours |\n|---|---|---|---|---|---|---|\n";
  double g = 0, n = 0;
  for (std::size_t i = 0; i < 8; ++i) {
    const SensorResult& r = study.exemplar_set.sensors[i];
    g += r.mse_N2[0] / 8.0, n += r.mse_N2[3] / 8.0;
    out += fmt::format("| {} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.1f} | {:.1f} |\n", i + 1,
                       kConductance[i], r.mse_N2[0], kNetwork[i], r.mse_N2[3], kReduction[i], r.per_pct);
  }
  out += fmt::format("| mean | 0.837 | {:.3f} | 0.249 | {:.3f} | 64 | {:.1f} |\n", g, n,
                     study.exemplar_set.per_mean_pct());
  out += fmt::format("| **{} packs, mean** | | {:.3f} | | {:.3f} | | **{:.1f} ± {:.1f}** |\n",
                     study.sets.size(), s.mse_mean[0], s.mse_mean[3], s.per_mean_pct, s.per_sd_sets_pct);
  out += fmt::format(
      "| {} packs, 5 to 95 % of the sensors | | {:.3f} to {:.3f} | | {:.3f} to {:.3f} | | {:.1f} to {:.1f} |\n",
      study.sets.size(), s.mse_q05[0], s.mse_q95[0], s.mse_q05[3], s.mse_q95[3], s.per_sensor_q05,
      s.per_sensor_q95);
  return out;
}

std::string models_table(const WeightSummary& s) {
  std::string out =
      "| model | mean | 5 % | median | 95 % | on the way down, mean |\n|---|---|---|---|---|---|\n";
  for (std::size_t m = 0; m < kForceModels; ++m)
    out += fmt::format("| {} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.2f} |\n", kForceModelNames[m],
                       s.mse_mean[m], s.mse_q05[m], s.mse_median[m], s.mse_q95[m], s.unloading_mean[m]);
  return out;
}

std::string training_table(const WeightStudy& study, const WeightSummary& s) {
  std::string out = "| training loadings | network | two variables (ours) |\n|---|---|---|\n";
  for (std::size_t n = 0; n < s.per_network_pct.size(); ++n)
    out +=
        fmt::format("| {}{} | {:.1f} % | {} |\n", n + 1, n + 1 == study.plan.training ? " (the plan's)" : "",
                    s.per_network_pct[n], n == 0 ? "-" : fmt::format("{:.1f} %", s.per_ours_pct[n]));
  return out;
}

std::string claims_table(const std::vector<WeightClaim>& claims) {
  std::string out = "| where | quantity | the paper | ours | window | to know |\n|---|---|---|---|---|---|\n";
  for (const WeightClaim& c : claims)
    out += fmt::format("| {} | {} | {} | {} | {} | {} |\n", c.place, c.subject, c.paper, c.ours,
                       c.has_window ? (c.inside ? "inside: " : "**OUTSIDE**: ") + c.window : "-",
                       c.why.empty() ? "-" : c.why);
  return out;
}

}  // namespace

std::string weight_markdown(const WeightStudy& study, const WeightSummary& s,
                            const std::vector<PaperPicture>& pictures, const std::string& command,
                            const std::string& folder) {
  const WeightPlan& p = study.plan;
  std::string out = fmt::format(
      "# The second paper on our rig: resistance and capacitance\n\n"
      "L. Paredes-Madrid, L. Emmi, P. Gonzalez de Santos: Improving the performance of piezoresistive force sensors by modeling sensor "
      "capacitance. IEEE ISIE 2010, 458. This page is written by\n\n"
      "    {}\n\n"
      "It plays the paper's experiments on an emulated bench of dead weights: {} packs of eight A201-100, "
      "0 to {:.0f} N in steps of {:.0f} N, {} loadings of each pack, {:.0f} h of bench time, seed {}. Pack 0 comes on top: it gives "
      "the pictures and the sensor-by-sensor table and is in no statistic.\n\n"
      "A sensor is a conductance parallel to a capacitance, with curvature, slips, creep, hysteresis, "
      "and a band of relaxations above its divergence frequency (`rigs/emulated/rc_sensor.h` says which number comes from the paper and "
      "which is ours). No sensor is tuned: every pack is a fresh draw. Whoever estimates sees converter codes only.\n\n"
      "The conductance's errors are drawn from the spread of Table I. The capacitance's errors are not in the paper's text; "
      "their size is set from what it says of Fig. 10 (the mean of both models beats either in three of eight "
      "sensors), and curvature is given two fifths of each variance. The reduction by the network is not set anywhere: it comes out of training it.\n\n",
      command, study.sets.size(), p.force_max_N, p.step_N, p.most_training + p.testing + 2,
      study.bench_time_s / 3600.0, p.seed);
  out += "## Every figure of the text\n\n" + claims_table(claims_of(study, s));
  out += "\n## Table I\n\nMSE in N² on new loadings; the models learnt from " + std::to_string(p.training) +
         " loadings and were tested on " + std::to_string(p.testing) +
         ". Our sensors are those of pack 0, in no way matched to the paper's.\n\n" + table_I(study, s);
  out +=
      "\n## All models\n\nMSE in N², " + std::to_string(study.sets.size() * study.bench.sensors) +
      " sensors. \"Two variables\" is ours: one parabola of each variable, joined by the weights of their error covariance, "
      "with an uncertainty (`hil/model/impedance/two_variable.h`). The last column is a "
      "loading's way back, which the paper does not play: hysteresis and creep, which no model here has seen, then weigh more than what does not repeat.\n\n" +
      models_table(s);
  out +=
      "\n## How much training\n\nMean error reduction against the conductance model of the same training. "
      "The paper says only that the network was trained and then tested with new data. With one loading the network never sees "
      "what changes between loadings; with few it takes their accidents for a law.\n\n" +
      training_table(study, s);
  out += "\n## Equations\n\n" + std::string(kEquations);
  out += "\n## Figures, drawn from our rig\n\nSensor 3 of pack 0; Fig. 10 the whole pack.\n";
  for (const PaperPicture& picture : pictures)
    out += fmt::format("\n### {}\n\n![{}]({}/{})\n\n{}\n", picture.place, picture.figure.title, folder,
                       picture.file, picture.caption);
  return out;
}

std::string weight_sheet_html(const WeightStudy& study, const WeightSummary& s,
                              const std::vector<PaperPicture>& pictures, const std::string& command) {
  const auto cell = [](const std::string& text) {
    return "<td>" + figures::typographic_minus(escape(text)) + "</td>";
  };
  HtmlPage page;
  page.title = "Conductance and capacitance";
  page.body =
      "<header class=\"ok\"><div><h1>FlexiForce A201-100: conductance and capacitance</h1>\n<p class=\"why\">" +
      escape(fmt::format(
          "{} packs of eight, {:.0f} h of bench time; plan {}, seed {}. Error reduction {:.1f} % ± {:.1f}.",
          study.sets.size(), study.bench_time_s / 3600.0, study.plan.name, study.plan.seed, s.per_mean_pct,
          s.per_sd_sets_pct)) +
      "</p></div></header>\n<main>\n<section><h2>The paper and ours</h2><div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-label=\"The paper and ours\"><table><thead><tr><th scope=\"col\">Quantity</th>"
      "<th scope=\"col\">Paper</th><th scope=\"col\">Ours</th><th scope=\"col\">Window</th></tr></thead><tbody>\n";
  for (const WeightClaim& c : claims_of(study, s))
    page.body += "<tr><th scope=\"row\">" + escape(c.subject) + "</th>" + cell(c.paper) + cell(c.ours) +
                 cell(c.has_window ? (c.inside ? "inside: " : "OUTSIDE: ") + c.window : "-") + "</tr>\n";
  page.body +=
      "</tbody></table></div></section>\n<section><h2>Mean squared errors, N²</h2><div class=\"scroll\" tabindex=\"0\" role=\"group\" aria-label=\"Mean squared errors\"><table><thead><tr><th scope=\"col\">Model</th>"
      "<th scope=\"col\" class=\"n\">Mean</th><th scope=\"col\" class=\"n\">5 %</th><th scope=\"col\" class=\"n\">Median</th>"
      "<th scope=\"col\" class=\"n\">95 %</th></tr></thead><tbody>\n";
  for (std::size_t m = 0; m < kForceModels; ++m)
    page.body += fmt::format(
        "<tr><th scope=\"row\">{}</th><td class=\"n\">{:.3f}</td><td class=\"n\">{:.3f}</td><td class=\"n\">{:.3f}</td><td class=\"n\">{:.3f}</td></tr>\n",
        kForceModelNames[m], s.mse_mean[m], s.mse_q05[m], s.mse_median[m], s.mse_q95[m]);
  page.body += "</tbody></table></div></section>\n";
  for (const PaperPicture& p : pictures)
    page.body +=
        html_figure(p.figure.svg(figures::Figure::Target::embedded), p.figure.title,
                    "<b>" + escape(p.place) + "</b> " + figures::typographic_minus(escape(p.caption)));
  page.body += "<section><h2>Reproduce</h2><pre tabindex=\"0\" aria-label=\"Command\"><code>" +
               escape(command) + "</code></pre></section>\n</main>\n";
  return html_document(page);
}

}  // namespace forcegate
