// Literal bytes of each instrument: what the tables say, what the twin writes, what the adapter understands.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "adapters/ati/digital.h"
#include "adapters/ati/rdt.h"
#include "adapters/ati/record.h"
#include "adapters/hid/report_line.h"
#include "adapters/link/frame.h"
#include "adapters/link/messages.h"
#include "adapters/modbus/register_map.h"
#include "rigs/emulated/twins/ati_controller.h"
#include "rigs/emulated/twins/board_frame.h"
#include "rigs/emulated/twins/digital_ft.h"
#include "rigs/emulated/twins/drive.h"
#include "rigs/emulated/twins/netft.h"

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
  EXPECT_EQ(emulated::modbus_reply(drive, Bytes{0x06, 0x01, 0x06, 0x12, 0x34}),
            (Bytes{0x06, 0x01, 0x06, 0x12, 0x34}));
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
  EXPECT_FALSE(
      modbus::decode(r, std::vector<std::uint16_t>{0x0000, 0x7FC0}));  // not a number is never a value
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
  r.type = modbus::WordType::f32;
  EXPECT_EQ(modbus::encode(r, 1e39).error().code, ErrorCode::config);
}

// sequence 7 | F/T sequence 1000007 | status 0 | Fx 3, Fy -2, Fz 1500000, Tx 1, Ty 0, Tz -1
const Bytes kRdtRecord{0x00, 0x00, 0x00, 0x07, 0x00, 0x0F, 0x42, 0x47, 0x00, 0x00, 0x00, 0x00,
                       0x00, 0x00, 0x00, 0x03, 0xFF, 0xFF, 0xFF, 0xFE, 0x00, 0x16, 0xE3, 0x60,
                       0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x00, 0xFF, 0xFF, 0xFF, 0xFF};

TEST(NetFtBytes, ARequestAndARecordAreBigEndian) {
  EXPECT_EQ(ati::encode_rdt(ati::RdtCommand::stream, 0),
            (std::array<std::uint8_t, 8>{0x12, 0x34, 0, 2, 0, 0, 0, 0}));
  EXPECT_EQ(ati::encode_rdt(ati::RdtCommand::bias, 258),
            (std::array<std::uint8_t, 8>{0x12, 0x34, 0, 0x42, 0, 0, 1, 2}));
  EXPECT_EQ(emulated::NetFt::record(7, 1000007, 0, 1500000), kRdtRecord);
  Bytes two = kRdtRecord;
  two.insert(two.end(), kRdtRecord.begin(), kRdtRecord.end());
  std::vector<ati::RdtRecord> records;
  ASSERT_TRUE(ati::decode_rdt(two, records));  // buffered mode: several records in one datagram
  ASSERT_EQ(records.size(), 2U);
  EXPECT_EQ(records[1].rdt_sequence, 7U);
  EXPECT_EQ(records[1].ft_sequence, 1000007U);
  EXPECT_EQ(records[1].counts, (std::array<std::int32_t, 6>{3, -2, 1500000, 1, 0, -1}));
  two.pop_back();
  EXPECT_FALSE(ati::decode_rdt(two, records));
  EXPECT_FALSE(ati::decode_rdt({}, records));
}

TEST(NetFtBytes, StatusTellsOverloadFromFaultFromWarning) {
  EXPECT_EQ(ati::rdt_health(0), ati::RdtHealth::good);
  EXPECT_EQ(ati::rdt_health(0x80010000U), ati::RdtHealth::good);  // a monitor condition only
  EXPECT_EQ(ati::rdt_health(0x80020000U), ati::RdtHealth::saturated);
  EXPECT_EQ(ati::rdt_health(0x90000000U), ati::RdtHealth::fault);  // analogue board
}

TEST(NetFtBytes, APageThatDoesNotTellTheScaleIsRefused) {
  const std::string page =
      "<netft><prodname>Net F/T</prodname><comrdtrate>1000</comrdtrate><cfgcpf>1000000</cfgcpf><scfgfu>lbf</scfgfu></netft>";
  const auto config = ati::parse_netft_page(page);
  ASSERT_TRUE(config) << config.error().to_text();
  EXPECT_EQ(config->counts_per_force, 1e6);
  EXPECT_NEAR(config->newtons_per_unit, 4.44822, 1e-5);
  EXPECT_EQ(config->rate_Hz, 1000.0);
  for (const char* broken : {"<cfgcpf>0</cfgcpf>", "<cfgcpf>-5</cfgcpf>", "<cfgcpf>1e999</cfgcpf>",
                             "<cfgcpf>12x</cfgcpf>", "<cfgcpf>5</cfgcpf><cfgcpf>6</cfgcpf>", ""}) {
    std::string wrong = page;
    wrong.replace(wrong.find("<cfgcpf>"), std::string("<cfgcpf>1000000</cfgcpf>").size(), broken);
    EXPECT_FALSE(ati::parse_netft_page(wrong)) << broken;
  }
}

// gages G0 4, G2 600, G4 11, G1 -7, G3 -450, G5 2: 100000/200 counts of Fz at cos 0.8, sin 0.6, times 1.5 N
const Bytes kGageRecord{0x00, 0x04, 0x02, 0x58, 0x00, 0x0B, 0xFF, 0xF9, 0xFE, 0x3E, 0x00, 0x02, 0x1F};

TEST(DigitalFtBytes, TheGagesStandInTheOrderOfTheManualWithASevenBitSum) {
  EXPECT_EQ(emulated::DigitalFt::record({4, -7, 600, -450, 11, 2}, false), kGageRecord);
  ati::GageRecord record;
  ASSERT_EQ(ati::parse_gages(kGageRecord, record), ati::GageParse::value);
  EXPECT_EQ(record.gage, (std::array<std::int16_t, 6>{4, -7, 600, -450, 11, 2}));
  EXPECT_FALSE(record.status_error);
  Bytes error = kGageRecord;
  error[12] |= 0x80;
  ASSERT_EQ(ati::parse_gages(error, record), ati::GageParse::value);
  EXPECT_TRUE(record.status_error);
  EXPECT_EQ(ati::parse_gages(Bytes(kGageRecord.begin(), kGageRecord.end() - 1), record),
            ati::GageParse::need_more);
  for (std::size_t bit = 0; bit < 8 * 12; ++bit) {
    if (bit % 8 == 7) continue;  // 128 is invisible in a sum modulo 128: range and jumps must tell
    Bytes damaged = kGageRecord;
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    EXPECT_EQ(ati::parse_gages(damaged, record), ati::GageParse::invalid) << bit;
  }
}

TEST(DigitalFtBytes, RequestsAreModbusFrames) {
  EXPECT_EQ(ati::encode_read(0x11, 0x006B, 3), (Bytes{0x11, 0x03, 0x00, 0x6B, 0x00, 0x03, 0x76, 0x87}));
  const std::uint16_t words[] = {0x000A, 0x0102};
  EXPECT_EQ(ati::encode_write(0x11, 1, words),
            (Bytes{0x11, 0x10, 0x00, 0x01, 0x00, 0x02, 0x04, 0x00, 0x0A, 0x01, 0x02, 0xC6, 0xF0}));
  EXPECT_TRUE(ati::decode_frame(Bytes{0x11, 0x03, 0x00, 0x6B, 0x00, 0x03, 0x76, 0x87}, 0x11, 3));
  EXPECT_FALSE(ati::decode_frame(Bytes{0x11, 0x03, 0x00, 0x6B, 0x00, 0x03, 0x76, 0x87}, 0x12, 3));
  EXPECT_FALSE(ati::decode_frame(Bytes{0x11, 0x03, 0x00, 0x6B, 0x00, 0x02, 0x76, 0x87}, 0x11, 3));
}

TEST(DigitalFtBytes, TheCalibrationGivesForceFromGages) {
  const auto block = emulated::DigitalFt::calibration("FT-T-3", 1000000);
  const auto c = ati::decode_calibration(block);
  ASSERT_TRUE(c) << c.error().to_text();
  EXPECT_EQ(c->serial, "FT-T-3");
  EXPECT_EQ(c->part, "SI-20-1");
  EXPECT_EQ(c->newtons_per_unit, 1.0);
  EXPECT_EQ(c->gains_and_offsets[0], 1000);
  EXPECT_EQ(c->gains_and_offsets[11], 2011);
  for (const double force_N : {-4.0, 0.0, 0.15, 3.7}) {
    ati::GageRecord record;
    ASSERT_EQ(ati::parse_gages(
                  emulated::DigitalFt::record(emulated::DigitalFt::gages_of(force_N * 1e6), false), record),
              ati::GageParse::value);
    EXPECT_NEAR(ati::gage_force_N(*c, record, 2), force_N, 2e-4);  // half a gage count
  }
  auto empty = block;
  for (std::size_t i = 32; i < 104; ++i) empty[i] = 0;
  EXPECT_FALSE(ati::decode_calibration(empty));
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

TEST(AtiBytes, ABinaryRecordWithoutASumIsNoneWhereItsFirstByteIsNoError) {
  Bytes record(kAtiBinary.begin(), kAtiBinary.end() - 1);
  for (const int error : {0, 1, 9}) {
    record[0] = static_cast<std::uint8_t>(error);
    EXPECT_EQ(ati::parse_binary(record, false).kind, ati::Parse::value) << error;
  }
  for (const int shifted : {10, 0x7F, 0xFF}) {
    record[0] = static_cast<std::uint8_t>(shifted);
    EXPECT_EQ(ati::parse_binary(record, false).kind, ati::Parse::invalid) << shifted << ": a byte of a count";
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
  EXPECT_EQ(kind("0,     3,    -2,  150,     1,     0,    -1\r\n", 45),
            ati::Parse::invalid);  // a digit was lost
  EXPECT_EQ(kind("0,3,-2,1500,1,0\r\n", 0), ati::Parse::invalid);
  EXPECT_EQ(kind("0,3,-2,1500,1,0,-1,4\r\n", 0), ati::Parse::invalid);
  EXPECT_EQ(kind("0,3,-2,15x0,1,0,-1\r\n", 0), ati::Parse::invalid);
  EXPECT_EQ(kind("0,3,-2,99999,1,0,-1\r\n", 0), ati::Parse::invalid);
  EXPECT_EQ(kind("0,3,-2,1500,1,0,-1\n", 0), ati::Parse::invalid);
  EXPECT_EQ(kind("0,3,-2,1500,1,0,-1\r", 0), ati::Parse::need_more);
}

// docs/protocol.md: SAMPLES, sequence 6, t = 640000 us, answer to 5: index 640, twice {100, 1.5 N, excited}
const Bytes kSamples{0x04, 0x10, 0x82, 0x06, 0x01, 0x03, 0xc4, 0x09, 0x02, 0x05, 0x03, 0x80, 0x02,
                     0x01, 0x02, 0x02, 0x01, 0x01, 0x01, 0x02, 0x64, 0x01, 0x01, 0x05, 0xc0, 0x3f,
                     0x01, 0x64, 0x01, 0x01, 0x08, 0xc0, 0x3f, 0x01, 0x0d, 0x03, 0x94, 0x54, 0x00};

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
