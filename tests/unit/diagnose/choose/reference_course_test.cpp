// A zero that wanders within every record, in no course that another record foretells: whose it is says the rig, of which each record has a line of its own.

#include <numbers>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

// Two slow waves a record, in no step with each other; about 0.05 N RMS.
double wander_N(double t_s, int record) {
  const double turns = t_s / 120.0;
  return 0.05 * (std::sin(2.0 * std::numbers::pi * (0.8 * turns + 0.37 * record)) + std::cos(2.0 * std::numbers::pi * (1.7 * turns + 0.61 * record * record)));
}

// The command is the force that the drive was asked for.
enum class Wanders { reference, drive, output };

Diagnosis answer_where(Wanders what) {
  Campaign c = make_campaign(41, [what](const std::vector<double>& t, const std::vector<double>& F, int record) {
    std::vector<double> U;
    for (std::size_t i = 0; i < F.size(); ++i) U.push_back(2.0 * (F[i] + (what == Wanders::reference ? 0.0 : wander_N(t[i], record))) + 0.2);
    return U;
  });
  for (std::size_t k = 0; k < c.records.size(); ++k) {
    Trace& trace = c.records[k].trace;
    std::vector<double>& F = trace.find("F_ref")->value;
    const std::vector<double> asked = F;
    for (std::size_t i = 0; i < F.size(); ++i)
      if (what != Wanders::output) F[i] = std::round((F[i] + wander_N(trace.time_bases[0].t_s[i], static_cast<int>(k))) / 0.025) * 0.025;
    trace.channels.push_back({"F_cmd", "N", "force", 0, asked, {}});
  }
  return answer(std::move(c));
}

TEST(ReferenceCourse, AReferenceThatDepartsFromOutputAndCommandAlikeDrifts) {
  const Diagnosis d = answer_where(Wanders::reference);
  ASSERT_FALSE(d.findings.empty()) << told(d);
  EXPECT_EQ(d.findings.front().effect, "reference_drift") << told(d);
  EXPECT_EQ(d.findings.front().form, "course_over_rig");
  EXPECT_EQ(d.findings.front().side, "reference");
  EXPECT_GE(d.findings.front().probability, 0.9) << told(d);
  ASSERT_EQ(d.findings.front().parameters.size(), 1u);
  EXPECT_NEAR(d.findings.front().parameters.front().value, -1.0, 0.1);
}

TEST(ReferenceCourse, ADriveThatWandersIsNoDriftOfTheReference) {
  const Diagnosis d = answer_where(Wanders::drive);
  EXPECT_LT(probability(d, "reference_drift"), 0.5) << told(d);
}

TEST(ReferenceCourse, AnOutputThatWandersIsNoDriftOfTheReference) {
  const Diagnosis d = answer_where(Wanders::output);
  EXPECT_LT(probability(d, "reference_drift"), 0.5) << told(d);
}

}  // namespace
}  // namespace forcegate::diagnose
