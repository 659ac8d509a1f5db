// Of the forms of an effect a header takes the best one that it undoes on swings and under decay, not the best one whose slopes look well.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hil/app/diagnose/what_next.h"
#include "hil/app/export/export.h"
#include "hil/base/rng.h"
#include "hil/model/base_law.h"
#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

using OneLawExport = FolderTest;

// A loop that stays while the swing decays: in the end the output falls where the force begins to rise.
TEST_F(OneLawExport, AFormThatTheHeaderDoesNotUndoUnderDecayIsPassedOver) {
  BaseLaw law;
  law.decays = true;
  std::string records;
  Rng rng(4, "loops");
  for (int k = 0; k < 5; ++k) {
    const bool dynamic = k % 2 == 1;
    std::string csv = "t_s,F_ref_N,U_V\n";
    double loop = 0.0;
    for (int i = 0; i < 50 * (dynamic ? 240 : 80); ++i) {
      const double t = 0.02 * i, F = dynamic ? (t < 2.0 ? 0.9 : 2.2 - 1.3 * std::cos(std::numbers::pi * (t - 2.0))) : 2.0 - 1.9 * std::cos(2.0 * std::numbers::pi * t / (20.0 + 4.0 * k));
      const double D = dynamic ? decay_factor(t - 2.0, law.decay_rate_per_s(0.5), law.depth_ratio(1.3)) : 1.0;
      loop = std::clamp(loop, F - 0.19, F + 0.19);
      const double U = 0.2 + 2.0 * ((dynamic ? 0.9 + D * (F - 0.9) : F) + 0.885 * (loop - F)) + 0.002 * rng.normal();
      csv += std::to_string(t) + "," + std::to_string(F) + "," + std::to_string(U) + "\n";
    }
    put("loops/r" + std::to_string(k) + ".csv", csv);
    records += (k > 0 ? ", " : "") + std::string("{\"file\": \"r") + std::to_string(k) + ".csv\", \"start_s\": " + std::to_string(900 * k) +
               (dynamic ? ", \"kind\": \"sine\", \"dynamic\": true, \"excitation_start_s\": 2.0, \"f_min_Hz\": 0.5, \"A_N\": 1.3, \"m_N\": 2.2}" : ", \"kind\": \"ramp\", \"dynamic\": false}");
  }
  put("loops/campaign.json", "{\"records\": [" + records + "]}");
  ExportRequest request;
  request.model = put("loop.toml", "[law]\nkind = \"decaying\"\ngain_N_per_V = 0.5\noffset_N = -0.1\nb_slope_s_per_s = 0.0019\nb_intercept_per_s = 0.0056\nq_curvature_per_N2 = 1.377\n"
                                   "[[effect]]\nname = \"hysteresis\"\n").string();
  request.plan = "none";
  request.fit = CampaignRequest{};
  request.fit->campaign = folder_ / "loops";
  request.fit->threads = 1;
  const auto made = export_model(request);
  ASSERT_TRUE(made) << made.error().to_text();
  EXPECT_TRUE(made->self.made) << made->self.why_not;
  EXPECT_TRUE(std::ranges::any_of(made->fit->notes, [](const std::string& note) { return note.find("undecayed predicts best") != std::string::npos; })) << export_text(*made);
}

// The effect of the model is not there in any record, and each has a zero of its own.
TEST_F(OneLawExport, WhereNoLawForAllIsBetterWithTheEffectsTheHeaderIsOfferedWithItsCheck) {
  std::string records;
  Rng rng(5, "no loop");
  for (int k = 0; k < 4; ++k) {
    std::string csv = "t_s,F_ref_N,U_V\n";
    for (int i = 0; i < 2000; ++i) {
      const double F = 2.0 - 1.9 * std::cos(2.0 * std::numbers::pi * 0.02 * i / (16.0 + 3.0 * k));
      csv += std::to_string(0.02 * i) + "," + std::to_string(F) + "," + std::to_string(0.2 + 0.05 * k + 2.0 * F + 0.002 * rng.normal()) + "\n";
    }
    put("none/r" + std::to_string(k) + ".csv", csv);
    records += (k > 0 ? ", " : "") + std::string("{\"file\": \"r") + std::to_string(k) + ".csv\", \"start_s\": " + std::to_string(900 * k) + ", \"kind\": \"ramp\", \"dynamic\": false}";
  }
  put("none/campaign.json", "{\"records\": [" + records + "]}");
  const std::string model = put("loop.toml", "[law]\nkind = \"static\"\ngain_N_per_V = 0.5\noffset_N = -0.1\n[[effect]]\nname = \"hysteresis\"\n").string();
  CampaignRequest on;
  on.campaign = folder_ / "none";
  const auto offer = export_offer(model, &on);
  ASSERT_TRUE(offer);
  EXPECT_FALSE(offer->refit);
  EXPECT_TRUE(offer->check);
  const auto alone = export_offer(model, nullptr);
  ASSERT_TRUE(alone);
  EXPECT_FALSE(alone->check) << "no records, nothing to check it on";
}

}  // namespace
}  // namespace forcegate
