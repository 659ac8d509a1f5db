// "html": one self-contained file. First the decision, then what to look at, then every case: failed first
// and open, passed collapsed.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/base/text.h"
#include "hil/interface/reporter.h"
#include "hil/report/case_figures.h"
#include "hil/report/figures/text.h"
#include "hil/report/html_checks.h"
#include "hil/report/html_page.h"

namespace forcegate {
namespace {

using figures::escape;

constexpr std::size_t kMostOpen = 12;
constexpr std::size_t kMostRows = 60;

std::string header(const RunResult& r) {
  const Decision& d = r.decision;
  const std::string colour(html_class(d.kind));
  std::string out = "<header class=\"" + colour + "\"><div><h1>" +
                    std::string(symbol(d.kind, Glyphs::unicode)) + " " + std::string(to_string(d.kind)) +
                    "</h1>\n<p class=\"why\">" + escape(d.reason) + "</p>\n<ul class=\"facts\">";
  const auto fact = [&](std::string_view name, const std::string& value) {
    if (!value.empty()) out += "<li>" + std::string(name) + " <b>" + value + "</b></li>";
  };
  if (d.kind != DecisionKind::accept) fact("to act", escape(who_must_act(d.blame)));
  if (d.safety_stop) fact("safety stop", "yes");
  fact("firmware", escape(r.firmware_path) + " " + escape(figures::shorten(r.firmware.build_id, 12)));
  fact("board", escape(r.firmware.board));
  fact("rig", escape(r.rig.name) + " " + escape(r.rig.version) + (r.rig.emulated ? " (emulated)" : ""));
  fact("plan", escape(r.plan_name));
  fact("calibration", calibration_levels(r));
  fact("seed", std::to_string(r.seed));
  fact("result", record_counts(r) + ", " + std::to_string(judged_rows(r).size()) + " checks");
  return out +
         "</ul><nav aria-label=\"Sections\"><a href=\"#look\">To look at</a><a href=\"#run\">Whole run</a>"
         "<a href=\"#cases\">Cases</a><a href=\"#reproduce\">Reproduce</a></nav></div></header>\n";
}

std::string table_of(const std::map<std::string, std::string>& values) {
  std::string out;
  for (const auto& [name, value] : values)
    out += "<dt>" + escape(name) + "</dt><dd>" + escape(value) + "</dd>";
  return out;
}

// A build that never came so far has not told everything.
std::string announced(const DutInfo& f) {
  std::string out = f.algorithm_id.empty() ? "not announced" : escape(f.algorithm_id);
  if (f.protocol_major > 0) out += ", protocol " + std::to_string(f.protocol_major) + "." + std::to_string(f.protocol_minor);
  if (f.adc_bits > 0) out += ", ADC " + std::to_string(f.adc_bits) + " bit";
  if (f.rate_Hz > 0.0) out += ", " + figures::display(f.rate_Hz) + " Hz";
  return out;
}

std::string reproduce(const RunResult& r) {
  std::string out =
      "<section id=\"reproduce\"><h2>Reproduce</h2>\n<pre tabindex=\"0\" aria-label=\"Command\"><code>" +
      escape(r.command_line) + "</code></pre>\n<dl>";
  const auto row = [&](std::string_view name, const std::string& value_html) {
    out += "<dt>" + std::string(name) + "</dt><dd>" + value_html + "</dd>";
  };
  const auto hash = [](const std::string& text) { return "<code>" + escape(text) + "</code>"; };
  row("Decision rule", escape(r.decision_rule));
  row("Firmware SHA-256", hash(r.firmware_sha256));
  row("Build id", hash(r.firmware.build_id));
  row("Algorithm", announced(r.firmware));
  row("Plan SHA-256", hash(r.plan_sha256));
  row("Seed", std::to_string(r.seed));
  row("Rig", escape(r.rig.name) + ", id " + escape(r.rig.id) + ", version " + escape(r.rig.version) + ", " +
                 figures::display(r.rig.rate_Hz) + " Hz, " + std::to_string(r.rig.adc_bits) + " bit over " +
                 figures::display(r.rig.v_range_V) + " V, up to " + figures::display(r.rig.force_max_N) +
                 " N");
  const auto reference = r.rig.details.find("reference");
  row(reference == r.rig.details.end() ? "ATI reference" : "Uncertainty of the " + reference->second,
      "resolution " + figures::display(r.rig.reference_resolution_N) + " N, noise " +
          figures::display(r.rig.reference_noise_N) + " N, relative u " +
          figures::display(r.rig.reference_u_rel));
  out += table_of(r.rig.details) + table_of(r.environment);
  row("Forcegate", escape(r.tool_version) + ", result format " + std::to_string(r.format));
  row("Started", escape(r.started_at));
  return out + "</dl></section>\n";
}

std::string whole_run(const RunResult& r) {
  std::vector<JudgedRow> rows;
  for (const Check& c : r.checks) rows.push_back({&c, nullptr, ratio_to_limit(c)});
  std::string out =
      "<section id=\"run\"><h2>Whole run</h2>\n" + html_check_table(rows, "Checks over all cases", false);
  const figures::Figure ratios = ratio_figure(r);
  if (!ratios.panels().empty())
    out += html_figure(ratios.svg(figures::Figure::Target::embedded), ratios.title,
                       "Left of the line is inside the limit. One mark a case. " + escape(ratios.summary));
  for (const std::string& note : r.notes) out += "<p>" + escape(note) + "</p>\n";
  return out + "</section>\n";
}

std::string look_at(const RunResult& r) {
  std::vector<JudgedRow> rows = rows_to_look_at(r);
  std::string out = "<section id=\"look\"><h2>To look at</h2>\n";
  if (rows.empty())
    return out +
           "<p>Nothing: every required check passed with its uncertainty inside the limit.</p></section>\n";
  const std::size_t all = rows.size();
  if (all > kMostRows) rows.resize(kMostRows);
  std::string caption = "Failed, undecided and marginal checks, worst first";
  if (all > kMostRows) caption += " (" + std::to_string(kMostRows) + " of " + std::to_string(all) + ")";
  return out + html_check_table(rows, caption, true) + "</section>\n";
}

std::string cases(const RunResult& r) {
  std::vector<std::size_t> order(r.cases.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto rank = [&](std::size_t i) {
    switch (case_verdict(r.cases[i])) {
      case Verdict::fail: return 0;
      case Verdict::rig_error: return 1;
      case Verdict::inconclusive: return 2;
      case Verdict::not_run: return 3;
      case Verdict::marginal: return 4;
      default: return 5;
    }
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  const auto reference = r.rig.details.find("reference");
  std::vector<std::string> verdicts;
  for (const std::size_t i : order)
    if (const std::string w(word(case_verdict(r.cases[i])));
        std::find(verdicts.begin(), verdicts.end(), w) == verdicts.end())
      verdicts.push_back(w);
  const double k = coverage_k(r);
  std::string out =
      "<section id=\"cases\"><h2>Cases</h2>\n<p class=\"q\">Failed cases come first and are open. Values are "
      "value(standard uncertainty in the last digits), k = 1; whiskers are U" +
      (std::isfinite(k) ? fmt::format(" with the k = {:.3g} of the decision rule", k) : std::string(" = 2 u")) + ". Error = later name minus earlier: firmware \u2212 " +
      (reference == r.rig.details.end() ? std::string("ATI, ATI \u2212 set-point") : reference->second) +
      ".</p>\n" + html_filter_row(verdicts);
  std::size_t opened = 0;
  for (const std::size_t i : order) {
    const bool open = rank(i) < 4 && opened++ < kMostOpen;
    out += html_case(r.cases[i], i + 1, open);
  }
  return out + "</section>\n";
}

std::string render(const RunResult& r) {
  HtmlPage page;
  page.title =
      std::string(to_string(r.decision.kind)) + " " + figures::shorten(printable_utf8(r.firmware_path), 60);
  page.with_filter = true;
  page.body = header(r) + "<main>\n" + look_at(r) + whole_run(r) + cases(r) + reproduce(r) +
              "<footer>Forcegate " + escape(r.tool_version) +
              ". Every number comes from the full record; curves are decimated for "
              "drawing, peaks kept.</footer></main>\n";
  return html_document(page);
}

const Registration<ReporterKind> kRegistered{
    {"html", "report.html", "one self-contained page with pictures, opens from disk without network",
     render}};

}  // namespace
}  // namespace forcegate
