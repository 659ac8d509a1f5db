#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "hil/interface/stimulus.h"

namespace forcegate {
namespace {

class Replay : public ::testing::Test {
 protected:
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("forcegate_replay_" + std::to_string(::getpid()) + ".csv");
  void TearDown() override { std::filesystem::remove(path_); }
  void write(const std::string& header, double offset_N = 2.0) {
    std::ofstream out(path_);
    out << header << '\n';
    for (int i = 0; i < 2000; ++i)
      out << 5.0 + 0.01 * i << ',' << offset_N - 1.5 * std::cos(0.0314159265 * i) << '\n';
  }
  Result<std::unique_ptr<Stimulus>> make(const std::string& channel = "") {
    StimulusSpec spec;
    spec.name = "replay";
    spec.texts = {{"path", path_.string()}};
    if (!channel.empty()) spec.texts["channel"] = channel;
    return make_stimulus(spec);
  }
};

TEST_F(Replay, plays_the_recorded_force_from_zero_and_says_what_it_is) {
  write("t_s,F_ref_N");
  const auto s = make();
  ASSERT_TRUE(s.has_value()) << s.error().to_text();
  EXPECT_NEAR((*s)->duration_s(), 19.99, 1e-9);
  EXPECT_NEAR((*s)->force_N(0.0), 0.5, 1e-4);
  EXPECT_NEAR((*s)->force_N(1.005), 2.0 - 1.5 * std::cos(0.0314159265 * 100.5), 1e-3);
  EXPECT_NEAR((*s)->facts().maximum_N, 3.5, 1e-3);
  EXPECT_TRUE((*s)->facts().dynamic);
  EXPECT_NEAR((*s)->facts().lowest_frequency_Hz, 0.5, 0.01);
}

TEST_F(Replay, takes_the_channel_that_is_asked_for_and_names_those_there_are) {
  write("t_s,F_cmd_N");
  EXPECT_TRUE(make("F_cmd").has_value());
  const auto wrong = make();
  ASSERT_FALSE(wrong.has_value());
  EXPECT_NE(wrong.error().hint.find("F_cmd"), std::string::npos);
}

TEST_F(Replay, maps_a_foreign_column) {
  write("t_s,cell A");
  StimulusSpec spec;
  spec.name = "replay";
  spec.texts = {{"path", path_.string()}, {"map", "cell A=F_ref_N"}};
  const auto s = make_stimulus(spec);
  ASSERT_TRUE(s.has_value()) << s.error().to_text();
  EXPECT_NEAR((*s)->facts().maximum_N, 3.5, 1e-3);
}

TEST_F(Replay, refuses_a_missing_file_and_a_force_beyond_reason) {
  EXPECT_FALSE(make().has_value());
  write("t_s,F_ref_N", 30.0);
  EXPECT_FALSE(make().has_value());
}

}  // namespace
}  // namespace forcegate
