// What is there, and is no finding: an ordinary curve.

#include "hil/diagnose/answer/reservation.h"
#include <array>

#include "hil/base/read_file.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

TEST(Reservation, EachSaysWhyAndOnlyOneThatLowersCounts) {
  Finding f;
  f.effect = "creep";
  f.probability = 0.98;
  f.evidence = "it creeps";
  EXPECT_TRUE(f.limit(0.6, "a rival holds the rest"));
  EXPECT_FALSE(f.limit(0.7, "said before"));
  EXPECT_TRUE(f.limit(0.2, "it leaves too much"));
  EXPECT_EQ(f.probability, 0.2);
  EXPECT_EQ(f.evidence, "it creeps; less sure: a rival holds the rest; not claimed: it leaves too much");
  ASSERT_EQ(f.reservations.size(), 2U);
  EXPECT_EQ(f.reservations[1].most, 0.2);
  EXPECT_EQ(f.reservations[1].why, "it leaves too much");
}

// Its table has a row for every cap and no other: | `name` | because |
TEST(Reservation, EveryCapHasAReasonOnThePageOfTheEngine) {
  const auto page = read_file(FORCEGATE_SOURCE_DIR "/docs/diagnosis-engine.md");
  ASSERT_TRUE(page.has_value()) << page.error().to_text();
  const std::size_t begin = page->find("| cap | because |"), end = page->find("\n\n", begin);
  ASSERT_NE(begin, std::string::npos);
  const std::string table = page->substr(begin, end - begin);
  for (const CapRow& row : kCaps) EXPECT_NE(table.find("| `" + std::string(row.name) + "` | "), std::string::npos) << row.name;
  EXPECT_EQ(std::ranges::count(table, '\n'), std::ssize(kCaps) + 1) << "a row of no cap";
}

// Spikes of `size_V` beside claimed steps of 0.05 and 0.15 N of a sensor of 2 V/N.
double spikes_beside_codes(double size_V) {
  Workspace w;
  w.gain_V_per_N = 2.0;
  w.health.resize(2);
  w.health[1].outliers = 10;
  w.health[1].outlier_square_V2 = 10.0 * size_V * size_V;
  std::vector<Finding> findings(2);
  findings[0].effect = "adc_codes";
  findings[0].form = "bit_weights";
  findings[0].probability = 0.98;
  findings[0].parameters = {{"range_V", 10.0, 0.0, "V"}, {"bit1_N", 0.05, 0.01, "N"}, {"bit2_N", -0.15, 0.01, "N"}};
  findings[1].effect = "outliers";
  findings[1].shown_in = ShownIn::samples;
  findings[1].probability = 0.95;
  leave_spikes_to_codes(w, findings);
  return findings[1].probability;
}

TEST(Reservation, SpikesNoLargerThanTheStepsOfTheCodesAreTheirs) {
  EXPECT_LT(spikes_beside_codes(0.5), 0.5);
  EXPECT_EQ(spikes_beside_codes(0.8), 0.95);
}

// What is found of `effect` where it makes `share` of the span.
double beside_honest_cells(const char* effect, double share) {
  Workspace w;
  ResidualChannel channel;
  channel.scale = 5.0;
  Finding f;
  f.effect = effect, f.probability = 0.9;
  f.effect_rms = share * channel.scale;
  reserve(w, channel, {}, f);
  return f.probability;
}

TEST(Reservation, HonestLoadCellsDriftAndCreepALittle) {
  for (const auto& [effect, ordinary] : {std::pair{"reference_drift", 8e-4}, {"creep", 2.5e-4}, {"self_heating", 2.5e-4}}) {
    EXPECT_LT(beside_honest_cells(effect, ordinary), 0.5) << effect;
    EXPECT_EQ(beside_honest_cells(effect, 2.0 * ordinary), 0.9) << effect;
    EXPECT_EQ(beside_honest_cells(effect, 0.0), 0.9) << "nobody said how large";
  }
}

// Corners that take `each` of the slope, one above the other.
double rail_of(std::vector<double> each) {
  Workspace w;
  Finding f;
  f.effect = "clipping";
  f.probability = 0.98;
  for (std::size_t k = 0; k < each.size(); ++k) {
    const std::string of = k == 0 ? "" : "rail.";
    f.parameters.push_back({of + "Wr_N", 3.0 + static_cast<double>(k), 0.1, "N"});
    f.parameters.push_back({of + "c", each[k], 0.01, "1"});
  }
  reserve(w, ResidualChannel{}, MixedFit{}, f);
  return f.probability;
}

TEST(Reservation, ARailTakesAQuarterOfTheSlopeAndABendLess) {
  EXPECT_EQ(rail_of({0.9}), 0.98);
  EXPECT_EQ(rail_of({0.2, 0.16}), 0.98);
  EXPECT_EQ(rail_of({0.05, 0.035, 0.03}), kWithdrawn);
}

// Of a gain that changes by `c` behind the load, in two records driven by `drive_V`.
double self_heating(double c, std::array<double, 2> drive_V) {
  Workspace w;
  w.input.records.resize(2);
  for (std::size_t k = 0; k < 2; ++k) w.input.records[k].drive_mean_V = drive_V[k];
  Finding f;
  f.effect = "self_heating";
  f.probability = 0.98;
  f.parameters = {{"tau_s", 40.0, 1.0, "s"}, {"c", c, 0.001, "1"}};
  reserve(w, ResidualChannel{}, MixedFit{}, f);
  return f.probability;
}

TEST(Reservation, AGainThatFallsWhileTheLoadLastsIsHeatWhereTwoDrivesTell) {
  EXPECT_EQ(self_heating(-0.02, {kMissing, kMissing}), kNoClaim);
  EXPECT_EQ(self_heating(-0.02, {5.0, 5.0}), kNoClaim);
  EXPECT_EQ(self_heating(-0.02, {5.0, 3.0}), 0.98);
  EXPECT_EQ(self_heating(0.02, {5.0, 5.0}), 0.98);
}

// U = 0.2 + 2 F + `error_V`(F), and a reference that is fine enough to show it.
Diagnosis of_amplifier(const std::function<double(double)>& error_V) {
  std::vector<std::vector<double>> exact_N;
  Campaign c = make_campaign(
      91,
      [&](const std::vector<double>&, const std::vector<double>& F, int) {
        exact_N.push_back(F);
        std::vector<double> U;
        for (const double f : F) U.push_back(2.0 * f + 0.2 + error_V(f));
        return U;
      },
      0.002);
  for (std::size_t k = 0; k < c.records.size(); ++k) c.records[k].trace.find("F_ref")->value = exact_N[k];
  c.bench.reference_resolution_N = 0.001;
  return answer(std::move(c));
}

TEST(Reservation, ACurveThatAnHonestAmplifierHasIsSeenAndNotClaimed) {
  const auto of_curved = [](double sag) { return of_amplifier([=](double F) { return 8.8 * sag * 4.0 * F * (4.4 - F) / (4.4 * 4.4); }); };
  const Diagnosis slight = of_curved(0.002), plain = of_curved(0.02);
  EXPECT_EQ(slight.verdict, DiagnosisVerdict::none) << told(slight);
  EXPECT_LT(probability(slight, "static_nonlinearity"), 0.5) << told(slight);
  EXPECT_NE(told(slight).find("as bent as that"), std::string::npos) << told(slight);
  EXPECT_GE(probability(plain, "static_nonlinearity"), 0.5) << told(plain);
}

// Half of the range weighs too much.
TEST(Reservation, CodesThatAnHonestConverterIsOffByAreSeenAndNotClaimed) {
  const auto of_bit = [](double error_V) { return of_amplifier([=](double F) { return 2.0 * F + 0.2 >= 5.0 ? error_V : 0.0; }); };
  const Diagnosis slight = of_bit(0.014), plain = of_bit(0.05);
  EXPECT_EQ(slight.verdict, DiagnosisVerdict::none) << told(slight);
  EXPECT_LT(probability(slight, "adc_codes"), 0.5) << told(slight);
  EXPECT_NE(told(slight).find("off their straight line by as much"), std::string::npos) << told(slight);
  EXPECT_GE(probability(plain, "adc_codes"), 0.5) << told(plain);
}

// Over the forms of its family the shortest one counts.
TEST(Reservation, ABumpThatIsNotSeenToFadeMayHaveAnotherName) {
  const auto reserved = [](double first_s, double second_s) {
    Finding f;
    f.effect = "frequency_bump";
    f.probability = 0.98;
    f.parameters = {{"tau_s", first_s, 1.0, "s"}, {"whole_swing.tau_s", second_s, 1.0, "s"}};
    reserve(Workspace{}, ResidualChannel{}, MixedFit{}, f);
    return f;
  };
  EXPECT_TRUE(reserved(120.0, 24.0).claimed());
  const Finding stays = reserved(120.0, 200.0);
  EXPECT_EQ(stays.probability, kNoClaim);
  EXPECT_TRUE(stays.name_is_open);
  EXPECT_NE(stays.evidence.find("not seen to fade back"), std::string::npos);
}

TEST(Reservation, ALawThatHelpsFewOfTheRecordsThatItTouchesIsNoClaim) {
  const auto reserved = [](const char* effect, int improved, int excited) {
    Finding f;
    f.effect = effect;
    f.probability = 0.98;
    f.records_improved = improved;
    f.records_excited = excited;
    reserve(Workspace{}, ResidualChannel{}, MixedFit{}, f);
    return f;
  };
  EXPECT_TRUE(reserved("clock_skew", 10, 13).claimed());
  const Finding few = reserved("clock_skew", 9, 13);
  EXPECT_EQ(few.probability, kNoClaim);
  EXPECT_TRUE(few.name_is_open);
  // three are too few to tell; a loop of another form is right nowhere quite
  EXPECT_TRUE(reserved("clock_skew", 2, 3).claimed());
  EXPECT_TRUE(reserved("hysteresis", 4, 6).claimed());
}

// A foot presses a crank in one half of its turn: its angle is recorded, and nobody wrote of a spring.
TEST(Reservation, AForceThatAnAngleOnlyAccompaniesIsNoBentSpring) {
  Campaign c = make_campaign(92, straight, 0.002);
  for (Record& r : c.records) {
    Channel theta{"theta", "rad", "angle", 0, {}, {}};
    Channel &F = *r.trace.find("F_ref"), &U = *r.trace.find("U");
    const std::vector<double>& t = r.trace.time_bases[0].t_s;
    for (std::size_t i = 0; i < t.size(); ++i) {
      const double angle = 2.0 * 3.14159265358979 * 0.8 * t[i];
      theta.value.push_back(angle);
      const double turned = 0.5 * (1.0 - std::cos(angle));
      F.value[i] = 0.3 + 4.0 * std::pow(turned, 1.6) * (1.0 + 0.08 * std::sin(0.37 * t[i]));
      U.value[i] = 2.0 * F.value[i] + 0.2;
    }
    r.trace.channels.push_back(std::move(theta));
  }
  const Diagnosis d = answer(std::move(c));
  EXPECT_LT(probability(d, "spring_nonlinearity"), 0.5) << told(d);
  EXPECT_NE(told(d).find("drives a spring"), std::string::npos) << told(d);
}

// By 0.5 to 0.7 % of the span, a play the other way round.
std::vector<double> ahead_of(const std::vector<double>& F) {
  std::vector<double> U;
  double play = F[0];
  for (const double f : F) {
    play = std::min(std::max(play, f - 0.15), f + 0.15);
    U.push_back(2.0 * f + 0.2 - 0.2 * (play - f));
  }
  return U;
}

// An output that is ahead of its load by half a percent of the span: a late reference or its rounding does that, no film.
TEST(Reservation, ANarrowLoopThatRunsAheadOfTheLoadIsNoHysteresis) {
  const Diagnosis d = answer(make_campaign(93, [](const std::vector<double>&, const std::vector<double>& F, int) { return ahead_of(F); }));
  EXPECT_LT(probability(d, "hysteresis"), 0.5) << told(d);
  EXPECT_NE(told(d).find("ahead of it by so little"), std::string::npos) << told(d);
}

// The same of 0.7 % of the span, against a reference of 1 mN that is not late: neither makes it.
TEST(Reservation, ALoopAheadOfTheLoadIsHysteresisWhereTheReferenceCannotMakeIt) {
  std::vector<std::vector<double>> exact_N;
  Campaign c = make_campaign(
      93,
      [&](const std::vector<double>&, const std::vector<double>& F, int) {
        exact_N.push_back(F);
        return ahead_of(F);
      },
      0.002);
  Rng rng(93, "reference");
  for (std::size_t k = 0; k < c.records.size(); ++k) {
    auto& F = c.records[k].trace.find("F_ref")->value;
    for (std::size_t i = 0; i < F.size(); ++i) F[i] = 0.001 * std::round(1000.0 * (exact_N[k][i] + 0.0005 * rng.normal()));
  }
  c.bench.reference_resolution_N = 0.001;
  const Diagnosis d = answer(std::move(c));
  EXPECT_GE(probability(d, "hysteresis"), 0.5) << told(d);
  const auto loop = std::ranges::find(d.findings, "hysteresis", &Finding::effect);
  ASSERT_NE(loop, d.findings.end()) << told(d);
  const auto width = std::ranges::find(loop->parameters, "loop_width", &FoundParameter::name);
  ASSERT_NE(width, loop->parameters.end());
  EXPECT_NEAR(width->value, -0.7, 0.15);
}

// Relays that close around 1.5 N (Preisach): their loop has a curve of its own.
TEST(Reservation, TheCurveOfALoopIsNotClaimedBesideIt) {
  const auto relays = [](const std::vector<double>&, const std::vector<double>& F, int) {
    constexpr int kRelays = 300;
    std::vector<double> up, down, U;
    std::vector<char> closed(kRelays, 0);
    for (int k = 0; k < kRelays; ++k) {
      const double share = (k + 0.5) / kRelays;
      up.push_back(1.5 * std::exp(0.9 * (2.0 * share - 1.0)));
      down.push_back(up.back() - 0.1 - 0.9 * std::fmod(0.618 * k, 1.0));
    }
    for (const double f : F) {
      double sum = 0.0;
      for (std::size_t k = 0; k < up.size(); ++k) {
        closed[k] = f >= up[k] ? 1 : f <= down[k] ? 0 : closed[k];
        sum += closed[k];
      }
      U.push_back(1.6 * f + 1.5 * sum / kRelays + 0.2);
    }
    return U;
  };
  const Diagnosis d = answer(make_campaign(94, relays));
  EXPECT_GT(probability(d, "hysteresis"), 0.5) << told(d);
  EXPECT_LT(probability(d, "static_nonlinearity"), 0.5) << told(d);
}

TEST(Reservation, ACurveLargerThanTheLoopIsItsOwn) {
  Finding loop, curve, small;
  loop.side = curve.side = small.side = "sensor";
  loop.effect = "hysteresis", loop.probability = 0.9, loop.effect_rms = 0.02;
  curve.effect = "static_nonlinearity", curve.probability = 0.9, curve.effect_rms = 0.03;
  small.effect = "dead_zone", small.probability = 0.9, small.effect_rms = 0.01;
  std::vector<Finding> findings{loop, curve, small};
  leave_curves_to_larger_causes(findings);
  EXPECT_TRUE(findings[1].claimed());
  EXPECT_FALSE(findings[2].claimed());
  findings[0] = curve, findings[2] = small;
  leave_curves_to_larger_causes(findings);
  EXPECT_TRUE(findings[2].claimed()) << "there is no loop";
}

TEST(Reservation, ACurveThatIsSmallerThanWrongCodesIsTheirs) {
  Finding codes, curve, small;
  codes.effect = "adc_codes", codes.probability = 0.98, codes.effect_rms = 0.02, codes.side = "instrument";
  curve.effect = "static_nonlinearity", curve.probability = 0.98, curve.effect_rms = 0.03, curve.side = "sensor";
  small.effect = "static_nonlinearity", small.probability = 0.98, small.effect_rms = 0.01, small.side = "sensor";
  std::vector<Finding> beside_larger{curve, codes}, beside_smaller{codes, small};
  leave_curves_to_larger_causes(beside_larger);
  leave_curves_to_larger_causes(beside_smaller);
  EXPECT_TRUE(beside_larger[0].claimed());
  EXPECT_FALSE(beside_smaller[1].claimed());
  EXPECT_TRUE(beside_smaller[0].claimed()) << "the codes stay";
}

double curve_of(const char* effect, double from_N, double rms_V) {
  Workspace w;
  w.input.range_N = 4.0;
  ResidualChannel channel;
  channel.scale = 8.0;
  Finding f;
  f.effect = effect;
  f.probability = 0.98;
  f.effect_rms = rms_V;
  f.parameters = {{"F0_N", from_N, 0.01, "N"}};
  reserve(w, channel, MixedFit{}, f);
  return f.probability;
}

// A hand that goes back to `rest_N` between its taps; the reference scatters by 0.02 N and is smoothed to a quarter of that.
TEST(Reservation, ADeadZoneIsSeenByLoadsBelowItsEndAndNotByTheNoiseOfARest) {
  for (const double rest_N : {0.09, 0.02}) {
    Workspace w;
    w.health.resize(1);
    w.health[0].noise_F_N = 0.02;
    w.input.records.resize(1);
    RecordInput& r = w.input.records[0];
    Rng rng(5, "rest");
    for (int i = 0; i < 2000; ++i) {
      r.F_N.push_back(i % 10 == 0 ? 2.0 : rest_N + 0.005 * rng.normal());
      r.t_s.push_back(0.02 * i);
    }
    r.ok.assign(r.F_N.size(), 1);
    Finding f;
    f.effect = "dead_zone";
    f.probability = 0.97;
    f.parameters = {{"F0_N", 0.096, 0.002, "N"}, {"c", 0.99, 0.1, "1"}};
    reserve(w, ResidualChannel{}, MixedFit{}, f);
    EXPECT_EQ(f.claimed(), rest_N < 0.05) << f.evidence;
  }
}

TEST(Reservation, ADeadZoneThatEndsFarUpIsABend) {
  EXPECT_LT(curve_of("dead_zone", 2.7, 0.003), 0.5);
  EXPECT_EQ(curve_of("dead_zone", 0.2, 0.003), 0.98) << "few rows lie below it";
  EXPECT_EQ(curve_of("dead_zone", 2.7, 0.02), 0.98);
  EXPECT_LT(curve_of("static_nonlinearity", 0.2, 0.003), 0.5);
}

// Growth per decade and in all, with what they are known to.
double creep_of(double per_decade, double u_per_decade, double in_all, double u_in_all) {
  Finding f;
  f.effect = "creep";
  f.probability = 0.98;
  f.parameters = {{"growth_per_decade", per_decade, u_per_decade, "1/decade"}, {"growth_in_17s", in_all, u_in_all, "1"}};
  std::vector<Finding> findings{f};
  leave_unclear_growth_open(findings);
  EXPECT_EQ(findings[0].name_is_open, findings[0].probability < 0.5);
  return findings[0].probability;
}

TEST(Reservation, AGrowthThatNoRecordTellsIsNoCreep) {
  EXPECT_LT(creep_of(0.23, 1.3, 1.3, 1.7), 0.5) << "fast loads alone tell a sum of terms and none of them";
  EXPECT_EQ(creep_of(0.034, 0.0044, 0.04, 0.025), 0.98);
  EXPECT_EQ(creep_of(-0.01, 0.03, -0.08, 0.01), 0.98);
}

// Of the reference over the rig's law, in newtons; it resolves 0.02 N.
double zero_of(const char* form, double rms_N) {
  Workspace w;
  w.input.range_N = 4.0;
  w.input.bench.reference_resolution_N = 0.02;
  ResidualChannel channel;
  channel.scale = 8.0;
  Finding f;
  f.effect = "reference_drift";
  f.form = form;
  f.probability = 0.98;
  f.effect_rms = 2.0 * rms_N;
  reserve(w, channel, MixedFit{}, f);
  return f.probability;
}

TEST(Reservation, WhatRoundingLeavesOfTheReferenceIsNoDriftOfIt) {
  EXPECT_LT(zero_of("as_rig_shows", 0.009), 0.5);
  EXPECT_EQ(zero_of("as_rig_shows", 0.011), 0.98);
  EXPECT_LT(zero_of("course_over_rig", 0.002), 0.5) << "levels that are held, each rounded";
  EXPECT_EQ(zero_of("course_over_rig", 0.005), 0.98);
}

}  // namespace
}  // namespace forcegate::diagnose
