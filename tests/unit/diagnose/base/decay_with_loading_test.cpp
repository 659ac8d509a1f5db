// Cycled records whose load pauses, as a hand's does: the decay goes on with the cycles, or with the time.

#include <cmath>

#include "hil/diagnose/refit/one_law.h"
#include "hil/diagnose/refit/refit.h"
#include "hil/model/rows.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

enum class Clock { time, loading };

// Fast triangles of four heights that pause for two thirds of the time, among static records.
Campaign with_pauses(Clock kind) {
  Campaign c = make_campaign(51, straight, 0.002);
  for (const std::size_t k : {3u, 7u}) {
    Record& r = c.records[k];
    auto &F = r.trace.find("F_ref")->value, &U = r.trace.find("U")->value;
    const std::vector<double>& t = r.trace.time_bases[0].t_s;
    Rng rng(60 + k, "pauses");
    double done_N = 0.0, phase_s = 0.0, last_N = 0.4;
    for (std::size_t i = 0; i < F.size(); ++i) {
      const bool pauses = std::fmod(t[i], 45.0) > 15.0;
      if (!pauses) phase_s += 0.005;
      const double at = std::fmod(phase_s / 2.5, 1.0), height = 2.4 + 0.4 * std::fmod(std::floor(phase_s / 2.5), 4.0);
      const double f = 0.4 + height * (at < 0.5 ? 2.0 * at : 2.0 - 2.0 * at);
      done_N += std::abs(f - last_N);
      last_N = f;
      const double gone = kind == Clock::time ? t[i] / 40.0 : done_N / 35.0, D = (std::exp(-gone) + 1.5) / 2.5;
      F[i] = std::round((f + 0.006 * rng.normal()) / 0.025) * 0.025;
      U[i] = 2.0 * (0.4 + D * (f - 0.4)) + 0.2 + 0.002 * rng.normal();
    }
    r.kind = "grasp";
    r.dynamic = true;
  }
  return c;
}

bool says_loading(const Diagnosis& d) {
  return std::ranges::any_of(d.notes, [](const std::string& note) { return note.find("with the loading done") != std::string::npos; });
}

TEST(DecayWithLoading, ThatPausesWithTheLoadIsFollowed) {
  const Diagnosis d = answer(with_pauses(Clock::loading));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  EXPECT_TRUE(says_loading(d)) << told(d);
}

TEST(DecayWithLoading, TheModelOfAFitHasItsClock) {
  const Model start = *library_model("flexiforce");
  const auto fitted = refit_campaign(with_pauses(Clock::loading), {}, start, "");
  ASSERT_TRUE(fitted.has_value()) << fitted.error().text;
  EXPECT_EQ(fitted->model.law.loading_share, 1.0);
  EXPECT_TRUE(std::ranges::any_of(fitted->moves, [](const ParameterMove& m) { return m.name == "loading_share" && m.before == 0.0 && m.after == 1.0; }));
  const auto of_time = refit_campaign(with_pauses(Clock::time), {}, start, "");
  ASSERT_TRUE(of_time.has_value()) << of_time.error().text;
  EXPECT_EQ(of_time->model.law.loading_share, 0.0);
}

TEST(DecayWithLoading, OneLawForAllHasItToo) {
  const auto fitted = fit_one_law(with_pauses(Clock::loading), *library_model("flexiforce"));
  ASSERT_TRUE(fitted.has_value()) << fitted.error().text;
  EXPECT_EQ(fitted->model.law.loading_share, 1.0);
  const auto of_time = fit_one_law(with_pauses(Clock::time), *library_model("flexiforce"));
  ASSERT_TRUE(of_time.has_value()) << of_time.error().text;
  EXPECT_EQ(of_time->model.law.loading_share, 0.0);
  EXPECT_LT(fitted->left_out_V, 1.5 * of_time->left_out_V) << "as good as where the decay goes with the time";
}

TEST(DecayWithLoading, OneThatGoesWithTheTimeStaysWithIt) {
  const Diagnosis d = answer(with_pauses(Clock::time));
  EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  EXPECT_FALSE(says_loading(d)) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
