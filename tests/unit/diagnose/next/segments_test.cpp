// What the pieces of a next experiment excite.

#include "hil/diagnose/next/segments.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace forcegate::diagnose {
namespace {

double largest(const CampaignInput& campaign, const RecordInput& record, const EffectForm& form, const std::vector<double>& shape) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(record.rows()), static_cast<Eigen::Index>(form.strength.size()));
  form.columns(campaign, record, shape, columns);
  return columns.cwiseAbs().maxCoeff();
}

TEST(Segments, AJumpOfTheFrequencyMayBump) {
  Workspace w;
  w.input.range_N = 4.0;
  w.input.records.emplace_back();
  const EffectKind& bump = *EffectRegistry::instance().find("frequency_bump");
  double most = 0.0;
  for (const Segment& s : segments()) {
    const RecordInput played = simulate(w, s);
    for (const EffectForm& form : bump.forms)
      for (const std::vector<double>& shape : form.grid(w.input)) most = std::max(most, largest(w.input, played, form, shape));
  }
  EXPECT_GT(most, 0.1);
}

// What a campaign says that its reference measures.
TEST(Segments, StayInTheDeclaredRangeOfForces) {
  Workspace w;
  w.input.lowest_N = 0.5;
  w.input.range_N = 4.0;
  w.input.records.emplace_back();
  w.input.bench.force_min_N = 0.0;
  const auto highest = [&] {
    double high = 0.0;
    for (const Segment& s : segments())
      for (const double F : simulate(w, s).fast_F_N) high = std::max(high, F);
    return high;
  };
  EXPECT_NEAR(highest(), 4.3, 0.01) << "nothing is declared of the other end";
  w.input.bench.force_max_N = 5.0;
  EXPECT_NEAR(highest(), 4.3, 0.01);
  w.input.bench.force_max_N = 1.0;
  EXPECT_NEAR(highest(), 1.0, 1e-6);
  w.input.bench.force_max_N = 0.4;
  EXPECT_NEAR(highest(), 4.3, 0.01) << "the records contradict it, and nothing of it is known";
}

// What `forcegate stimulus` makes of the parameters is the force that was simulated and that --run plays.
TEST(Segments, AreToldByParametersThatPlayThem) {
  Workspace w;
  w.input.lowest_N = 0.213;
  w.input.range_N = 3.87654;
  w.input.records.emplace_back();
  std::size_t told = 0;
  for (const Segment& s : segments()) {
    const StimulusSpec spec = stimulus_of(w, s);
    if (spec.name == "replay") continue;
    ++told;
    const auto made = make_stimulus(spec);
    ASSERT_TRUE(made) << s.name << ": " << made.error().to_text();
    const RecordInput played = simulate(w, s);
    EXPECT_NEAR((*made)->duration_s(), played.duration_s, 1e-6) << s.name;
    std::size_t off = 0;
    for (std::size_t i = 0; i < played.fast_t_s.size(); ++i) off += std::abs((*made)->force_N(played.fast_t_s[i]) - played.fast_F_N[i]) > 1e-4;
    EXPECT_LE(off, 4u) << s.name << ": but for the sample at a step";
  }
  EXPECT_EQ(told, 13u);
  w.input.lowest_N = -2.0;
  for (const Segment& s : segments()) EXPECT_EQ(stimulus_of(w, s).name, "replay") << s.name << ": no profile pulls";
}

TEST(Segments, AreWrittenAsTheCommandLineTakesThem) {
  ExperimentSegment s;
  s.name = "sines at 0.2 and 4 Hz", s.stimulus = "jump";
  s.numbers = {{"A_N", 1.08}, {"m_N", 2.0}};
  s.lists = {{"f_Hz", {0.2, 4.0}}};
  EXPECT_EQ(parameters_text(s, 1), "A_N=1.08 m_N=2 f_Hz=0.2,4");
  s.stimulus = "replay";
  EXPECT_EQ(parameters_text(s, 3, " = "), "path = profiles/3_sines_at_0_2_and_4_hz.csv");
}

TEST(Segments, TellTheForceThatTheyTouch) {
  Workspace w;
  w.input.range_N = 40.0;
  w.input.records.emplace_back();
  for (const Segment& s : segments()) {
    if (s.name != "touch and release") continue;
    ExperimentSegment told;
    told.force_N = simulate(w, s).fast_F_N;
    EXPECT_NEAR(told.high_N(), 0.12 * 0.95 * 40.0, 0.01);
    EXPECT_EQ(told.low_N(), 0.0);
    return;
  }
  ADD_FAILURE() << "no segment touches";
}

}  // namespace
}  // namespace forcegate::diagnose
