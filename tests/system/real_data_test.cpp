// Recordings of other machines, made by other people, through the commands of a user. The folder is named by
// FORCEGATE_REAL_DATA; without it every test is skipped. None of them is a force sensor: what carries over is the kind
// of effect (hysteresis of a seal, exponential leak, lag and saturation).

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using Json = nlohmann::json;

class RealData : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("FORCEGATE_REAL_DATA");
    if (!folder) GTEST_SKIP() << "FORCEGATE_REAL_DATA names no folder of recordings";
    folder_ = folder;
  }

  Json diagnose(const std::string& file, std::vector<std::string> options) const {
    std::vector<std::string> arguments = {"diagnose", (folder_ / file).string(), "--json"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const ProcessResult r = forcegate(arguments);
    EXPECT_EQ(r.exit_code, 0) << r.out << r.err;
    return Json::parse(r.out, nullptr, false);
  }

  static std::vector<std::string> claims(const Json& answer) {
    std::vector<std::string> out;
    for (const Json& f : answer["findings"])
      if (f["probability"] >= 0.5) out.push_back(f["effect"]);
    return out;
  }

  std::filesystem::path folder_;
};

const std::vector<std::string> kSeal = {"--map", "position_mm=F_ref_N", "--map", "force_N=U_V"};

TEST_F(RealData, TheFrictionOfTheKidneySealIsHysteresis) {
  const Json answer = diagnose("cc0/seal_friction_kidney_3bar.csv", kSeal);
  ASSERT_FALSE(claims(answer).empty()) << answer.dump(1);
  EXPECT_EQ(claims(answer).front(), "hysteresis");
  EXPECT_LT(answer["error_after"], 0.5 * answer["error_before"].get<double>());
}

TEST_F(RealData, TheCircleSealMovesAtOneSpeedEachWaySoThatItsFrictionCannotBeToldFromDamping) {
  const Json answer = diagnose("cc0/seal_friction_circle_7bar.csv", kSeal);
  EXPECT_TRUE(claims(answer).empty()) << answer["findings"].dump(1);
  EXPECT_EQ(answer["verdict"], "unknown");
  ASSERT_FALSE(answer["not_separable"].empty());
  EXPECT_THAT(answer["not_separable"][0].get<std::vector<std::string>>(), ::testing::Contains("hysteresis"));
}

TEST_F(RealData, TheLeaksAreExponentialAndNoLogarithmicCreep) {
  for (const char* file : {"cc0/leak_prusa.csv", "cc0/leak_ultimaker_015.csv"}) {
    const Json answer = diagnose(file, {"--map", "pressure_V=U_V"});
    ASSERT_FALSE(claims(answer).empty()) << file << answer.dump(1);
    EXPECT_EQ(answer["findings"][0]["effect"], "drift") << file;
    EXPECT_EQ(answer["findings"][0]["form"], "exponential") << file;
    EXPECT_EQ(answer["findings"][0]["side_witnessed"], false) << file;
  }
}

TEST_F(RealData, TheMagnetoRheologicalDamperHasAMemoryThenSaturatesAndMoreRemains) {
  const Json answer = diagnose("mit-repo/mr_damper.csv",
                               {"--map", "velocity_cm_s=F_ref_N", "--map", "force_N=U_V", "--rate", "200"});
  const std::vector<std::string> claimed = claims(answer);
  ASSERT_EQ(claimed.size(), 2u) << answer["findings"].dump(1);
  EXPECT_THAT(claimed[0], ::testing::AnyOf("lag", "hysteresis"));
  EXPECT_THAT(claimed[1], ::testing::AnyOf("static_nonlinearity", "clipping"));
  EXPECT_EQ(answer["residual_unknown"], true) << "the forms of a force sensor are rough for a damper";
}

TEST_F(RealData, TheLevelOfTheCascadedTanksLagsBehindThePumpAndThenOverflows) {
  const std::vector<std::string> columns = {"--map", "pump_V=F_ref_N", "--map", "level_V=U_V"};
  const Json estimation = diagnose("mit-repo/cascaded_tanks_estimation.csv", columns);
  EXPECT_EQ(claims(estimation), (std::vector<std::string>{"lag", "clipping"}));
  EXPECT_LT(estimation["error_after"], 0.6 * estimation["error_before"].get<double>());
  EXPECT_LT(estimation["error_after"], 0.4) << "V";
  EXPECT_LT(estimation["plain"]["after"], 0.4 * estimation["plain"]["before"].get<double>());
  EXPECT_THAT(claims(diagnose("mit-repo/cascaded_tanks_validation.csv", columns)),
              ::testing::Contains("clipping"));
}

TEST_F(RealData, AColumnThatIsMissingIsNamedWithTheWayToMapIt) {
  const ProcessResult r =
      forcegate({"diagnose", (folder_ / "mit-repo/cascaded_tanks_estimation.csv").string()});
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_THAT(r.err, ::testing::HasSubstr("--map "));
  EXPECT_THAT(r.err, ::testing::HasSubstr("pump"));
}

}  // namespace
}  // namespace forcegate::test
