#include "hil/report/added_html.h"

#include <cmath>

#include "hil/base/text.h"
#include "hil/report/diagnosis_figures.h"
#include "hil/report/diagnosis_parts.h"
#include "hil/report/figures/text.h"

namespace forcegate {
namespace {

using namespace parts;
using figures::display;
using figures::escape;

std::string parameters(const AddedEffect& added) {
  std::string out = table_start("Parameters, all refitted together", {"Parameter", "#Before", "#After", "Unit"});
  for (const AddedEffect::Parameter& p : added.parameters)
    out += "<tr>" + cell(escape(p.name)) + cell(std::isfinite(p.before) ? figures::typographic_minus(display(p.before, 5)) : "new", true) +
           cell(escape(figures::typographic_minus(with_uncertainty(p.after, p.u))), true) + cell(escape(p.unit == "1" ? "" : p.unit)) + "</tr>\n";
  return out + std::string(kTableEnd);
}

std::string section(const Diagnosis& view, const AddedEffect& added, const RecordPictures& pictures) {
  std::string out = "<section id=\"added\"><h2>What it does</h2>\n";
  out += picture(figures::waterfall(error_title(view.judged_by) + " over the model's effects", "base law", added.steps, "now", added.unit,
                                    added.floor > 0.0 ? added.floor : NAN, "does not lower the error in every order of adding"));
  if (!view.findings.empty()) {
    if (view.findings.front().between_records) out += between_records(pictures);
    out += evidence(view.findings.front(), view.judged_by);
  }
  return out + parameters(added) + "</section>\n";
}

}  // namespace

std::string added_html(const Diagnosis& view, const AddedEffect& added, DiagnosisPage page) {
  const bool falls = added.is_needed;
  page.lead = PageLead{
      .headline = falls ? added.effect + " added to the model of " + view.campaign : added.effect + (added.helps_one_law ? " lowers the error of one law for all records alone in " : " is not needed for ") + view.campaign,
      .why = error_title(view.judged_by) + " " + in_unit(added.error_before, added.unit) + (falls ? " falls to " : " does not fall: ") +
             in_unit(added.error_after, added.unit),
      .colour = falls ? "ok" : "wa",
      .id = "added",
      .name = "What it does",
      .section = section(view, added, page.pictures)};
  return diagnosis_html(view, page);
}

}  // namespace forcegate
