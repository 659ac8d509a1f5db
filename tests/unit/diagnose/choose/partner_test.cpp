// Two effects of which either alone differs from record to record, since the other stands in its place.

#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

using Corners = std::vector<std::pair<double, double>>;  // s, N

double along(const Corners& corners, double t) {
  for (std::size_t k = 1; k < corners.size(); ++k)
    if (t <= corners[k].first) {
      const auto [t0, F0] = corners[k - 1];
      const auto [t1, F1] = corners[k];
      return std::lerp(F0, F1, (t - t0) / (t1 - t0));
    }
  return corners.back().second;
}

// Of a testing machine, 100 s each: ramps, holds and steps of many heights.
const std::array<Corners, 8> kProfiles = {{
    {{0, 0.1}, {44, 4.4}, {52, 4.4}, {100, 0.1}},
    {{0, 0.3}, {7, 0.3}, {8, 2.7}, {50, 2.7}, {52, 4.2}, {82, 4.2}, {84, 0.3}, {100, 0.3}},
    {{0, 0.2}, {5, 3.0}, {46, 3.0}, {48, 1.8}, {78, 1.8}, {80, 0.2}, {100, 0.2}},
    {{0, 0.3}, {3, 0.3}, {4, 2.7}, {18, 2.7}, {19, 4.3}, {23, 4.3}, {24, 1.2}, {38, 1.2}, {39, 3.3}, {43, 3.3}, {44, 4.4}, {48, 4.4}, {59, 0.3}, {64, 0.3}, {65, 2.1}, {90, 4.5}, {91, 0.5}, {100, 0.5}},
    {{0, 0.1}, {10, 4.5}, {20, 0.2}, {30, 4.5}, {40, 2.0}, {50, 2.7}, {60, 0.7}, {70, 2.5}, {80, 0.5}, {90, 3.0}, {100, 0.5}},
    {{0, 0.1}, {10, 4.4}, {24, 0.2}, {28, 0.2}, {40, 4.4}, {50, 0.2}, {100, 0.2}},
    {{0, 0.2}, {15, 4.6}, {31, 0.5}, {48, 4.2}, {60, 0.9}, {75, 4.2}, {90, 0.4}, {100, 0.4}},
    {{0, 0.2}, {25, 4.6}, {48, 0.3}, {75, 4.4}, {100, 0.6}},
}};

// Springs with sliders: an output that is ahead of the load while it rises. The growth under load is behind it by as much.
std::vector<double> sliders_and_growth(const std::vector<double>& F, double dt_s) {
  constexpr int kSliders = 12;
  constexpr std::array<std::pair<double, double>, 6> kGrowth = {{{2.0, 0.1}, {6.0, 0.2}, {20.0, 0.25}, {60.0, 0.2}, {200.0, 0.15}, {600.0, 0.1}}};
  std::array<double, kSliders> slider{};
  std::array<double, kGrowth.size()> grown{};
  std::vector<double> out;
  double last = 0.0;
  for (const double f : F) {
    double ahead = 0.0, growth = 0.0, yield_N = 0.1;
    for (double& q : slider) {
      q = std::clamp(q + f - last, -yield_N, yield_N);
      ahead += q / kSliders;
      yield_N *= 1.5;
    }
    for (std::size_t k = 0; k < kGrowth.size(); ++k) {
      grown[k] += (f - grown[k]) * -std::expm1(-dt_s / kGrowth[k].first);
      growth += kGrowth[k].second * grown[k];
    }
    last = f;
    out.push_back(1.6 * (f + 0.2 * ahead + 0.2 * growth) + 0.2);
  }
  return out;
}

TEST(Partner, ALoopAndAGrowthThatStandInEachOthersPlaceAreBothNamed) {
  constexpr double kStep_s = 0.02;
  Campaign c = make_campaign(5, straight);
  Rng rng(5, "testing machine");
  for (std::size_t k = 0; k < c.records.size(); ++k) {
    Record& r = c.records[k];
    std::vector<double> t, F;
    for (int i = 0; i < 5000; ++i) {
      t.push_back(kStep_s * i);
      F.push_back(along(kProfiles[k], t.back()));
    }
    std::vector<double> U = sliders_and_growth(F, kStep_s);
    const double gain = 1.0 + 0.004 * rng.normal(), zero = 0.005 * rng.normal();
    for (double& u : U) u = std::round((u * gain + zero + 0.004 * rng.normal()) * 409.6) / 409.6;
    for (double& f : F) f = std::round((f + 0.006 * rng.normal()) / 0.025) * 0.025;
    r.trace.time_bases[0].t_s = t;
    r.trace.find("F_ref")->value = F;
    r.trace.find("U")->value = U;
    r.kind = k == 3 ? "steps" : k == 1 || k == 2 ? "hold" : "ramp";
  }
  const Diagnosis d = answer(std::move(c));
  const auto claims = [&](const char* effect) { return std::ranges::any_of(d.findings, [&](const Finding& f) { return f.effect == effect && f.claimed(); }); };
  EXPECT_TRUE(claims("hysteresis")) << told(d);
  EXPECT_TRUE(claims("creep")) << told(d);
  EXPECT_LT(d.error_after, 0.4 * d.error_before);
}

// Of eight short records at 1 kHz two have edges: there a lag makes most of the error, and the loop is in all of them.
double of_short_record(int record, double t) {
  const auto triangle = [t](double period_s) { return 0.4 + 7.2 * std::abs(t / period_s - std::round(t / period_s)); };
  const auto sine = [t](double f_Hz, double A_N) { return 2.2 - A_N * std::cos(2.0 * std::numbers::pi * f_Hz * t); };
  const auto code = [](int bit) { return (0xB38F1A6C >> (bit % 32) & 1) != 0 ? 3.4 : 0.9; };
  switch (record) {
    case 0: return 0.6 + 0.9 * std::fmod(2.0 * std::floor(t / 1.5), 5.0);
    case 2: return code(static_cast<int>(t / 0.25));
    case 4: return sine(0.23, 1.4);
    case 6: return sine(1.0, 1.5);
    case 7: return sine(3.0, 1.0);
    default: return triangle(record == 1 ? 5.0 : record == 3 ? 14.0 : 10.0);
  }
}

TEST(Partner, ALagOfFewEdgesAndALoopOfAllRecordsAreBothNamed) {
  constexpr double kStep_s = 0.001, kLag_s = 0.007;
  Campaign c = make_campaign(6, straight);
  Rng rng(6, "short records");
  for (int k = 0; k < 8; ++k) {
    Record& r = c.records[static_cast<std::size_t>(k)];
    std::vector<double> t, F, U;
    double late = of_short_record(k, 0.0);
    std::array<double, 6> play;
    play.fill(late);
    for (int i = 0; i < 14000; ++i) {
      t.push_back(kStep_s * i);
      const double f = of_short_record(k, t.back());
      late += (f - late) * -std::expm1(-kStep_s / kLag_s);
      double sum = 0.0, width_N = 0.02;
      for (double& p : play) {
        p = std::clamp(p, late - width_N, late + width_N);
        sum += p;
        width_N *= 1.7;
      }
      F.push_back(std::round((f + 0.004 * rng.normal()) / 0.025) * 0.025);
      U.push_back(std::round((1.85 * (0.58 * late + 0.07 * sum) + 0.2 + 0.008 * rng.normal()) * 409.6) / 409.6);
    }
    r.trace.time_bases[0].t_s = t;
    r.trace.find("F_ref")->value = F;
    r.trace.find("U")->value = U;
    r.kind = k == 0 ? "steps" : k == 2 ? "prbs" : k == 4 || k > 5 ? "sine" : "ramp";
  }
  const Diagnosis d = answer(std::move(c));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::known);
  for (const char* effect : {"lag", "hysteresis"}) EXPECT_GT(probability(d, effect), 0.8) << effect << '\n' << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
