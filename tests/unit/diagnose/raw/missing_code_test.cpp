#include "hil/diagnose/raw/missing_code.h"

#include <gmock/gmock.h>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

TEST(MissingCode, IsMadeOfNinesOrIsNoNumberOfAnInstrument) {
  for (const double code : {-9999.0, -999.0, 9999.0, 999.9, -9.999, -99.99, 99999.0, 9.99e2, 1e31, -9.9e37}) EXPECT_TRUE(is_code_for_missing(code)) << code;
  for (const double value : {0.0, 9.0, 99.0, 4.9, 999.8, 9998.0, 1000.0, -3.3, 10.0}) EXPECT_FALSE(is_code_for_missing(value)) << value;
}

TEST(MissingCode, AmongSamplesOfTheOutputIsLeftOutAndTold) {
  const auto creeps = [](const std::vector<double>& t, const std::vector<double>& F, int) {
    std::vector<double> U;
    double slow = 0.0;
    for (std::size_t i = 0; i < F.size(); ++i) {
      slow += (F[i] - slow) * -std::expm1(-(i == 0 ? 0.0 : t[i] - t[i - 1]) / 20.0);
      U.push_back(2.0 * (F[i] + 0.05 * slow) + 0.2);
    }
    return U;
  };
  const Diagnosis clean = answer(make_campaign(41, creeps));
  Campaign c = make_campaign(41, creeps);
  for (Record& r : c.records) {
    auto& U = r.trace.find("U")->value;
    for (std::size_t i = 37; i < U.size(); i += 97) U[i] = -9999.0;
  }
  const Diagnosis d = answer(std::move(c));
  EXPECT_NEAR(d.error_after, clean.error_after, 0.1 * clean.error_after);
  ASSERT_FALSE(d.findings.empty());
  EXPECT_EQ(d.findings.front().effect, clean.findings.front().effect);
  EXPECT_THAT(d.notes, ::testing::Contains(::testing::HasSubstr("no value, -9999")));
}

TEST(MissingCode, WithinTheRangeOfTheOutputIsASample) {
  Campaign c = make_campaign(41, straight);
  c.records[0].trace.find("U")->value[100] = 9.99;
  std::vector<std::string> notes;
  leave_out_missing_codes(c, notes);
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ(c.records[0].trace.find("U")->value[100], 9.99);
}

}  // namespace
}  // namespace forcegate::diagnose
