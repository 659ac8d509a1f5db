#include "hil/app/gate/golden.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>

#include "hil/base/read_file.h"
#include "hil/base/text.h"

namespace forcegate {
namespace fs = std::filesystem;
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

JudgedCheck not_run(const GoldenTarget& target, const char* id, const std::string& title, std::string why,
                    bool required) {
  JudgedCheck j;
  j.judgeable = false;
  j.check.id = id;
  j.check.case_id = target.record_id;
  j.check.title = title;
  j.check.value = kNan;
  j.check.verdict = Verdict::not_run;
  j.check.blame = required ? Blame::user : Blame::none;
  j.check.required = required;
  j.check.evidence = std::move(why);
  return j;
}

std::string in_words(const std::string& algorithm) { return algorithm.empty() ? "none" : printable_utf8(algorithm); }

double stored_error(const GoldenRecord& golden, const std::string& name) {
  const auto at = golden.provenance.find(name);
  double value = kNan;
  if (at != golden.provenance.end())
    std::from_chars(at->second.data(), at->second.data() + at->second.size(), value);
  return value;
}

JudgedCheck compared(const GoldenTarget& target, const GoldenRecord& golden, GoldenCurve curve,
                     std::string& csv) {
  const bool rig = curve == GoldenCurve::ati;
  JudgedCheck j;
  Check& c = j.check;
  c.id = rig ? "rig_golden" : "golden_firmware";
  c.case_id = target.record_id;
  c.title = (rig ? target.truth : "Firmware") + " against its golden trace, deviation over tolerance";
  c.unit = "1";
  const auto when = golden.provenance.find("date");
  c.limit = {Limit::Kind::upper, 1.0,
             fmt::format("golden of {}", when == golden.provenance.end() ? "unknown date" : when->second)};
  const auto got = compare_golden(golden, target.content, curve);
  if (!got) return not_run(target, c.id.c_str(), c.title, got.error().text, true);
  for (const GoldenMargin& m : got->margins)
    csv += fmt::format("{},{},{:.3f},{:.4f},{:.4f},{:.4f}\n", rig ? "ati" : "firmware", m.where, m.t_s,
                       m.golden_N, m.tested_N, m.margin_N);
  c.n = got->n;
  c.value = got->state == TubeState::not_compared ? kNan : got->outside;
  c.evidence =
      got->cause.empty()
          ? fmt::format("{} extrema and samples, nearest to the edge of the tube {:.4f} N, lag {:+.1f} ms",
                        got->n, got->worst_margin_N, std::isfinite(got->lag_s) ? 1000.0 * got->lag_s : 0.0)
          : got->cause;
  if (!rig && got->state != TubeState::not_compared) return j;
  j.judgeable = false;
  c.verdict = got->state == TubeState::inside ? Verdict::pass
              : rig                           ? Verdict::rig_error
                                              : Verdict::inconclusive;
  c.blame = got->state == TubeState::inside ? Blame::none : rig ? Blame::rig : Blame::firmware;
  return j;
}

void hold_against(const GoldenRecord& golden, const GoldenTarget& target, std::vector<JudgedCheck>& list,
                  std::vector<std::string>& notes, std::string& csv) {
  if (golden.rig != target.rig) {
    list.push_back(not_run(target, "rig_golden", target.truth + " against its golden trace",
                           fmt::format("the golden is of rig {}, this is {}", golden.rig, target.rig),
                           false));
    return;
  }
  const auto another_profile = [&](const std::string& how) {
    list.push_back(not_run(target, "golden", "Golden trace",
                           "the golden of " + target.record_id + " is of another profile: " + how +
                               "; bless a run of this plan (forcegate bless RUN --reason ... --who ...), or play the plan that it was blessed with",
                           true));
  };
  const auto stimulus = golden.provenance.find("stimulus");
  if (stimulus != golden.provenance.end() && !target.stimulus.empty() && stimulus->second != target.stimulus)
    return another_profile(fmt::format("of {}, this is {}", stimulus->second, target.stimulus));
  if (target.with_truth) {
    JudgedCheck truth = compared(target, golden, GoldenCurve::ati, csv);
    if (truth.check.verdict == Verdict::rig_error && target.as_planned)
      return another_profile(truth.check.evidence + ", while the record follows its own set-point");
    list.push_back(std::move(truth));
  }
  const std::string why =
      golden.algorithm != target.algorithm
          ? fmt::format("the golden is of another algorithm ({}, the build declares {})", in_words(golden.algorithm), in_words(target.algorithm))
      : golden.seed != target.seed ? fmt::format("the golden is of another seed ({}, this record has {})", golden.seed, target.seed)
                                   : "";
  if (!why.empty()) {
    list.push_back(not_run(target, "golden_firmware", "Firmware against its golden trace", why, false));
    return;
  }
  list.push_back(compared(target, golden, GoldenCurve::firmware, csv));
  const double now = target.error, then = stored_error(golden, target.error_name);
  if (list.back().check.value > 1.0 && now < then)
    notes.push_back(fmt::format(
        "the golden of {} looks stale: the build leaves it and is nearer to the {} ({} {:.2f} instead of {:.2f}); if that is "
        "meant: forcegate bless RUN --reason ... --who ...",
        target.record_id, target.truth, target.error_name, now, then));
}

// A tube that holds next to anything guards nothing.
void remark_on_tolerance(const GoldenTarget& target, const char* curve, const TubeOptions& now, const TubeOptions& blessed, std::vector<std::string>& notes) {
  constexpr double kFar = 10.0, kLeast = 0.01;
  const std::tuple<const char*, double, double> fields[] = {{"absolute", now.absolute, blessed.absolute},
                                                            {"relative", now.relative, blessed.relative},
                                                            {"scale", now.scale, blessed.scale},
                                                            {"time_s", now.time_s, blessed.time_s},
                                                            {"lag_limit_s", now.lag_limit_s, blessed.lag_limit_s}};
  for (const auto& [name, wide, usual] : fields)
    if (!(wide <= kFar * std::max(usual, kLeast)))
      notes.push_back(fmt::format("the golden of {} holds next to nothing: tolerance {} {} {}, forcegate bless writes {}", target.record_id, curve, name, shortest(wide), shortest(usual)));
}

std::string file_name(const std::string& case_name, const std::string& specimen, const char* ending) {
  std::string name = case_name + "@" + specimen + ending;
  std::replace(name.begin(), name.end(), '/', '-');
  std::replace(name.begin(), name.end(), ':', '-');
  return name;
}

// Of one case: the record that `bless` makes its golden of.
const GoldenTarget& blessed_of(std::span<const GoldenTarget> of_case) {
  const auto at = std::ranges::find_if(of_case, &GoldenTarget::to_bless);
  return at == of_case.end() ? of_case.front() : *at;
}

}  // namespace

std::string golden_file_name(const std::string& case_name, const std::string& specimen) {
  return file_name(case_name, specimen, ".golden");
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

ChecksByRecord golden_checks(const std::vector<GoldenTarget>& targets,
                             const std::vector<GoldenRecord>& goldens, std::vector<std::string>& notes,
                             std::vector<GoldenMargins>* margins) {
  ChecksByRecord checks;
  for (std::size_t first = 0, end = 0; first < targets.size(); first = end) {
    const std::string& case_name = targets[first].case_name;
    bool any = false;
    for (end = first; end < targets.size() && targets[end].case_name == case_name; ++end) {
      const GoldenTarget& target = targets[end];
      const auto golden = std::find_if(goldens.begin(), goldens.end(), [&](const GoldenRecord& g) {
        return g.case_name == case_name && g.specimen == target.specimen;
      });
      if (golden == goldens.end()) continue;
      any = true;
      if (target.failed) continue;
      std::string csv;
      remark_on_tolerance(target, "ati", golden->ati, target.truth_tube, notes);
      remark_on_tolerance(target, "firmware", golden->firmware, target.firmware_tube, notes);
      hold_against(*golden, target, checks[target.place], notes, csv);
      if (margins != nullptr && !csv.empty())
        margins->push_back({file_name(case_name, target.specimen, ".csv"),
                            "curve,where,t_s,golden_N,tested_N,margin_N\n" + csv});
    }
    if (!any) {
      const GoldenTarget& lacks = blessed_of({targets.begin() + static_cast<std::ptrdiff_t>(first), targets.begin() + static_cast<std::ptrdiff_t>(end)});
      checks[lacks.place].push_back(not_run(lacks, "golden", "Golden trace",
                                            "there is no golden for " + case_name + ": bless a run (forcegate bless RUN --reason ... --who ...)", true));
    }
  }
  return checks;
}

}  // namespace forcegate
