#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/interface/reporter.h"
#include "hil/report/case_figures.h"
#include "hil/report/figures/bullet.h"
#include "hil/report/html_page.h"
#include "tests/support/sample_run.h"

namespace forcegate {
namespace {

using sample::Variant;
using testing::HasSubstr;
using testing::Not;

std::string html(const RunResult& result) {
  return Registry<ReporterKind>::instance().find("html")->render(result);
}

std::string between(const std::string& text, const std::string& open, const std::string& close) {
  const std::size_t at = text.find(open);
  if (at == std::string::npos) return "";
  return text.substr(at + open.size(), text.find(close, at + open.size()) - at - open.size());
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

/// Every element that is opened is closed in order; void elements and self-closed ones aside. "" when
/// balanced.
std::string first_unbalanced(const std::string& page) {
  std::vector<std::string> open;
  std::size_t at = page.find("<body>");
  while ((at = page.find('<', at)) != std::string::npos) {
    bool quoted = false;
    std::size_t end = at + 1;
    for (; end < page.size() && (quoted || page[end] != '>'); ++end) quoted ^= page[end] == '"';
    const bool closing = page[at + 1] == '/', closed = page[end - 1] == '/';
    const std::size_t start = at + (closing ? 2 : 1);
    const std::string name = page.substr(start, page.find_first_of(" />", start) - start);
    at = end;
    if (closed || name == "br" || name == "input" || name == "meta") continue;
    if (!closing) {
      open.push_back(name);
      if (name == "script") break;  // the last element; its text is not markup
    } else {
      if (open.empty() || open.back() != name)
        return name + " after " + (open.empty() ? "nothing" : open.back());
      open.pop_back();
    }
  }
  return open == std::vector<std::string>{"body", "script"} ? "" : "not all closed";
}

TEST(Html, hash_is_the_base64_of_the_sha256) {
  EXPECT_EQ(csp_hash("abc"), "sha256-ungWv48Bz+pBQUDeXa4iI7ADYaOWF3qctBD/YfIAFa0=");
}

TEST(Html, policy_allows_only_its_own_style_and_script) {
  const std::string page = html(sample::run(Variant::accept, 60.0));
  const std::string policy = between(page, "Content-Security-Policy\" content=\"", "\"");
  EXPECT_THAT(policy, HasSubstr("default-src 'none'"));
  EXPECT_THAT(policy, HasSubstr("style-src '" + csp_hash(between(page, "<style>", "</style>")) + "'"));
  EXPECT_THAT(policy, HasSubstr("script-src '" + csp_hash(between(page, "<script>", "</script>")) + "'"));
  EXPECT_THAT(policy, Not(HasSubstr("unsafe")));
}

TEST(Html, is_one_file_that_asks_for_nothing) {
  const std::string page = html(sample::run(Variant::reject, 60.0));
  for (const char* what :
       {"http://", "https://", "<iframe", "<link", "src=", "@import", "url(", " style=", " onclick"})
    EXPECT_THAT(page, Not(HasSubstr(what))) << what;
}

TEST(Html, says_the_decision_and_the_reason_first) {
  for (const Variant v : {Variant::accept, Variant::reject, Variant::no_decision, Variant::rig_fault}) {
    const RunResult r = sample::run(v, 60.0);
    const std::string page = html(r);
    EXPECT_THAT(between(page, "<h1>", "</h1>"), HasSubstr(std::string(to_string(r.decision.kind))));
    EXPECT_EQ(between(page, "<p class=\"why\">", "</p>"), r.decision.reason);
    EXPECT_EQ(first_unbalanced(page), "");
  }
}

TEST(Html, opens_failed_cases_first_and_keeps_passed_ones_closed) {
  RunResult r = sample::run(Variant::accept, 60.0);
  r.cases[2].checks[1].verdict = Verdict::fail;
  const std::string page = html(r);
  const std::string first = between(page, "<details class=\"case", ">");
  EXPECT_THAT(first, HasSubstr("id=\"case-3\""));
  EXPECT_THAT(first, HasSubstr(" open"));
  EXPECT_THAT(page, testing::ContainsRegex("id=\"case-1\" data-v=\"pass\" data-t=\"[^\"]*\">"));
}

TEST(Html, draws_every_case_that_has_samples) {
  const std::string page = html(sample::run(Variant::reject, 60.0));
  EXPECT_EQ(count(page, "<title>Force over chosen cycles"), 3u);
  EXPECT_EQ(count(page, "<title>Whole record"), 3u);
  EXPECT_EQ(count(page, "<title>Extrema of"), 3u);
  EXPECT_EQ(count(page, "<title>Error over force"), 3u);
}

TEST(Html, tells_how_to_repeat_the_run) {
  const RunResult r = sample::run(Variant::reject, 60.0);
  const std::string page = html(r);
  for (const std::string& what :
       {r.command_line, r.firmware_sha256, r.plan_sha256, r.decision_rule, r.started_at, r.cases[0].digest})
    EXPECT_THAT(page, HasSubstr(what == r.decision_rule ? "value - U &gt; limit rejects" : what));
}

TEST(Html, runs_no_text_of_a_firmware) {
  const std::string page = html(sample::hostile());
  EXPECT_EQ(count(page, "<script>"), 1u);
  EXPECT_EQ(count(page, "</script>"), 1u);
  EXPECT_EQ(first_unbalanced(page), "");
  for (const char c : page) ASSERT_FALSE(static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t');
}

TEST(Html, keeps_its_budget_with_seventy_long_cases) {
  RunResult r = sample::run(Variant::accept);
  const std::vector<CaseResult> three = r.cases;
  r.cases.clear();
  for (int i = 0; i < 70; ++i) r.cases.push_back(three[static_cast<std::size_t>(i % 3)]);
  EXPECT_LT(html(r).size(), 3000000u);
}

TEST(Html, has_equal_bytes_for_equal_results) {
  EXPECT_EQ(html(sample::run(Variant::reject, 60.0)), html(sample::run(Variant::reject, 60.0)));
}

TEST(Html, under_weights_nothing_is_called_ati_and_every_level_is_drawn) {
  RunResult run;
  run.rig.details["reference"] = "weights";
  CaseResult& c = run.cases.emplace_back();
  c.id = "pack0-sensor1", c.loop = "open", c.duration_s = 3.0;
  c.overview = {{"weights", "N", {1, 2, 3}, {5, 10, 15}}, {"firmware", "N", {1, 2, 3}, {5.5F, 10, 15}}};
  c.extrema = {{"levels", {1, 2, 3}, {5, 10, 15}, {5.5F, 10, 15}, {4, 9, 17}}};
  const std::string page = html(run);
  EXPECT_EQ(first_unbalanced(page), "");
  EXPECT_THAT(page, HasSubstr("firmware \u2212 weights"));
  EXPECT_THAT(page, HasSubstr("Conductance model / N"));
  EXPECT_THAT(page, HasSubstr("conductance model 2 N"));
  EXPECT_THAT(page, Not(HasSubstr("ATI")));
  EXPECT_THAT(page, Not(HasSubstr("Maxima")));
}

TEST(Html, survives_a_case_without_anything) {
  RunResult r;
  r.cases.resize(1);
  EXPECT_EQ(first_unbalanced(html(r)), "");
}

TEST(Html, survives_curves_with_missing_infinite_and_unequal_columns) {
  const float inf = INFINITY, nan = NAN, odd[] = {nan, inf, -inf, 3e38f, -3e38f, 1e-40f, 0.0f};
  RunResult r = sample::run(Variant::reject, 30.0);
  std::size_t k = 0;
  for (CaseResult& c : r.cases) {
    for (std::vector<PlotTrace>* traces : {&c.window, &c.overview})
      for (PlotTrace& t : *traces) {
        for (std::size_t i = ++k % 5; i < t.value.size(); i += 7) t.value[i] = odd[k++ % 7];
        for (std::size_t i = 3; i < t.t_s.size(); i += 11) t.t_s[i] = odd[k++ % 7];
      }
    c.window[k % 4].value.resize(5);
    for (ExtremaSeries& e : c.extrema) {
      if (!e.t_s.empty()) e.t_s[0] = nan;
      if (e.actual_N.size() > 1) e.actual_N[1] = inf;
      e.expected_N.resize(e.expected_N.size() / 2);
      e.raw_N.clear();
    }
    c.decay = {true, 1e300, -1e300, 1e300, 1e300, nan, -1.0, inf, nan, nan, 3};
    for (Check& check : c.checks) check.value = check.limit.value = odd[k++ % 7], check.u = odd[k++ % 7];
    c.duration_s = odd[k++ % 7];
  }
  EXPECT_EQ(first_unbalanced(html(r)), "");
}

TEST(RatioFigure, counts_and_draws_a_check_that_nothing_is_allowed_to) {
  RunResult run = sample::run(sample::Variant::accept);
  const std::string accepted = ratio_figure(run).summary;
  EXPECT_NE(accepted.find(", 0 fail"), std::string::npos) << accepted;
  Check nan;
  nan.id = "output_finite", nan.value = 1.0, nan.limit = {Limit::Kind::upper, 0.0, "ours"};
  nan.verdict = Verdict::fail;
  run.cases.front().checks.push_back(nan);
  Check asked = nan;
  asked.required = false;
  run.cases.front().checks.push_back(asked);
  const auto rejected = ratio_figure(run);
  EXPECT_NE(rejected.summary.find(", 1 fail"), std::string::npos) << rejected.summary;
  EXPECT_NE(rejected.svg(figures::Figure::Target::embedded).find("output_finite"), std::string::npos);
}

TEST(Bullet, draws_the_limit_and_an_arrow_beyond_the_axis) {
  const std::string inside = figures::bullet_svg({4.0, 0.5, 5.0, false, figures::Role::pass, "x"});
  EXPECT_THAT(inside, Not(HasSubstr("5l-7 5z")));
  EXPECT_THAT(figures::bullet_svg({50.0, 0.5, 5.0, false, figures::Role::fail, "x"}), HasSubstr("5l-7 5z"));
  EXPECT_EQ(figures::bullet_svg({std::nan(""), 0.5, 5.0, false, figures::Role::fail, "x"}), "");
  EXPECT_EQ(figures::bullet_svg({1.0, 0.5, 0.0, false, figures::Role::fail, "x"}), "");
}

TEST(Difference, interpolates_where_the_clocks_differ) {
  const PlotTrace actual{"a", "N", {0.0f, 0.5f, 1.0f, 1.5f}, {1.0f, 1.0f, 1.0f, 1.0f}};
  const PlotTrace expected{"b", "N", {0.0f, 1.0f, 2.0f}, {0.0f, 2.0f, 0.0f}};
  EXPECT_THAT(difference(actual, expected).value, testing::ElementsAre(1.0f, 0.0f, -1.0f, 0.0f));
}

}  // namespace
}  // namespace forcegate
