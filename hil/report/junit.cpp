// "junit": one suite a case, one test a check. fail -> failure, rig_error and inconclusive -> error, so is marginal where the
// rule does not accept it; not_run and waived -> skipped; a check that is not required never turns a suite red. The decision itself is the
// first test.

#include <cmath>

#include "hil/base/text.h"
#include "hil/interface/reporter.h"
#include "hil/report/figures/text.h"
#include "hil/report/judged.h"

namespace forcegate {
namespace {

using figures::escape;

struct Counts {
  int tests = 0, failures = 0, errors = 0, skipped = 0;
};

std::string property(std::string_view name, std::string_view value) {
  return "        <property name=\"" + std::string(name) + "\" value=\"" + escape(value) + "\"/>\n";
}

std::string test_of(const Check& c, const std::string& class_name, bool marginal_passes, Counts& counts) {
  ++counts.tests;
  std::string out = "    <testcase classname=\"" + escape(class_name) + "\" name=\"" + escape(c.id) + "\">\n";
  out += "      <properties>\n";
  out += property("title", c.title) + property("verdict", to_string(c.verdict));
  if (std::isfinite(c.value)) out += property("value", shortest(c.value)) + property("unit", c.unit);
  if (std::isfinite(c.u)) out += property("u", shortest(c.u));
  out += property("n", std::to_string(c.n));
  if (c.limit.kind != Limit::Kind::none)
    out += property("limit", limit_text(c, Glyphs::ascii)) + property("limit_source", c.limit.source);
  out += property("required", c.required ? "true" : "false");
  out += "      </properties>\n";
  const std::string message = value_text(c, Glyphs::ascii) + ", limit " + limit_text(c, Glyphs::ascii);
  const auto outcome = [&](const char* element, const std::string& type) {
    out += std::string("      <") + element + " message=\"" + escape(message) + "\"";
    if (element != std::string_view("skipped"))
      out += " type=\"" + escape(type) + "\">" + escape(c.evidence) + "</" + element + ">\n";
    else
      out += "/>\n";
  };
  if (c.verdict == Verdict::not_run || c.verdict == Verdict::waived ||
      (!c.required && c.verdict != Verdict::pass && c.verdict != Verdict::marginal)) {
    ++counts.skipped;
    outcome("skipped", "");
  } else if (c.verdict == Verdict::fail) {
    ++counts.failures;
    outcome("failure", "fail");
  } else if (c.verdict == Verdict::rig_error || c.verdict == Verdict::inconclusive || (c.verdict == Verdict::marginal && c.required && !marginal_passes)) {
    ++counts.errors;
    outcome("error", std::string(to_string(c.verdict)));
  }
  return out + "    </testcase>\n";
}

std::string suite(const std::string& name, double time_s, const std::string& tests, const Counts& c) {
  return "  <testsuite name=\"" + escape(name) + "\" tests=\"" + std::to_string(c.tests) + "\" failures=\"" +
         std::to_string(c.failures) + "\" errors=\"" + std::to_string(c.errors) + "\" skipped=\"" +
         std::to_string(c.skipped) + "\" time=\"" + figures::coordinate(time_s, 3) + "\">\n" + tests +
         "  </testsuite>\n";
}

std::string decision_test(const RunResult& result, Counts& counts) {
  ++counts.tests;
  const Decision& d = result.decision;
  std::string out = "    <testcase classname=\"forcegate\" name=\"decision\">\n      <properties>\n";
  out += property("decision", to_string(d.kind)) + property("blame", to_string(d.blame)) +
         property("firmware_sha256", result.firmware_sha256) + property("plan_sha256", result.plan_sha256) +
         property("seed", std::to_string(result.seed)) + property("reproduce", result.command_line) +
         "      </properties>\n";
  if (d.kind != DecisionKind::accept) {
    const bool reject = d.kind == DecisionKind::reject;
    ++(reject ? counts.failures : counts.errors);
    const std::string element = reject ? "failure" : "error";
    out += "      <" + element + " message=\"" + escape(d.reason) + "\" type=\"" +
           std::string(to_string(d.kind)) + "\"/>\n";
  }
  return out + "    </testcase>\n";
}

std::string render(const RunResult& result) {
  Counts all;
  std::string suites;
  const auto add = [&](const std::string& name, double time_s, const std::string& tests,
                       const Counts& counts) {
    suites += suite(name, time_s, tests, counts);
    all.tests += counts.tests;
    all.failures += counts.failures;
    all.errors += counts.errors;
    all.skipped += counts.skipped;
  };
  Counts counts;
  std::string tests = decision_test(result, counts);
  for (const Check& c : result.checks) tests += test_of(c, "whole run", accepts_marginal(result), counts);
  add("whole run", 0.0, tests, counts);
  for (const CaseResult& r : result.cases) {
    Counts of_case;
    std::string of_case_tests;
    for (const Check& c : r.checks) of_case_tests += test_of(c, r.id, accepts_marginal(result), of_case);
    add(r.id, r.duration_s, of_case_tests, of_case);
  }
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"forcegate " +
         escape(result.plan_name) + "\" tests=\"" + std::to_string(all.tests) + "\" failures=\"" +
         std::to_string(all.failures) + "\" errors=\"" + std::to_string(all.errors) + "\" skipped=\"" +
         std::to_string(all.skipped) + "\">\n" + suites + "</testsuites>\n";
}

const Registration<ReporterKind> kRegistered{
    {"junit", "junit.xml", "one test a check, for the test views of CI servers", render}};

}  // namespace
}  // namespace forcegate
