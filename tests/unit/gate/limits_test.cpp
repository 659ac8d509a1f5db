#include "hil/gate/limits.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numeric>

namespace forcegate {
namespace {

std::vector<double> one_to(std::size_t n) {
  std::vector<double> values(n);
  std::iota(values.begin(), values.end(), 1.0);
  return values;
}

class LimitsFile : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("forcegate_limits_" + std::to_string(::getpid()) + ".toml");
};

DerivedLimits sample() {
  DerivedLimits limits;
  limits.plan = "nightly", limits.firmware_sha256 = "ab", limits.rig = "emulated/1", limits.date = "2026-01-02";
  limits.by_case_and_check[{"sine", "mre_maxima"}] = derive_limit(one_to(300), 2.0, "%");
  limits.by_case_and_check[{"sine", "mre_minima"}] = derive_limit(one_to(5), 0.5, "%");
  return limits;
}

TEST(DerivedLimits, of_few_values_the_largest_and_of_many_the_bound_of_p99) {
  const DerivedLimits limits = sample();
  EXPECT_EQ(limits.find("sine", "mre_maxima").value, 304.0);
  EXPECT_EQ(limits.find("sine", "mre_maxima").source,
            "derived: p99 at 95 % confidence + 2 sd of n = 300, 2026-01-02, rig emulated/1");
  EXPECT_EQ(limits.find("sine", "mre_minima").value, 6.0);
  EXPECT_EQ(limits.find("sine", "mre_minima").source,
            "derived: largest + 2 sd of n = 5, 2026-01-02, rig emulated/1");
  EXPECT_EQ(limits.find("sweep", "mre_minima").kind, Limit::Kind::none);
}

TEST_F(LimitsFile, comes_back_from_disk_as_it_was) {
  std::ofstream(path_) << write_limits(sample());
  const auto back = read_limits(path_);
  ASSERT_TRUE(back) << back.error().to_text();
  EXPECT_EQ(write_limits(*back), write_limits(sample()));
}

TEST_F(LimitsFile, keeps_a_limit_that_is_small) {
  DerivedLimits limits = sample();
  limits.by_case_and_check[{"sine", "mae_minima"}] = derive_limit({0.00001, 0.00002}, 0.00001, "N");
  std::ofstream(path_) << write_limits(limits);
  const auto back = read_limits(path_);
  ASSERT_TRUE(back) << back.error().to_text();
  EXPECT_EQ(back->find("sine", "mae_minima").value, limits.find("sine", "mae_minima").value);
  EXPECT_GT(back->find("sine", "mae_minima").value, 0.0);
}

TEST_F(LimitsFile, of_the_former_format_is_refused_with_its_place) {
  std::ofstream(path_) << "format = 1\nplan = \"p\"\nfirmware_sha256 = \"a\"\nrig = \"r\"\ndate = \"d\"\n"
                         "[[limit]]\ncase = \"c\"\ncheck = \"mre_maxima\"\np99 = 1\nsd = 1\nvalue = 3\nunit = "
                         "\"%\"\nn = 300\n";
  const auto limits = read_limits(path_);
  ASSERT_FALSE(limits);
  EXPECT_NE(limits.error().to_text().find(path_.string()), std::string::npos) << limits.error().to_text();
  EXPECT_NE(limits.error().hint.find("forcegate limits"), std::string::npos) << limits.error().to_text();
}

TEST_F(LimitsFile, whose_value_does_not_follow_is_refused_and_four_decimals_are_not) {
  const auto read_with = [&](double p99, double sd, double value) {
    DerivedLimits limits = sample();
    DerivedLimit& one = limits.by_case_and_check[{"sine", "mre_maxima"}];
    one.p99_upper = p99, one.sd = sd, one.value = value;
    std::ofstream(path_, std::ios::trunc) << write_limits(limits);
    return read_limits(path_);
  };
  EXPECT_TRUE(read_with(6.6154, 1.2766, 9.1684)) << "of an earlier version";
  EXPECT_FALSE(read_with(6.6154, 1.2766, 9.1690));
  EXPECT_FALSE(read_with(6.61544321, 1.27661234, 9.1690));
  EXPECT_FALSE(read_with(0.00001, 0.00001, 0.0003)) << "small limits too";
  const auto edited = read_with(6.6154, 1.2766, 99.0);
  ASSERT_FALSE(edited);
  EXPECT_EQ(edited.error().code, ErrorCode::config);
  EXPECT_NE(edited.error().text.find("mre_maxima of sine is not the derived one: value = 99"), std::string::npos) << edited.error().text;
}

}  // namespace
}  // namespace forcegate
