#include <gtest/gtest.h>

#include "adapters/link/cobs.h"
#include "adapters/link/crc32.h"
#include "adapters/link/frame.h"
#include "adapters/link/messages.h"
#include "hil/base/rng.h"

namespace forcegate::link {
namespace {

using Bytes = std::vector<std::uint8_t>;

Frame any_frame(Rng& rng, std::size_t size) {
  Frame f;
  f.type = static_cast<std::uint8_t>(rng.next());
  f.sequence = static_cast<std::uint16_t>(rng.next());
  f.t_us = static_cast<std::uint32_t>(rng.next());
  for (std::size_t i = 0; i < size; ++i)
    f.payload.push_back(rng.uniform() < 0.3 ? 0 : static_cast<std::uint8_t>(rng.next()));
  return f;
}

bool same(const Frame& a, const Frame& b) {
  return a.version == b.version && a.type == b.type && a.sequence == b.sequence && a.t_us == b.t_us &&
         a.payload == b.payload;
}

TEST(Link, CrcHasTheStandardCheckValue) {
  const std::string text = "123456789";
  EXPECT_EQ(crc32(Bytes(text.begin(), text.end())), 0xCBF43926U);
}

TEST(Link, CobsGivesTheBytesOfThePublishedExamples) {
  EXPECT_EQ(cobs_encode(Bytes{0}), (Bytes{1, 1}));
  EXPECT_EQ(cobs_encode(Bytes{0x11, 0x22, 0, 0x33}), (Bytes{3, 0x11, 0x22, 2, 0x33}));
  Bytes long_run(254, 7);
  Bytes expected{255};
  expected.insert(expected.end(), 254, 7);
  EXPECT_EQ(cobs_encode(long_run), expected);
}

TEST(Link, HelloIsTheFrameOfTheProtocolDocument) {
  Frame hello;
  hello.type = 1;
  hello.payload = hello_payload(0x12345678);
  EXPECT_EQ(encode(hello), (Bytes{0x03, 0x10, 0x01, 0x01, 0x01, 0x01, 0x01, 0x01, 0x09, 0x78, 0x56, 0x34,
                                  0x12, 0x9d, 0xac, 0x6a, 0x38, 0x00}));
}

TEST(Link, EveryFrameComesBackAsItWent) {
  Rng rng(1);
  for (int i = 0; i < 20000; ++i) {
    const Frame f = any_frame(rng, rng.next() % (kPayloadMax + 1));
    const Bytes bytes = encode(f);
    ASSERT_LE(bytes.size(), kEncodedMax);
    const auto r = parse(bytes);
    ASSERT_EQ(r.kind, Parse::value);
    ASSERT_EQ(r.consumed, bytes.size());
    ASSERT_TRUE(same(r.frame, f));
  }
}

TEST(Link, NoSingleBitFlipIsEverAccepted) {
  Rng rng(2);
  for (int i = 0; i < 60; ++i) {
    Bytes bytes = encode(any_frame(rng, static_cast<std::size_t>(i) * 4));
    for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
      bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
      for (std::span<const std::uint8_t> rest(bytes); !rest.empty();) {
        const auto r = parse(rest);
        ASSERT_NE(r.kind, Parse::value) << "bit " << bit;
        if (r.kind == Parse::need_more) break;
        rest = rest.subspan(r.consumed);
      }
      bytes[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    }
  }
}

TEST(Link, ATruncatedFrameWaitsAndThenTheNextOneIsFound) {
  Rng rng(3);
  const Frame f = any_frame(rng, 40), next = any_frame(rng, 5);
  const Bytes bytes = encode(f), tail = encode(next);
  for (std::size_t cut = 0; cut + 1 < bytes.size(); ++cut) {
    EXPECT_EQ(parse(std::span(bytes).first(cut)).kind, Parse::need_more) << cut;
    Bytes stream(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(cut));
    stream.push_back(0);
    stream.insert(stream.end(), tail.begin(), tail.end());
    auto r = parse(stream);
    if (cut > 0) {
      ASSERT_EQ(r.kind, Parse::invalid) << cut;
      r = parse(std::span(stream).subspan(r.consumed));
    }
    ASSERT_EQ(r.kind, Parse::value) << cut;
    EXPECT_TRUE(same(r.frame, next));
  }
}

TEST(Link, DuplicatedBytesAreRefused) {
  Rng rng(4);
  const Bytes bytes = encode(any_frame(rng, 60));
  for (std::size_t at = 0; at + 1 < bytes.size(); ++at) {
    Bytes doubled = bytes;
    doubled.insert(doubled.begin() + static_cast<std::ptrdiff_t>(at), bytes[at]);
    EXPECT_EQ(parse(doubled).kind, Parse::invalid) << at;
  }
}

TEST(Link, RandomBytesAreNeverAFrame) {
  Rng rng(5);
  for (int i = 0; i < 20000; ++i) {
    Bytes noise(rng.next() % 300);
    for (auto& b : noise) b = static_cast<std::uint8_t>(rng.next());
    for (std::span<const std::uint8_t> rest(noise); !rest.empty();) {
      const auto r = parse(rest);
      ASSERT_NE(r.kind, Parse::value);
      if (r.kind == Parse::need_more) break;
      ASSERT_GT(r.consumed, 0U);
      rest = rest.subspan(r.consumed);
    }
  }
}

TEST(Link, PayloadsOfAnotherLengthAreNotGuessed) {
  const Bytes samples{5, 0, 0x80, 2,    0, 0,   2, 0, 0, 0,    0,    100, 0,
                      0, 0, 0xC0, 0x3F, 1, 100, 0, 0, 0, 0xC0, 0x3F, 1};
  const auto good = decode_samples(samples);
  ASSERT_TRUE(good);
  EXPECT_EQ(good->first_index, 640U);
  ASSERT_EQ(good->sample.size(), 2U);
  EXPECT_EQ(good->sample[1].force_N, 1.5F);
  for (std::size_t n = 0; n < samples.size(); ++n)
    EXPECT_FALSE(decode_samples(std::span(samples).first(n))) << n;
  Bytes longer = samples;
  longer.push_back(0);
  EXPECT_FALSE(decode_samples(longer));
  EXPECT_FALSE(decode_nak(longer));
  EXPECT_FALSE(decode_info(longer));
  EXPECT_FALSE(decode_param_value(longer));
}

}  // namespace
}  // namespace forcegate::link
