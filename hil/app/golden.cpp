#include "hil/app/golden.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "hil/base/read_file.h"
#include "hil/gate/runner.h"
#include "hil/trace/extrema.h"

namespace forcegate {
namespace fs = std::filesystem;
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

JudgedCheck not_run(const CaseRecord& record, const char* id, const char* title, std::string why, bool required) {
  JudgedCheck j;
  j.judgeable = false;
  j.check.id = id;
  j.check.case_id = record.id;
  j.check.title = title;
  j.check.value = kNan;
  j.check.verdict = Verdict::not_run;
  j.check.blame = required ? Blame::user : Blame::none;
  j.check.required = required;
  j.check.evidence = std::move(why);
  return j;
}

double mre_maxima_pct(const CaseRecord& record, const PlanCase& planned) {
  std::vector<double> actual, expected;
  for (const CasePair& p : record.pairs)
    if (p.maximum && p.t_s >= judged_from_s(planned, record)) {
      actual.push_back(p.dut_N);
      expected.push_back(p.ati_N);
    }
  return 100.0 * mean_relative_error(actual, expected, 0.1).mean;
}

double stored_mre(const GoldenRecord& golden) {
  const auto at = golden.provenance.find("mre_maxima_pct");
  double value = kNan;
  if (at != golden.provenance.end())
    std::from_chars(at->second.data(), at->second.data() + at->second.size(), value);
  return value;
}

JudgedCheck compared(const CaseRecord& record, const GoldenRecord& golden, GoldenCurve curve, std::string& csv) {
  const bool rig = curve == GoldenCurve::ati;
  JudgedCheck j;
  Check& c = j.check;
  c.id = rig ? "rig_golden" : "golden_firmware";
  c.case_id = record.id;
  c.title = rig ? "ATI against its golden trace, deviation over tolerance"
                : "Firmware against its golden trace, deviation over tolerance";
  c.unit = "1";
  const auto when = golden.provenance.find("date");
  c.limit = {Limit::Kind::upper, 1.0,
             fmt::format("golden of {}", when == golden.provenance.end() ? "unknown date" : when->second)};
  const auto got = compare_golden(golden, golden_content(record), curve);
  if (!got) return not_run(record, c.id.c_str(), c.title.c_str(), got.error().text, true);
  for (const GoldenMargin& m : got->margins)
    csv += fmt::format("{},{},{:.3f},{:.4f},{:.4f},{:.4f}\n", rig ? "ati" : "firmware", m.where, m.t_s, m.golden_N,
                       m.tested_N, m.margin_N);
  c.n = got->n;
  c.value = got->state == TubeState::not_compared ? kNan : got->outside;
  c.evidence = got->cause.empty() ? fmt::format("{} extrema and samples, nearest to the edge of the tube {:.4f} N, lag {:+.1f} ms",
                                                got->n, got->worst_margin_N,
                                                std::isfinite(got->lag_s) ? 1000.0 * got->lag_s : 0.0)
                                  : got->cause;
  if (!rig && got->state != TubeState::not_compared) return j;
  j.judgeable = false;
  c.verdict = got->state == TubeState::inside ? Verdict::pass : rig ? Verdict::rig_error : Verdict::inconclusive;
  c.blame = got->state == TubeState::inside ? Blame::none : rig ? Blame::rig : Blame::firmware;
  return j;
}

void hold_against(const GoldenRecord& golden, const PlanCase& planned, const PlayedRecord& one,
                  std::vector<JudgedCheck>& list, std::vector<std::string>& notes, std::string& csv) {
  const CaseRecord& record = one.record;
  const std::string rig = record.rig.name + "/" + record.rig.version;
  if (golden.rig != rig) {
    list.push_back(not_run(record, "rig_golden", "ATI against its golden trace",
                           fmt::format("the golden is of rig {}, this is {}", golden.rig, rig), false));
    return;
  }
  if (planned.loop == LoopMode::open) list.push_back(compared(record, golden, GoldenCurve::ati, csv));
  const char* why = golden.algorithm != record.firmware.algorithm_id ? "the golden is of another algorithm"
                    : golden.seed != one.job.seed                    ? "the golden is of another seed"
                                                                     : nullptr;
  if (why != nullptr) {
    list.push_back(not_run(record, "golden_firmware", "Firmware against its golden trace", why, false));
    return;
  }
  list.push_back(compared(record, golden, GoldenCurve::firmware, csv));
  const double now = mre_maxima_pct(record, planned), then = stored_mre(golden);
  if (list.back().check.value > 1.0 && now < then)
    notes.push_back(fmt::format(
        "the golden of {} looks stale: the build leaves it and is nearer to the ATI (MRE of the maxima {:.2f} % instead "
        "of {:.2f} %); if that is meant: forcegate bless RUN --reason ... --who ...",
        record.id, now, then));
}

std::string file_name(const std::string& case_name, const std::string& specimen, const char* ending) {
  std::string name = case_name + "@" + specimen + ending;
  std::replace(name.begin(), name.end(), '/', '-');
  std::replace(name.begin(), name.end(), ':', '-');
  return name;
}

}  // namespace

std::string golden_file_name(const std::string& case_name, const std::string& specimen) {
  return file_name(case_name, specimen, ".golden");
}

GoldenContent golden_content(const CaseRecord& record) {
  GoldenContent content;
  for (const CasePair& p : record.pairs) content.extrema.push_back({p.maximum, p.t_s, p.ati_N, p.dut_N});
  for (const RecordWindow& w : record.waveform) content.windows.push_back({w.t0_s, w.step_s, w.ati_N, w.dut_N});
  return content;
}

Result<std::vector<GoldenRecord>> read_goldens(const fs::path& folder) {
  std::vector<fs::path> paths;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (entry.path().extension() == ".golden") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<GoldenRecord> goldens;
  for (const fs::path& path : paths) {
    FORCEGATE_TRY(const std::string text, read_file(path));
    FORCEGATE_TRY(goldens.emplace_back(), parse_golden_record(text, path.string()));
  }
  return goldens;
}

ChecksByRecord golden_checks(const RunMaterial& m, const std::vector<GoldenRecord>& goldens,
                             std::vector<std::string>& notes, std::vector<GoldenMargins>* margins) {
  ChecksByRecord checks;
  for (std::size_t c = 0; c < m.plan.cases.size(); ++c) {
    const PlanCase& planned = m.plan.cases[c];
    if (!(planned.checks & kCheckGolden)) continue;
    const PlayedRecord* first = nullptr;
    bool any = false;
    for (std::size_t k = 0; k < m.records.size(); ++k) {
      const PlayedRecord& one = m.records[k];
      if (one.case_index != c || one.superseded || one.job.session != 0) continue;
      if (first == nullptr) first = &one;
      const auto golden = std::find_if(goldens.begin(), goldens.end(), [&](const GoldenRecord& g) {
        return g.case_name == planned.name && g.specimen == one.job.specimen;
      });
      if (golden == goldens.end()) continue;
      any = true;
      if (one.record.failure) continue;  // a finding of its own
      std::string csv;
      hold_against(*golden, planned, one, checks[k], notes, csv);
      if (margins != nullptr && !csv.empty())
        margins->push_back({file_name(planned.name, one.job.specimen, ".csv"),
                            "curve,where,t_s,golden_N,tested_N,margin_N\n" + csv});
    }
    if (!any && first != nullptr)
      checks[static_cast<std::size_t>(first - m.records.data())].push_back(
          not_run(first->record, "golden", "Golden trace",
                  "there is no golden for " + planned.name + ": bless a run (forcegate bless)", true));
  }
  return checks;
}

}  // namespace forcegate
