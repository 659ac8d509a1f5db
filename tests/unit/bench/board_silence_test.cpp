// A board that does not answer: whether it is silent, or says what is no frame.

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "adapters/board/link_board.h"
#include "tests/support/line_world.h"

namespace forcegate {
namespace {

/// Says the same again and again, whatever it is told.
class Talker final : public Transport {
 public:
  explicit Talker(std::string says) : says_(std::move(says)) {}
  Result<void> write(std::span<const std::uint8_t>, double) override { return {}; }
  Result<std::size_t> read(std::span<std::uint8_t> into, double) override {
    if (says_.empty()) return std::size_t{0};
    for (std::size_t i = 0; i < into.size(); ++i) into[i] = static_cast<std::uint8_t>(says_[at_++ % says_.size()]);
    return into.size();
  }
  std::string name() const override { return "talker"; }

 private:
  std::string says_;
  std::size_t at_ = 0;
};

Error error_of(const std::string& says) {
  test::LineWorld world([&] { return std::make_unique<Talker>(says); });
  LinkBoardOptions options;
  options.reply_timeout_s = 0.05;
  LinkBoard board(options, [&]() -> Result<std::unique_ptr<Transport>> { return std::make_unique<Talker>(says); }, world);
  const auto opened = board.open();
  EXPECT_FALSE(opened);
  return opened ? Error{} : opened.error();
}

TEST(BoardSilence, IsThatOfABoardThatSaysNothing) {
  EXPECT_EQ(error_of("").text, "the board does not answer");
}

TEST(BoardSilence, IsNotThatOfABoardThatTalks) {
  const Error text = error_of("Hello from Arduino 512\r\n");
  EXPECT_EQ(text.text, "the board sends bytes (first: \"Hello from Ardui\") but no frame of the link");
  EXPECT_NE(text.hint.find("baud"), std::string::npos) << text.hint;
  const Error garbage = error_of(std::string("\x80\x00\xff\x01\x00", 5));
  EXPECT_NE(garbage.text.find("first: 80 00 ff 01 00"), std::string::npos) << garbage.text;
}

}  // namespace
}  // namespace forcegate
