// Literal bytes of each instrument: what the tables say, what the twin writes, what the adapter understands.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "adapters/ati/record.h"
#include "adapters/hid/report_line.h"
#include "adapters/link/frame.h"
#include "adapters/link/messages.h"
#include "adapters/modbus/register_map.h"
#include "rigs/emulated/twins/ati_controller.h"
#include "rigs/emulated/twins/board_frame.h"
#include "rigs/emulated/twins/drive.h"

namespace forcegate {
namespace {

using emulated::Bytes;

TEST(ModbusBytes, ChecksumIsTheOneOfTheSpecification) {
  const Bytes request{0x11, 0x03, 0x00, 0x6B, 0x00, 0x03};  // "read holding registers 108 to 110 of slave 17"
  EXPECT_EQ(emulated::modbus_crc16(request), 0x8776);       // on the wire 76 87
}

TEST(ModbusBytes, ADriveAnswersStatusAndPosition) {
  emulated::Drive drive;
  drive.see(1.0, 0.0, false);  // 131072 / 2 pi counts
  EXPECT_EQ(emulated::modbus_reply(drive, Bytes{0x03, 0x01, 0x00, 0x00, 0x04}),
            (Bytes{0x03, 0x08, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x51, 0x7D}));
  EXPECT_EQ(emulated::modbus_reply(drive, Bytes{0x03, 0x40, 0x00, 0x00, 0x01}), (Bytes{0x83, 0x02}));
  EXPECT_EQ(emulated::modbus_reply(drive, Bytes{0x2B, 0x0E}), (Bytes{0xAB, 0x01}));
  EXPECT_EQ(emulated::modbus_reply(drive, Bytes{0x06, 0x01, 0x06, 0x12, 0x34}), (Bytes{0x06, 0x01, 0x06, 0x12, 0x34}));
}

TEST(ModbusBytes, SignedValuesCrossBothWordOrders) {
  modbus::Register r;
  r.name = "velocity";
  r.type = modbus::WordType::i32;
  r.scale = 10000.0;
  const auto words = modbus::encode(r, -1.5);
  ASSERT_TRUE(words);
  EXPECT_EQ(*words, (std::vector<std::uint16_t>{0xFFFF, 0xC568}));  // -15000
  EXPECT_DOUBLE_EQ(modbus::decode(r, *words).value(), -1.5);
  r.high_word_first = false;
  EXPECT_EQ(modbus::encode(r, -1.5).value(), (std::vector<std::uint16_t>{0xC568, 0xFFFF}));
  r.type = modbus::WordType::f32;
  r.scale = 1.0;
  EXPECT_FALSE(modbus::decode(r, std::vector<std::uint16_t>{0x0000, 0x7FC0}));  // not a number is never a value
}

TEST(ModbusBytes, AValueBeyondItsLimitsIsNeverEncoded) {
  modbus::Register r;
  r.name = "velocity";
  r.type = modbus::WordType::i16;
  r.low = -10.0;
  r.high = 10.0;
  EXPECT_EQ(modbus::encode(r, 10.5).error().code, ErrorCode::safety);
  EXPECT_EQ(modbus::encode(r, std::nan("")).error().code, ErrorCode::safety);
  r.low = r.high = std::nullopt;
  EXPECT_EQ(modbus::encode(r, 40000.0).error().code, ErrorCode::config);
}

// error 0 | Fx 3, Fy -2, Fz 1500, Tx 1, Ty 0, Tz -1 | sum of the bytes modulo 256
const Bytes kAtiBinary{0x00, 0x00, 0x03, 0xFF, 0xFE, 0x05, 0xDC, 0x00, 0x01, 0x00, 0x00, 0xFF, 0xFF, 0xE0};

TEST(AtiBytes, TheBinaryRecordIsBigEndianWithASumBehindIt) {
  EXPECT_EQ(emulated::AtiController::binary_record(0, 1500, true), kAtiBinary);
  const auto parsed = ati::parse_binary(kAtiBinary, true);
  ASSERT_EQ(parsed.kind, ati::Parse::value);
  EXPECT_EQ(parsed.consumed, 14U);
  EXPECT_EQ(parsed.record.counts, (std::array<int, 6>{3, -2, 1500, 1, 0, -1}));
}

TEST(AtiBytes, EveryFlippedBitOfABinaryRecordIsSeen) {
  for (std::size_t bit = 0; bit < 8 * kAtiBinary.size(); ++bit) {
    Bytes damaged = kAtiBinary;
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    EXPECT_EQ(ati::parse_binary(damaged, true).kind, ati::Parse::invalid) << bit;
  }
}

TEST(AtiBytes, TheAsciiRecordHasFortyFiveBytes) {
  const std::string text = "0,     3,    -2,  1500,     1,     0,    -1\r\n";
  const Bytes bytes(text.begin(), text.end());
  EXPECT_EQ(emulated::AtiController::ascii_record(0, 1500), bytes);
  ASSERT_EQ(bytes.size(), 45U);
  const auto parsed = ati::parse_ascii(bytes, 0);
  ASSERT_EQ(parsed.kind, ati::Parse::value);
  EXPECT_EQ(parsed.record.counts, (std::array<int, 6>{3, -2, 1500, 1, 0, -1}));
}

TEST(AtiBytes, AnAsciiLineThatIsNotExactlyARecordIsNone) {
  const auto kind = [](const std::string& line, std::size_t width) {
    return ati::parse_ascii({reinterpret_cast<const std::uint8_t*>(line.data()), line.size()}, width).kind;
  };
  EXPECT_EQ(kind("0,     3,    -2,  150,     1,     0,    -1\r\n", 45), ati::Parse::invalid);  // a digit was lost
  EXPECT_EQ(kind("0,3,-2,1500,1,0\r\n", 0), ati::Parse::invalid);
  EXPECT_EQ(kind("0,3,-2,1500,1,0,-1,4\r\n", 0), ati::Parse::invalid);
  EXPECT_EQ(kind("0,3,-2,15x0,1,0,-1\r\n", 0), ati::Parse::invalid);
  EXPECT_EQ(kind("0,3,-2,99999,1,0,-1\r\n", 0), ati::Parse::invalid);
  EXPECT_EQ(kind("0,3,-2,1500,1,0,-1\n", 0), ati::Parse::invalid);
  EXPECT_EQ(kind("0,3,-2,1500,1,0,-1\r", 0), ati::Parse::need_more);
}

// docs/protocol.md: SAMPLES, sequence 6, t = 640000 us, answer to 5: index 640, twice {100, 1.5 N, excited}
const Bytes kSamples{0x04, 0x10, 0x82, 0x06, 0x01, 0x03, 0xc4, 0x09, 0x02, 0x05, 0x03, 0x80, 0x02, 0x01, 0x02,
                     0x02, 0x01, 0x01, 0x01, 0x02, 0x64, 0x01, 0x01, 0x05, 0xc0, 0x3f, 0x01, 0x64, 0x01, 0x01,
                     0x08, 0xc0, 0x3f, 0x01, 0x0d, 0x03, 0x94, 0x54, 0x00};

TEST(BoardBytes, TheTwinWritesTheWorkedExampleOfTheProtocol) {
  emulated::BoardFrame frame;
  frame.type = 0x82;
  frame.sequence = 6;
  frame.t_us = 640000;
  emulated::put_u16(frame.payload, 5);
  emulated::put_u32(frame.payload, 640);
  frame.payload.push_back(2);
  emulated::put_u32(frame.payload, 0);
  for (int i = 0; i < 2; ++i) {
    emulated::put_u16(frame.payload, 100);
    emulated::put_f32(frame.payload, 1.5F);
    frame.payload.push_back(1);
  }
  EXPECT_EQ(emulated::frame_bytes(frame), kSamples);
}

TEST(BoardBytes, TheAdapterReadsTheWorkedExampleOfTheProtocol) {
  const auto parsed = link::parse(kSamples);
  ASSERT_EQ(parsed.kind, link::Parse::value);
  const auto samples = link::decode_samples(parsed.frame.payload);
  ASSERT_TRUE(samples);
  EXPECT_EQ(samples->first_index, 640U);
  ASSERT_EQ(samples->sample.size(), 2U);
  EXPECT_EQ(samples->sample[1].force_N, 1.5F);
}

TEST(BoardBytes, StreamStartIsOneDividerAndBatch) {
  link::Frame frame;
  frame.type = 0x02;
  frame.sequence = 3;
  frame.payload = link::stream_payload(true, 1, 10);
  const Bytes bytes = link::encode(frame);
  const auto seen = emulated::frame_of({bytes.data(), bytes.size() - 1});
  ASSERT_TRUE(seen);
  EXPECT_EQ(seen->payload, (Bytes{1, 1, 0, 10}));
  EXPECT_EQ(link::decode_stream_state(Bytes{3, 0, 1, 1, 0, 10})->running, true);
  EXPECT_FALSE(link::decode_stream_state(Bytes{3, 0, 2, 1, 0, 10}));
}

TEST(HidBytes, AReportIsItsLengthAndUpToSixtyThreeBytes) {
  const hid::Report report = hid::pack(Bytes{0xAA, 0xBB});
  EXPECT_EQ(report[0], 2);
  EXPECT_EQ(report[2], 0xBB);
  EXPECT_EQ(report[3], 0);
  const auto used = hid::unpack(report);
  ASSERT_TRUE(used);
  EXPECT_EQ(Bytes(used->begin(), used->end()), (Bytes{0xAA, 0xBB}));
  hid::Report broken = report;
  broken[0] = 64;
  EXPECT_FALSE(hid::unpack(broken));
}

}  // namespace
}  // namespace forcegate
