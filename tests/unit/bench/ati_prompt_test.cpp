// Prompts of the ATI controller that answer something older than the command: the CR with which the line was closed the
// last time, a '>' in the middle of a stream. They must never put commands and answers out of step.

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

#include "hil/interface/device.h"
#include "hil/rig/bench_file.h"
#include "tests/support/line_world.h"
#include "tests/support/twin_bench.h"

namespace forcegate {
namespace {

/// A controller that answers everything, `late` empty prompts in front of the answer to its first command.
class LatePrompts final : public Transport {
 public:
  LatePrompts(int late, std::vector<std::string>& heard) : late_(late), heard_(heard) {}
  Result<void> write(std::span<const std::uint8_t> bytes, double) override {
    std::string text(bytes.begin(), bytes.end());
    text.pop_back();  // the CR
    if (!text.empty()) {
      heard_.push_back(text);
      for (; late_ > 0; --late_) answers_.push_back("\r\n\r\n>");
    }
    answers_.push_back(text + "\r\n\r\n>");
    return {};
  }
  Result<std::size_t> read(std::span<std::uint8_t> into, double) override {
    if (answers_.empty()) return std::size_t{0};
    const std::string answer = answers_.front();
    answers_.pop_front();
    std::copy(answer.begin(), answer.end(), into.begin());
    return answer.size();
  }
  std::string name() const override { return "test line"; }

 private:
  int late_;
  std::vector<std::string>& heard_;
  std::deque<std::string> answers_;
};

TEST(AtiSerial, PromptsThatComeLateDoNotPutCommandsAndAnswersOutOfStep) {
  const auto bench = read_bench_text(test::bench_text("twin.toml"), FORCEGATE_SOURCE_DIR "/rigs/twin.toml");
  ASSERT_TRUE(bench) << bench.error().to_text();
  for (const int late : {0, 1, 3}) {
    std::vector<std::string> heard;
    test::LineWorld world([&] { return std::make_unique<LatePrompts>(late, heard); });
    const auto made = Registry<ReferenceKind>::instance().find("ati_serial")->make(bench->table("reference"), world);
    ASSERT_TRUE(made) << made.error().to_text();
    const auto opened = (*made)->open();
    EXPECT_TRUE(opened) << late << ": " << opened.error().to_text();
    EXPECT_EQ(std::count(heard.begin(), heard.end(), "CD B"), 1) << "said again after " << late << " late prompts";
  }
}

}  // namespace
}  // namespace forcegate
