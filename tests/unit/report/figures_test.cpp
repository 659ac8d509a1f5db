#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <pugixml.hpp>

#include "hil/base/rng.h"
#include "hil/report/figures/colormap.h"
#include "hil/report/figures/decimate.h"
#include "hil/report/figures/figure.h"
#include "hil/report/figures/path.h"
#include "hil/report/figures/text.h"
#include "hil/report/figures/ticks.h"

namespace forcegate::figures {
namespace {

using testing::HasSubstr;
using testing::Not;

std::vector<std::string> labels(const std::vector<Tick>& ticks) {
  std::vector<std::string> out;
  for (const Tick& t : ticks)
    if (!t.label.empty()) out.push_back(t.label);
  return out;
}

TEST(Ticks, lie_at_round_numbers_with_equal_decimals) {
  EXPECT_THAT(labels(linear_ticks(0.0, 1.0, 5)),
              testing::ElementsAre("0.0", "0.2", "0.4", "0.6", "0.8", "1.0"));
  EXPECT_THAT(labels(linear_ticks(-0.13, 0.12, 4)), testing::ElementsAre("\u22120.1", "0.0", "0.1"));
  EXPECT_THAT(labels(linear_ticks(1180.0, 1190.0, 5)),
              testing::ElementsAre("1180", "1182", "1184", "1186", "1188", "1190"));
}

TEST(Ticks, of_a_logarithmic_axis_are_decades) {
  EXPECT_THAT(labels(logarithmic_ticks(0.01, 1000.0, 8)),
              testing::ElementsAre("0.01", "0.1", "1", "10", "100", "1000"));
  EXPECT_THAT(labels(logarithmic_ticks(2.0, 60.0, 8)), testing::ElementsAre("2", "5", "10", "20", "50"));
}

TEST(Ticks, of_an_axis_that_is_linear_about_zero_are_zero_and_decades_of_either_sign) {
  EXPECT_THAT(labels(symmetric_log_ticks(-1000.0, 1000.0, 1.0, 8)), testing::ElementsAre("\u22121000", "\u2212100", "\u221210", "0", "10", "100", "1000"));
  EXPECT_THAT(labels(symmetric_log_ticks(-8.0, 8.0, 0.5, 8)), testing::ElementsAre("\u22125", "\u22122", "\u22121", "0", "1", "2", "5"));
}

TEST(Ticks, of_an_axis_that_is_linear_about_zero_reach_to_its_ends) {
  EXPECT_THAT(labels(symmetric_log_ticks(-1.2, 8.1, 0.02, 2)), testing::Contains("5")) << "1 alone does not tell where 8 is";
  EXPECT_THAT(labels(symmetric_log_ticks(0.3, 4.0, 0.3, 4)), testing::Contains("0.5")) << "no zero is beside it";
}

TEST(Ticks, of_every_panel_have_two_labels_at_least) {
  for (const double reach : {0.9, 1.9, 4.2, 4.9, 8.0, 9.9, 42.0, 49.0})
    for (const double height : {40.0, 70.0, 90.0, 150.0})
      for (const Scale scale : {Scale::linear, Scale::logarithmic, Scale::symmetric_log}) {
        Figure figure("t", 300.0);
        Axis y{"Residual", "mV", scale == Scale::logarithmic ? 0.6 * reach : -reach, reach, scale};
        y.linear_within = 0.1 * reach;
        figure.panel({"Time", "s", 0.0, 1.0, Scale::linear, false, false, 1.0, {"a"}}, y, height).line({0, 1}, {-reach, reach}, {});
        const std::string svg = figure.svg(Figure::Target::embedded);
        std::size_t n = 0;
        for (std::size_t at = svg.find("text-anchor=\"end\""); at != std::string::npos; at = svg.find("text-anchor=\"end\"", at + 1)) ++n;
        EXPECT_GE(n, 2u) << reach << " over " << height << " px, scale " << static_cast<int>(scale);
      }
}

TEST(Ticks, of_an_impossible_range_are_none_and_end) {
  EXPECT_TRUE(linear_ticks(1.0, 1.0, 5).empty());
  EXPECT_TRUE(linear_ticks(std::nan(""), 1.0, 5).empty());
  EXPECT_TRUE(linear_ticks(0.0, INFINITY, 5).empty());
  EXPECT_TRUE(logarithmic_ticks(0.0, 1.0, 5).empty());
}

TEST(Numbers, for_people_have_a_true_minus_and_few_digits) {
  EXPECT_EQ(display(-1.23456), "\u22121.235");
  EXPECT_EQ(display(1e-7), "1e\u22127");
  EXPECT_EQ(display(0.0), "0");
  EXPECT_EQ(display(std::nan("")), "not measured");
  EXPECT_EQ(coordinate(-0.04), "0");
  EXPECT_EQ(coordinate(12.50), "12.5");
}

TEST(Escape, leaves_no_markup_and_no_control_byte) {
  EXPECT_EQ(escape("<a b=\"c\">'&\x01"), "&lt;a b=&quot;c&quot;&gt;&#39;&amp;\uFFFD");
}

TEST(Decimation, keeps_every_single_sample_peak_of_a_long_record) {
  std::vector<double> x, y;
  for (int i = 0; i < 200000; ++i) x.push_back(i), y.push_back(std::sin(0.01 * i));
  for (const std::size_t i : {1234u, 77777u, 150001u}) y[i] = 9.0;
  const std::span<const double> channel = y;
  const auto keep = m4_indices(x, {&channel, 1}, 600);
  EXPECT_LE(keep.size(), 4u * 600u);
  for (const std::size_t i : {1234u, 77777u, 150001u}) EXPECT_THAT(keep, testing::Contains(i));
}

TEST(Decimation, of_a_polyline_stays_within_the_tolerance) {
  std::vector<Point> points;
  Rng rng(3);
  for (int i = 0; i < 3000; ++i) points.push_back({0.2 * i, 40.0 * std::sin(0.02 * i) + 0.05 * rng.normal()});
  const auto kept = simplify_polyline(points, 0.15);
  EXPECT_LT(kept.size(), points.size() / 3);
  std::size_t k = 0;
  for (const Point& p : points) {
    while (kept[k + 1].x < p.x) ++k;
    const double f = (p.x - kept[k].x) / (kept[k + 1].x - kept[k].x);
    const double slope = (kept[k + 1].y - kept[k].y) / (kept[k + 1].x - kept[k].x);
    const double distance =
        std::abs(p.y - kept[k].y - f * (kept[k + 1].y - kept[k].y)) / std::hypot(1.0, slope);
    ASSERT_LE(distance, 0.1501);
  }
}

TEST(PathData, is_relative_and_compact) {
  PathData path;
  path.move(1.0, 2.0);
  path.line(1.5, 1.5);
  path.line(2.0, 3.0);
  EXPECT_EQ(path.text(), "M10 20l5-5 5 15");
}

TEST(Palette, meets_wcag_contrast_on_both_pages) {
  for (const RoleColours& r : role_colours()) {
    EXPECT_GE(contrast_ratio(r.line_light, kPageLight), 3.0) << r.name;
    EXPECT_GE(contrast_ratio(r.line_dark, kPageDark), 3.0) << r.name;
    EXPECT_GE(contrast_ratio(r.text_light, kPageLight), 4.5) << r.name;
    EXPECT_GE(contrast_ratio(r.text_dark, kPageDark), 4.5) << r.name;
  }
  EXPECT_GE(contrast_ratio(kQuietLight, kPageLight), 4.5);
  EXPECT_GE(contrast_ratio(kQuietDark, kPageDark), 4.5);
  for (int level = 0; level < kColourLevels; ++level)
    for (const std::string& c : {sequential_colour(level), diverging_colour(level)})
      EXPECT_GE(contrast_ratio(c, ink_on(c) == "#000" ? "#000000" : "#ffffff"), 4.5) << c;
}

Figure busy_figure() {
  Figure figure("All <kinds> & more");
  figure.summary = "Everything at once.";
  figure.columns = 2;
  const double nan = std::nan("");
  figure.panel({"Time", "s"}, {"Force", "N"}, 120)
      .line({0, 1, 2, 3, 4}, {1, 2, nan, 2, 1}, {Role::reference}, "ATI")
      .points({0, 1, 2}, {1, 2, 3}, {Role::firmware, Dash::solid, 1, Marker::ring}, "maxima", {0.1, 0.2, nan})
      .band({0, 4}, {0, 0}, {1, 1}, Role::muted, "band")
      .hline(2.0, "limit")
      .vline(1.0, "start")
      .span(2.0, 3.0, "gap")
      .note(2.0, 2.0, "here");
  HeatMap map;
  map.x_edges = {0, 1, 2};
  map.y_edges = {0, 1};
  map.value = {0.5, nan};
  map.hatched = {0, 1};
  map.diverging = true;
  map.label = "Residual";
  figure.panel({"Force", "N"}, {"Rate", "N/s"}, 120).heat(map);
  Panel& bars = figure.panel({"", ""}, {"RMSE", "V"}, 120);
  bars.x_axis.categories = {"M0", "M1"};
  bars.bars({{0, 0, 2, 0.1, false, Role::muted, "2"}, {1, 2, 1, 0.1, true, Role::pass, "\u22121"}}, false,
            true);
  Density d{0, 1, 0, 1, 2, 2, {1, 0, 3, 4}, Role::rising, "rising"};
  figure.panel({"F", "N"}, {"E", "N"}, 120).density(d);
  return figure;
}

TEST(Figure, is_well_formed_xml_with_name_and_description) {
  for (const auto target : {Figure::Target::standalone, Figure::Target::embedded}) {
    const std::string svg = busy_figure().svg(target);
    pugi::xml_document doc;
    ASSERT_TRUE(doc.load_string(svg.c_str())) << svg;
    EXPECT_STREQ(doc.child("svg").child("title").text().get(), "All <kinds> & more");
    EXPECT_STREQ(doc.child("svg").child("desc").text().get(), "Everything at once.");
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
    EXPECT_THAT(svg, Not(HasSubstr("style=")));  // a content security policy with hashes refuses it
  }
}

TEST(Figure, has_equal_bytes_for_equal_calls) {
  EXPECT_EQ(busy_figure().svg(Figure::Target::standalone), busy_figure().svg(Figure::Target::standalone));
}

TEST(Figure, breaks_a_line_at_missing_values) {
  Figure figure("gap");
  figure.panel({"t", "s"}, {"F", "N"}, 50).line({0, 1, 2, 3, 4}, {1, 1, std::nan(""), 1, 1}, {});
  const std::string svg = figure.svg(Figure::Target::embedded);
  const std::size_t at = svg.find("class=\"l rf\"");
  const std::string path = svg.substr(at, svg.find("/>", at) - at);
  EXPECT_THAT(path, testing::ContainsRegex("d=\"M[^m]+m"));
}

TEST(Figure, survives_empty_and_constant_data) {
  Figure figure("empty");
  figure.panel({"t", "s"}, {"F", "N"}, 50);
  figure.panel({"t", "s"}, {"F", "N"}, 50).line({1, 2}, {0, 0}, {});
  figure.panel({"t", "s"}, {"F", "N"}, 50).points({5}, {5}, {});
  pugi::xml_document doc;
  EXPECT_TRUE(doc.load_string(figure.svg(Figure::Target::standalone).c_str()));
}

TEST(Figure, of_a_long_noisy_record_stays_small) {
  std::vector<double> x, y;
  Rng rng(1);
  for (int i = 0; i < 1200000; ++i)
    x.push_back(1e-3 * i), y.push_back(std::sin(3.14e-3 * i) + 0.01 * rng.normal());
  Figure figure("long");
  figure.panel({"t", "s"}, {"F", "N"}, 100).line(x, y, {});
  EXPECT_LT(figure.svg(Figure::Target::embedded).size(), 30000u);
}

TEST(Figure, writes_no_unit_where_there_is_none) {
  Figure f("Levels", 400.0);
  f.panel(Axis{"Record, in order", "1"}, Axis{"Gain", "1"}, 100.0).line({1.0, 2.0, 3.0}, {1.0, 2.0, 1.5}, {Role::firmware});
  const std::string svg = f.svg(Figure::Target::standalone);
  EXPECT_THAT(svg, HasSubstr(">Record, in order<"));
  EXPECT_THAT(svg, Not(HasSubstr(" / 1<")));
}

}  // namespace
}  // namespace forcegate::figures
