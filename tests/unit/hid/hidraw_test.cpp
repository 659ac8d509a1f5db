// hidapi really reading and writing reports, of a device that umockdev plays.

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "adapters/hid/report_line.h"
#include "adapters/transport/private_folder.h"
#include "adapters/transport/serial.h"
#include "hil/rig/config.h"
#include "tests/support/mock_hid.h"
#include "tests/support/twin_bench.h"

namespace forcegate {
namespace {

using test::MockHid;
using test::TwinBench;
constexpr unsigned short kVendor = 0x1209, kProduct = 0x0001;

class HidrawTest : public testing::Test {
 protected:
  void SetUp() override {
    auto made = PrivateFolder::make();
    ASSERT_TRUE(made);
    folder_.emplace(std::move(*made));
    auto mock = MockHid::plug_in(kVendor, kProduct, "BOARD-T-1", folder_->path().string());
    ASSERT_TRUE(mock) << mock.error().to_text();
    mock_ = std::move(*mock);
  }
  std::optional<PrivateFolder> folder_;
  std::unique_ptr<MockHid> mock_;
};

TEST_F(HidrawTest, ADeviceIsFoundByItsNumbersAndItsSerial) {
  const auto found = hid::open_hidraw(kVendor, kProduct, "BOARD-T-1");
  ASSERT_TRUE(found) << found.error().to_text();
  EXPECT_NE((*found)->name().find("/dev/hidraw0"), std::string::npos);
  EXPECT_TRUE(hid::open_hidraw(kVendor, kProduct, ""));
  for (const auto& wrong :
       {hid::open_hidraw(kVendor, kProduct, "BOARD-T-2"), hid::open_hidraw(kVendor, 0x0002, "")}) {
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.error().code, ErrorCode::device);
  }
}

TEST_F(HidrawTest, ReportsCrossInBothDirectionsAndAReadWaitsNoLongerThanTold) {
  auto line = hid::open_hidraw(kVendor, kProduct, "BOARD-T-1");
  ASSERT_TRUE(line) << line.error().to_text();
  std::uint8_t into[64];
  EXPECT_EQ((*line)->read(into, 0.02).value(), 0U);
  const auto out = hid::pack(std::vector<std::uint8_t>{1, 2, 3});
  ASSERT_TRUE((*line)->write(out, 1.0));
  std::vector<std::vector<std::uint8_t>> got;
  for (int i = 0; i < 1000 && got.empty(); ++i) {
    got = mock_->written();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ASSERT_EQ(got.size(), 1U);
  EXPECT_TRUE(std::equal(out.begin(), out.end(), got[0].begin(), got[0].end()));
  std::vector<std::uint8_t> back(64);
  for (std::size_t i = 0; i < 64; ++i) back[i] = static_cast<std::uint8_t>(3 * i);
  ASSERT_TRUE(mock_->send(back));
  ASSERT_EQ((*line)->read(into, 1.0).value(), 64U);
  EXPECT_TRUE(std::equal(back.begin(), back.end(), into));
}

TEST_F(HidrawTest, ADeviceThatIsPulledOutIsGone) {
  auto line = hid::open_hidraw(kVendor, kProduct, "BOARD-T-1");
  ASSERT_TRUE(line) << line.error().to_text();
  mock_->pull_out();
  std::uint8_t into[64];
  Result<std::size_t> n = std::size_t{0};
  for (int i = 0; i < 50 && n; ++i) n = (*line)->read(into, 0.02);
  ASSERT_FALSE(n);
  EXPECT_EQ(n.error().code, ErrorCode::io);
  EXPECT_FALSE(hid::open_hidraw(kVendor, kProduct, "BOARD-T-1"));
}

// The whole way: adapter, hidapi, reports, the board of a served bench at the other end.
TEST_F(HidrawTest, TheAdapterStreamsTheBoardOfATwinThroughIt) {
  TwinBench twins("twin_hid.toml", {{"clock = \"virtual\"", "clock = \"paced\""}});
  ASSERT_TRUE(twins.session);
  auto wire = open_serial(std::filesystem::path(twins.session->world().guard_option()) / "board0", {});
  ASSERT_TRUE(wire) << wire.error().to_text();
  std::atomic<bool> stop{false};
  std::thread cable([&] {
    std::vector<std::uint8_t> towards_host;
    while (!stop) {
      for (const auto& report : mock_->written()) (void)(*wire)->write(report, 1.0);
      std::uint8_t bytes[4096];
      const auto n = (*wire)->read(bytes, 0.001);
      if (n) towards_host.insert(towards_host.end(), bytes, bytes + *n);
      while (towards_host.size() >= 64 && mock_->send({towards_host.begin(), towards_host.begin() + 64}))
        towards_host.erase(towards_host.begin(), towards_host.begin() + 64);
    }
  });
  const auto root = parse_config("", "lab.toml");
  auto world = Registry<BenchWorldKind>::instance().find("real")->make(*root, {});
  ASSERT_TRUE(world);
  const auto table =
      parse_config("vendor_id = 0x1209\nproduct_id = 1\nserial = \"BOARD-T-1\"\nbatch = 8\n", "lab.toml");
  auto board = Registry<BoardKind>::instance().find("hid_board")->make(*table, **world);
  ASSERT_TRUE(board) << board.error().to_text();
  const auto opened = (*board)->open();
  EXPECT_TRUE(opened) << opened.error().to_text();
  std::vector<BoardSample> samples;
  if (opened && (*board)->start()) {
    for (int i = 0; i < 3000 && samples.size() < 400; ++i) {
      (void)(*world)->advance_to((*world)->now_s() + 0.005);
      const auto polled = (*board)->poll(samples);
      EXPECT_TRUE(polled) << polled.error().to_text();
      if (!polled) break;
    }
  }
  (*board)->close();
  stop = true;
  cable.join();
  ASSERT_GE(samples.size(), 400U);
  for (std::size_t i = 1; i < samples.size(); ++i) EXPECT_EQ(samples[i].index, samples[i - 1].index + 1);
  EXPECT_EQ((*board)->counters().frames_bad, 0U);
}

}  // namespace
}  // namespace forcegate
