// The lines of an ATI controller in text are as long as its fields are wide, and their rate is that of their length.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <string>

#include "hil/interface/device.h"
#include "hil/rig/config.h"
#include "tests/support/line_world.h"

namespace forcegate {
namespace {

constexpr double kBaud = 38400.0;

/// Answers every command; while it streams, each byte arrives when the line has carried it. Fz counts the lines.
class TextStream final : public Transport {
 public:
  TextStream(const BenchWorld& world, std::size_t width) : world_(world), width_(width) {}
  Result<void> write(std::span<const std::uint8_t> bytes, double) override {
    const std::string text(bytes.begin(), bytes.end());
    streaming_ = text == "QS\r";
    begun_s_ = world_.now_s();
    sent_ = 0;
    if (!streaming_) answers_ += text.substr(0, text.size() - 1) + "\r\n\r\n>";
    return {};
  }
  Result<std::size_t> read(std::span<std::uint8_t> into, double) override {
    std::size_t n = std::min(answers_.size(), into.size());
    std::copy_n(answers_.begin(), n, into.begin());
    answers_.erase(0, n);
    if (!streaming_) return n;
    const auto due = static_cast<std::size_t>((world_.now_s() - begun_s_) * kBaud / 10.0 + 1e-6);
    for (; n < into.size() && sent_ < due; ++n, ++sent_) into[n] = static_cast<std::uint8_t>(line(sent_ / width_)[sent_ % width_]);
    return n;
  }
  std::string name() const override { return "test line"; }

 private:
  std::string line(std::size_t k) const {
    const std::string fields = fmt::format("0,     3,    -2,{:6},     1,     0,", k);
    return fields + fmt::format("{:>{}}\r\n", -1, width_ - 2 - fields.size());
  }
  const BenchWorld& world_;
  std::size_t width_, sent_ = 0;
  bool streaming_ = false;
  double begun_s_ = 0.0;
  std::string answers_;
};

TEST(AtiSerial, LinesOfEveryLengthAreDatedByTheRateThatTheyHave) {
  for (const std::size_t width : {45U, 46U, 57U}) {
    test::LineWorld* here = nullptr;
    test::LineWorld world([&] { return std::make_unique<TextStream>(*here, width); });
    here = &world;
    const auto table = parse_config(
        "port = \"ati\"\nbaud = 38400\nform = \"ascii\"\ncounts_per_force = 1000\nresolution_N = 0.025\nforce_max_N = 17\n"
        "serial = \"S\"\ncalibration_id = \"C\"\n",
        "bench.toml");
    ASSERT_TRUE(table);
    const auto made = Registry<ReferenceKind>::instance().find("ati_serial")->make(*table, world);
    ASSERT_TRUE(made) << made.error().to_text();
    const auto opened = (*made)->open();
    ASSERT_TRUE(opened) << opened.error().to_text();
    ASSERT_TRUE((*made)->start());
    const double begun_s = world.now_s(), line_s = static_cast<double>(width) * 10.0 / kBaud;
    std::vector<ReferenceReading> readings;
    for (int i = 0; i < 2000; ++i) {
      ASSERT_TRUE(world.advance_to(world.now_s() + 0.002));
      const auto polled = (*made)->poll(readings);
      ASSERT_TRUE(polled) << polled.error().to_text();
    }
    EXPECT_GT(static_cast<double>(readings.size()), 4.0 / line_s - 5.0) << width;
    EXPECT_EQ((*made)->counts().at("undated records"), 0U) << width;
    for (const ReferenceReading& r : readings) {
      const double measured_s = begun_s + std::round(static_cast<double>(r.force_N) * 1000.0) * line_s;
      ASSERT_NEAR(r.t_s, measured_s, 0.0021) << width;
    }
  }
}

}  // namespace
}  // namespace forcegate
