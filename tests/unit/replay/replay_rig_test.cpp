#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "hil/base/text.h"
#include "hil/interface/rig.h"

namespace forcegate {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

class ReplayRig : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / ("forcegate_replay_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string put(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
    return (folder_ / name).string();
  }
  Result<std::unique_ptr<Rig>> make(std::map<std::string, std::string> options) {
    return make_rig("replay", options);
  }

  static RigBlock all(Rig& rig) {
    EXPECT_TRUE(rig.begin({}));
    RigBlock block;
    std::size_t at = 0;
    while (true) {
      block.resize(at + 7);
      const auto n = rig.run(7, block, at);
      EXPECT_TRUE(n);
      at += *n;
      if (*n < 7) break;
    }
    block.resize(at);
    return block;
  }
  fs::path folder_;
};

TEST_F(ReplayRig, TurnsVoltsIntoCodesOfTheDeclaredConverter) {
  const auto path = put(
      "r.csv",
      "t_s,F_ref_N,U_V,F_cmd_N\n0,1,0,1.5\n0.001,2,5,1.6\n0.002,3,10,1.7\n0.003,4,12,1.8\n0.004,4,-1,1.8\n");
  auto rig = make({{"record", path}, {"adc_bits", "12"}});
  ASSERT_TRUE(rig) << rig.error().to_text();
  const RigInfo info = (*rig)->info();
  EXPECT_EQ(info.rate_Hz, 1000.0);
  EXPECT_EQ(info.adc_bits, 12);
  EXPECT_FALSE(info.can_move);
  EXPECT_EQ(info.force_max_N, 4.0);
  const RigBlock b = all(**rig);
  EXPECT_EQ(b.adc, (std::vector<std::uint16_t>{0, 2048, 4095, 4095, 0}));
  EXPECT_EQ(b.status[1], 0);
  EXPECT_EQ(b.status[3], kRigAdcRail);
  EXPECT_EQ(b.force_ref_N[2], 3.0f);
  EXPECT_EQ(b.setpoint_N[1], 1.6f);
  EXPECT_TRUE(std::isnan(b.theta_rad[0]));
  EXPECT_DOUBLE_EQ(b.t_s[4], 0.004);
  EXPECT_EQ(all(**rig).adc, b.adc) << "a second record starts anew";
}

TEST_F(ReplayRig, PrefersRecordedCounts) {
  const auto path = put("r.csv", "t_s,F_ref_N,U_V,U_counts\n0,1,9,17\n1,2,9,\n2,3,9,19\n");
  auto rig = make({{"record", path}});
  ASSERT_TRUE(rig);
  const RigBlock b = all(**rig);
  EXPECT_EQ(b.adc, (std::vector<std::uint16_t>{17, 17, 19}));
  EXPECT_EQ(b.status, (std::vector<std::uint16_t>{0, kRigSampleLost, 0}));
  EXPECT_TRUE(std::isnan(b.setpoint_N[0]));
  const auto wide = put("w.csv", "t_s,F_ref_N,U_counts\n0,1,9000\n1,2,9\n");
  EXPECT_THAT(make({{"record", wide}, {"adc_bits", "12"}}).error().text, HasSubstr("exceeds 12 bits"));
  const auto negative = put("n.csv", "t_s,F_ref_N,U_counts\n0,1,9\n1,2,-1\n");
  EXPECT_THAT(make({{"record", negative}}).error().text, HasSubstr("code -1 in row 2 is below 0"));
}

TEST_F(ReplayRig, FillsGapsWithLostSamples) {
  std::string text = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 100; ++i)
    if (i < 40 || i >= 50) text += shortest(i * 0.01) + "," + std::to_string(i) + ",5\n";
  auto rig = make({{"record", put("r.csv", text)}});
  ASSERT_TRUE(rig);
  const RigBlock b = all(**rig);
  ASSERT_EQ(b.size(), 100u);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(b.status[i], i >= 40 && i < 50 ? kRigSampleLost : 0);
    EXPECT_EQ(std::isnan(b.force_ref_N[i]), i >= 40 && i < 50);
    EXPECT_NEAR(b.t_s[i], static_cast<double>(i) * 0.01, 1e-12);
  }
  EXPECT_EQ(b.force_ref_N[99], 99.0f);
  EXPECT_THAT((*rig)->info().details.at("notes"), HasSubstr("10 samples were lost"));
}

TEST_F(ReplayRig, StampsThatScatterAboutAnEvenClockLoseNoRow) {
  std::string text = "t_s,F_ref_N,U_V\n";
  std::uint32_t lcg = 1;
  const auto scatter = [&] { return static_cast<double>((lcg = lcg * 1664525u + 1013904223u) >> 16) / 65536.0 - 0.5; };
  for (int i = 0; i < 400; ++i) text += shortest((i < 200 ? i : i + 30) * 0.01 + 0.008 * scatter()) + "," + std::to_string(i) + ",5\n";
  auto rig = make({{"record", put("r.csv", text)}});
  ASSERT_TRUE(rig) << rig.error().to_text();
  EXPECT_THAT((*rig)->info().details.at("notes"), HasSubstr("about an even clock of 100 Hz"));
  const RigBlock b = all(**rig);
  ASSERT_EQ(b.size(), 430u);
  for (std::size_t i = 0; i < 430; ++i) {
    const bool lost = i >= 200 && i < 230;
    EXPECT_EQ(b.status[i], lost ? kRigSampleLost : 0) << i;
    if (!lost) { EXPECT_EQ(b.force_ref_N[i], static_cast<float>(i < 200 ? i : i - 30)); }
  }
}

TEST_F(ReplayRig, HoldsTheLatestRowWhenTheRateWanders) {
  std::string text = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 2000; ++i) text += shortest(i * 0.01 + 0.15 * std::sin(0.01 * i)) + ",1,5\n";
  auto rig = make({{"record", put("r.csv", text)}});
  ASSERT_TRUE(rig) << rig.error().to_text();
  EXPECT_THAT((*rig)->info().details.at("notes"), HasSubstr("the latest row held"));
  EXPECT_NEAR(static_cast<double>(all(**rig).size()), 2000.0, 2.0);
}

TEST_F(ReplayRig, RefusesWhatItCannotReplayAndSaysHowToMendIt) {
  EXPECT_EQ(make({}).error().code, ErrorCode::usage);
  EXPECT_EQ(make({{"record", (folder_ / "no.csv").string()}}).error().code, ErrorCode::io);
  const auto no_force = put("a.csv", "t_s,U_V,drive_V\n0,1,5\n1,2,5\n");
  EXPECT_THAT(make({{"record", no_force}}).error().hint, HasSubstr("F_ref_N"));
  const auto no_sensor = put("b.csv", "t_s,F_ref_N\n0,1\n1,2\n");
  EXPECT_THAT(make({{"record", no_sensor}}).error().hint, HasSubstr("U_V"));
  const auto wild =
      put("c.csv", "t_s,F_ref_N,U_V\n0,1,1\n1,1,1\n3,1,1\n4,1,1\n10,1,1\n11,1,1\n19,1,1\n20,1,1\n50,1,1\n");
  EXPECT_THAT(make({{"record", wild}}).error().text, HasSubstr("not uniform"));
  const auto good = put("d.csv", "t_s,F_ref_N,U_V\n0,1,1\n1,1,1\n");
  EXPECT_THAT(make({{"record", good}, {"adc_bit", "12"}}).error().hint, HasSubstr("adc_bits"));
  for (const char* bits : {"40", "6", "12.5"}) EXPECT_FALSE(make({{"record", good}, {"adc_bits", bits}})) << bits;
  EXPECT_FALSE(make({{"record", good}, {"v_range_V", "500"}})) << "no image takes it";
  EXPECT_FALSE(make({{"record", good}, {"v_range_V", "x"}}));
  auto rig = make({{"record", good}});
  ASSERT_TRUE(rig);
  RigRecordRequest request;
  request.faults["reference_saturated"] = 1.0;
  EXPECT_EQ((*rig)->begin(request).error().code, ErrorCode::config);
}

TEST_F(ReplayRig, AResistanceIsNoVoltage) {
  const auto rig = make({{"record", put("r.csv", "t [s];Kraft [N];R [kOhm]\n0;1;190\n0.001;2;90\n0.002;3;60\n0.003;4;45\n0.004;4;45\n")}});
  ASSERT_FALSE(rig);
  EXPECT_THAT(rig.error().text, HasSubstr("the output is a resistance"));
  EXPECT_THAT(rig.error().to_text(), ::testing::Not(HasSubstr("uV")));
}

TEST_F(ReplayRig, MapsForeignColumnsAndSaysHow) {
  const auto path = put("r.csv", "t_s,kgf,bridge out,U_V\n0,1,2,3\n0.001,2,4,3\n");
  EXPECT_THAT(make({{"record", path}}).error().hint, HasSubstr("--map kgf=F_ref_kgf"));
  auto rig = make({{"record", path}, {"map", "kgf=F_ref_kgf\nU_V=unused\nbridge out=U_V"}});
  ASSERT_TRUE(rig) << rig.error().to_text();
  const RigBlock b = all(**rig);
  EXPECT_FLOAT_EQ(b.force_ref_N[1], 2.0f * 9.80665f);
  EXPECT_EQ(b.adc[1], static_cast<std::uint16_t>(std::round(0.4 * 65535)));
  EXPECT_THAT(make({{"record", path}, {"map", "kg=F_ref_kgf"}}).error().text, HasSubstr("\"kg\""));
  EXPECT_THAT(make({{"record", path}, {"map", "kgf"}}).error().text, HasSubstr("COLUMN=NAME"));
}

TEST_F(ReplayRig, TakesTheConverterFromTheCalibrationFile) {
  const auto record = put("r.csv", "t_s,F_ref_N,U_V\n0,1,2.5\n1,1,5\n");
  const auto cal = put("cal.toml", "gain_N_per_V = 0.48\nadc_bits = 10\nv_range_V = 5\nid = \"A201-3\"\n");
  auto rig = make({{"record", record}, {"cal", cal}});
  ASSERT_TRUE(rig) << rig.error().to_text();
  EXPECT_EQ(all(**rig).adc, (std::vector<std::uint16_t>{512, 1023}));
  EXPECT_EQ((*rig)->info().details.at("calibration.id"), "A201-3");
  const auto broken = put("broken.toml", "gain = = 3\n");
  EXPECT_THAT(make({{"record", record}, {"cal", broken}}).error().where, HasSubstr("broken.toml:1:"));
}

TEST_F(ReplayRig, SaysWhatOfTheConverterNobodyStated) {
  const auto record = put("r.csv", "t_s,F_ref_N,U_V\n0,1,2.5\n1,1,5\n");
  const auto assumed = [&](std::map<std::string, std::string> options) {
    options["record"] = record;
    const auto rig = make(options);
    EXPECT_TRUE(rig);
    const auto details = (*rig)->info().details;
    return details.contains("assumed") ? details.at("assumed") : std::string();
  };
  EXPECT_EQ(assumed({}), "adc_bits = 16, v_range_V = 10");
  EXPECT_EQ(assumed({{"adc_bits", "12"}}), "v_range_V = 10");
  EXPECT_EQ(assumed({{"adc_bits", "12"}, {"v_range_V", "5"}}), "");
  EXPECT_EQ(assumed({{"cal", put("cal.toml", "adc_bits = 10\nv_range_V = 5\n")}}), "");
}

TEST_F(ReplayRig, AnOutputBelowZeroIsNotReadAsCodeZero) {
  const auto rig = make({{"record", put("r.csv", "t_s,F_ref_N,U_V\n0,0,0\n0.001,1,-2.5\n0.002,2,-5\n0.003,3,-7.5\n")}});
  ASSERT_FALSE(rig);
  EXPECT_THAT(rig.error().text, HasSubstr("U is below 0 V in 3 of 4 rows, down to -7.5 V"));
  EXPECT_THAT(rig.error().hint, HasSubstr("where the output falls while the force rises its sign is reversed"));
}

TEST_F(ReplayRig, RefusesATimeThatWouldFillTheMemoryByItsRow) {
  std::string text = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 200; ++i) text += std::to_string(i < 150 ? 0.001 * i : 2e6 + 0.001 * i) + ",1,5\n";
  const auto rig = make({{"record", put("gap.csv", text)}});
  ASSERT_FALSE(rig);
  EXPECT_EQ(rig.error().code, ErrorCode::config);
  EXPECT_THAT(rig.error().text, HasSubstr("before sample 151 (t_s = 2000000.15)"));
  EXPECT_FALSE(rig.error().hint.empty());
}

}  // namespace
}  // namespace forcegate
