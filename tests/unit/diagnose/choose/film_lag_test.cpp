// A film under a puck in a room that swings within every record: its lag is none of those that are tried.

#include <numbers>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

double air_C(double t_s, int record) { return 22.0 + 0.3 * record + 5.0 * std::sin(2.0 * std::numbers::pi * (t_s / 45.0 + 0.31 * record)); }

Diagnosis answer_of_film() {
  Campaign c = make_campaign(57, [](const std::vector<double>& t, const std::vector<double>& F, int record) {
    std::vector<double> U;
    double film_C = air_C(0.0, record);
    for (std::size_t i = 0; i < F.size(); ++i) {
      const double dt = i == 0 ? 0.0 : t[i] - t[i - 1];
      film_C += (air_C(t[i], record) - film_C) * -std::expm1(-dt / 10.0);
      U.push_back(2.0 * F[i] * (1.0 - 0.006 * (film_C - 22.0)) + 0.2);
    }
    return U;
  });
  for (std::size_t k = 0; k < c.records.size(); ++k) {
    std::vector<double> temp;
    for (const double t : c.records[k].trace.time_bases[0].t_s) temp.push_back(std::round(air_C(t, static_cast<int>(k)) / 0.05) * 0.05);
    c.records[k].trace.channels.push_back({"temp", "C", "temperature", 0, temp, {}});
  }
  return answer(std::move(c));
}

TEST(FilmLag, IsFittedWhereTheRowsTellOfIt) {
  const Diagnosis d = answer_of_film();
  ASSERT_FALSE(d.findings.empty());
  const Finding& f = d.findings.front();
  ASSERT_EQ(f.effect, "thermal") << told(d);
  EXPECT_GE(f.probability, 0.9) << told(d);
  ASSERT_FALSE(f.parameters.empty());
  EXPECT_EQ(f.parameters.front().name, "tau_s");
  EXPECT_NEAR(f.parameters.front().value, 10.0, 0.5);
}

// Means of records over their mean temperature would show nothing of what runs on within them.
TEST(FilmLag, ItsEvidenceIsDrawnOverTheFilmsTemperature) {
  const Diagnosis d = answer_of_film();
  ASSERT_FALSE(d.findings.empty());
  ASSERT_EQ(d.findings.front().series.size(), 1u) << told(d);
  const EvidenceSeries& s = d.findings.front().series.front();
  EXPECT_EQ(s.title, "mean residual of every eighth of a record, each record left out in turn");
  EXPECT_EQ(s.x_name, "temperature of the film");
  EXPECT_EQ(s.x.size(), 8 * d.records.size());
  const auto [low, high] = std::ranges::minmax(s.x);
  EXPECT_GT(high - low, 3.0);
  double before = 0.0, after = 0.0;
  for (std::size_t i = 0; i < s.x.size(); ++i) before += s.before[i] * s.before[i], after += s.after[i] * s.after[i];
  EXPECT_LT(after, 0.2 * before);
}

}  // namespace
}  // namespace forcegate::diagnose
