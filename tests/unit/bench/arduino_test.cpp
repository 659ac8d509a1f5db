// The example firmware of an Arduino-class board behind the adapter of a real bench.

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "adapters/transport/child_process.h"
#include "adapters/transport/private_folder.h"
#include "hil/interface/device.h"
#include "hil/rig/config.h"

namespace forcegate {
namespace {

TEST(ArduinoExample, IsAShortFile) {
  std::ifstream in(FORCEGATE_SOURCE_DIR "/rigs/firmware/examples/arduino_board/arduino_board.ino");
  int lines = 0;
  for (std::string line; std::getline(in, line);) ++lines;
  EXPECT_GT(lines, 100);
  EXPECT_LE(lines, 150);
}

class ArduinoBoard : public testing::Test {
 protected:
  void SetUp() override {
    auto made = PrivateFolder::make();
    ASSERT_TRUE(made);
    folder_.emplace(std::move(*made));
    const auto port = folder_->path() / "board";
    ASSERT_TRUE(firmware_.start({FORCEGATE_BINARY_DIR "/arduino_host", port.string()}, folder_->path(),
                                folder_->path() / "log"));
    for (int i = 0; i < 2000 && !std::filesystem::exists(port); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    const auto root = parse_config("[ports]\nboard = \"" + port.string() + "\"\n", "lab.toml");
    auto world = Registry<BenchWorldKind>::instance().find("real")->make(*root, {});
    ASSERT_TRUE(world);
    world_ = std::move(*world);
    const auto table =
        parse_config("port = \"board\"\nserial = \"A-1\"\nadc_bits = 10\nv_range_V = 5\n", "lab.toml");
    auto board = Registry<BoardKind>::instance().find("serial_board")->make(*table, *world_);
    ASSERT_TRUE(board);
    board_ = std::move(*board);
  }
  static DutSession session() {
    DutSession s;
    s.nonce = 4711;
    s.calibration.gain_N_per_V = 0.75;
    s.calibration.offset_N = 0.125;
    s.calibration.adc_bits = 10;
    s.calibration.v_range_V = 5.0;
    s.calibration.id = "arduino";
    return s;
  }
  std::optional<PrivateFolder> folder_;
  ChildProcess firmware_;
  std::unique_ptr<BenchWorld> world_;
  std::unique_ptr<SensorBoard> board_;
};

TEST_F(ArduinoBoard, ShakesHandsAndStreamsEverySample) {
  const auto opened = board_->open();
  ASSERT_TRUE(opened) << opened.error().to_text();
  EXPECT_EQ(opened->model, "arduino");
  const auto info = board_->load(session());
  ASSERT_TRUE(info) << info.error().to_text();
  EXPECT_EQ(info->algorithm_id, "static/1");
  EXPECT_EQ(info->nonce, 4711U);
  ASSERT_TRUE(board_->start());
  std::vector<BoardSample> samples;
  for (int i = 0; i < 4000 && samples.size() < 500; ++i) {
    ASSERT_TRUE(world_->advance_to(world_->now_s() + 0.005));
    const auto polled = board_->poll(samples);
    ASSERT_TRUE(polled) << polled.error().to_text();
  }
  ASSERT_GE(samples.size(), 500U);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(samples[i].index, i);
    EXPECT_EQ(samples[i].adc, (samples[0].adc + i) % 1024);  // the shim's converter counts
    EXPECT_FLOAT_EQ(samples[i].force_N,
                    0.75F * (static_cast<float>(samples[i].adc) / 1023.0F) * 5.0F + 0.125F);
    EXPECT_EQ(samples[i].flags, samples[i].adc == 0 || samples[i].adc == 1023 ? kDutInputRail : 0);
  }
  ASSERT_TRUE(board_->stop());
  const DutCounters c = board_->counters();
  EXPECT_EQ(c.frames_bad + c.frames_dropped + c.indices_lost, 0U);
}

TEST_F(ArduinoBoard, RefusesACalibrationOfAnotherConverter) {
  ASSERT_TRUE(board_->open());
  DutSession other = session();
  other.calibration.adc_bits = 12;
  const auto loaded = board_->load(other);
  ASSERT_FALSE(loaded);
  EXPECT_NE(loaded.error().text.find("calibration out of range"), std::string::npos)
      << loaded.error().to_text();
  EXPECT_TRUE(board_->load(session()));
}

}  // namespace
}  // namespace forcegate
