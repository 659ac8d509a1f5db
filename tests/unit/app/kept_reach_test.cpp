// The range in which a shape of the user's own was fitted goes into the model, and a refit stays in it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "hil/app/model/fit.h"
#include "hil/app/model/history.h"
#include "hil/base/rng.h"
#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

class KeptReach : public FolderTest {};

TEST_F(KeptReach, ARefitOfWhatAFitHasWrittenLooksNoFurther) {
  // 2 V/N, and a lag of 0.1 s where an equation of 30 s is written, so that 0.3 s is the end of its range
  std::string records;
  Rng rng(4, "kept reach");
  for (int k = 0; k < 4; ++k) {
    std::string csv = "t_s,F_ref_N,U_V\n";
    double x = 2.0;
    for (int i = 0; i < 4000; ++i) {
      const double t = 0.01 * i, F = 2.0 + std::sin(2.0 * std::numbers::pi * t / (1.0 + 0.5 * k));
      x += 0.01 * (F - x) / 0.1;
      csv += std::to_string(t) + "," + std::to_string(F) + "," + std::to_string(0.2 + 2.0 * (F + 0.5 * x) + 0.002 * rng.normal()) + "\n";
    }
    put("film/r" + std::to_string(k) + ".csv", csv);
    records += std::string(k > 0 ? ", " : "") + R"({"file": "r)" + std::to_string(k) + R"(.csv", "kind": "sine", "start_s": )" + std::to_string(600 * k) + "}";
  }
  put("film/campaign.json", R"({"records": [)" + records + "]}");
  CampaignRequest request;
  request.campaign = folder_ / "film";
  request.threads = 1;
  const auto start = parse_model("[law]\nkind = \"static\"\n[[effect]]\nname = \"mine\"\noutput = \"k * x\"\nstate.x = \"(F - x) / tau\"\n"
                                 "parameter.k = { value = 0.3, unit = \"1\" }\nparameter.tau = { value = 30, unit = \"s\" }\n", "m.toml");
  ASSERT_TRUE(start) << start.error().to_text();
  const auto added = fit_request(request, *start, "mine");
  ASSERT_TRUE(added) << added.error().to_text();
  const auto written = parse_model(write_model(added->model), "written.toml");
  ASSERT_TRUE(written) << written.error().to_text();
  const ModelParameter& tau = written->user_effects.front().parameters.back();
  ASSERT_EQ(tau.name, "tau");
  EXPECT_DOUBLE_EQ(tau.minimum, 0.3);
  EXPECT_DOUBLE_EQ(tau.maximum, 3000.0);
  EXPECT_NEAR(tau.value, 0.3, 1e-6);
  const auto again = fit_request(request, *written, "");
  ASSERT_TRUE(again) << again.error().to_text();
  EXPECT_NEAR(again->model.user_effects.front().parameters.back().value, 0.3, 1e-6);
  EXPECT_THAT(again->notes, Contains(HasSubstr("mine.tau = ")));
  request.model = put("written.toml", write_model(added->model)).string();
  const auto told = history_request(request);
  ASSERT_TRUE(told && told->waterfall);
  EXPECT_NEAR(told->waterfall->start, added->error_before, 0.02 * added->error_before);
  EXPECT_NEAR(told->waterfall->end, added->error_after, 0.02 * added->error_after);
}

}  // namespace
}  // namespace forcegate
