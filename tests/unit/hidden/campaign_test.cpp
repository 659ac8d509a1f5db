#include "hil/trace/campaign.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "rigs/emulated/hidden/campaign_maker.h"
#include "rigs/emulated/hidden/campaign_writer.h"
#include "rigs/emulated/hidden/seal.h"

namespace forcegate::hidden {
namespace {

namespace fs = std::filesystem;

class Folder {
 public:
  explicit Folder(const std::string& name)
      : path_(fs::path(::testing::TempDir()) / ("forcegate_hidden_" + name)) {
    fs::remove_all(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

MadeCampaign made(std::uint64_t seed, std::vector<std::string> effects, Tier tier = Tier::medium) {
  auto result = make_campaign({seed, "t", std::move(effects), tier, 1.0});
  EXPECT_TRUE(result) << (result ? "" : result.error().to_text());
  return std::move(*result);
}

TEST(HiddenCampaign, TheSameSeedGivesTheSameBits) {
  const MadeCampaign a = made(11, {"creep"}), b = made(11, {"creep"});
  ASSERT_EQ(a.records.size(), b.records.size());
  for (std::size_t r = 0; r < a.records.size(); ++r) {
    EXPECT_EQ(a.records[r].voltage_V, b.records[r].voltage_V);
    EXPECT_EQ(a.records[r].force_ref_N, b.records[r].force_ref_N);
    EXPECT_EQ(a.records[r].stamp_s, b.records[r].stamp_s);
  }
  EXPECT_EQ(to_json(a.truth), to_json(b.truth));
}

TEST(HiddenCampaign, AnotherSeedGivesAnotherBench) {
  const MadeCampaign a = made(11, {}), b = made(12, {});
  EXPECT_NE(a.truth.conditions, b.truth.conditions);
}

TEST(HiddenCampaign, HasFiveToThirteenRecordsWithTwoSinesAndARampFirst) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    const MadeCampaign m = made(seed, {});
    EXPECT_GE(m.records.size(), 5u);
    EXPECT_LE(m.records.size(), 13u);
    EXPECT_EQ(m.records.front().plan.kind, "ramp");
    EXPECT_GE(std::count_if(m.records.begin(), m.records.end(),
                            [](const RecordData& r) { return r.plan.kind == "sine"; }),
              2);
    std::size_t heldout = 0;
    for (const RecordData& r : m.records) heldout += r.plan.heldout;
    EXPECT_GE(heldout, 1u) << "seed " << seed;
    EXPECT_LT(3 * heldout, 2 * m.records.size()) << "seed " << seed;
  }
}

TEST(HiddenCampaign, SignalsStayWithinTheBench) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    for (const RecordData& record : made(seed, {}).records)
      for (std::size_t i = 0; i < record.stamp_s.size(); ++i) {
        ASSERT_GE(record.voltage_V[i], 0.0);
        ASSERT_LT(record.voltage_V[i], 10.0) << "the clean bench never reaches the rail, seed " << seed;
        ASSERT_GT(record.force_ref_N[i], -0.2);
        ASSERT_LT(record.force_ref_N[i], 5.5);
        if (i > 0) {
          ASSERT_GT(record.stamp_s[i], record.stamp_s[i - 1]);
        }
      }
}

TEST(HiddenCampaign, StrongerTiersHideMore) {
  for (const char* name : {"hysteresis", "lag", "clipping", "backlash", "reference_drift"}) {
    const double weak = made(21, {name}, Tier::weak).truth.effects[0].rms_pct;
    const double medium = made(21, {name}, Tier::medium).truth.effects[0].rms_pct;
    const double strong = made(21, {name}, Tier::strong).truth.effects[0].rms_pct;
    EXPECT_LT(weak, medium) << name;
    EXPECT_LT(medium, strong) << name;
  }
}

TEST(HiddenCampaign, APairHoldsBothEffectsWithTheirOwnSizes) {
  const MadeCampaign m = made(31, {"creep", "hum"});
  ASSERT_EQ(m.truth.effects.size(), 2u);
  EXPECT_TRUE(m.truth.effects[0].excited);
  EXPECT_TRUE(m.truth.effects[1].excited);
}

TEST(HiddenCampaign, TheTwinIsTheSameBenchWithNothingHidden) {
  const CampaignRequest request{21, "t", {"thermal"}, Tier::strong, 1.0};
  auto twin = make_twin(request), zero = make_campaign_at(request, {0.0});
  ASSERT_TRUE(twin && zero);
  EXPECT_TRUE(twin->truth.effects.empty());
  EXPECT_EQ(twin->truth.conditions, made(21, {"thermal"}, Tier::strong).truth.conditions);
  ASSERT_EQ(twin->records.size(), zero->records.size());
  for (std::size_t r = 0; r < zero->records.size(); ++r) {
    EXPECT_EQ(twin->records[r].voltage_V, zero->records[r].voltage_V);
    EXPECT_EQ(twin->records[r].force_ref_N, zero->records[r].force_ref_N);
    EXPECT_EQ(twin->records[r].temperature_C, zero->records[r].temperature_C);
    EXPECT_EQ(twin->records[r].plan.heldout, zero->records[r].plan.heldout);
  }
}

TEST(HiddenCampaign, AnUnknownNameIsAUsageErrorWithASuggestion) {
  const auto result = make_campaign({1, "t", {"hysteresys"}, Tier::weak, 1.0});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::usage);
  EXPECT_NE(result.error().hint.find("hysteresis"), std::string::npos);
}

TEST(HiddenCampaign, FilesAreReadBackAsTheyWereMade) {
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    const Folder folder("read" + std::to_string(seed));
    MadeCampaign m = made(seed, {"dropouts"});
    ASSERT_TRUE(write_campaign(m, folder.path(), false));
    const auto read = read_campaign(folder.path());
    ASSERT_TRUE(read) << read.error().to_text();
    const Campaign direct = to_campaign(std::move(m));
    ASSERT_EQ(read->records.size(), direct.records.size());
    EXPECT_EQ(read->bench.adc_bits, direct.bench.adc_bits);
    for (std::size_t r = 0; r < direct.records.size(); ++r) {
      const Record &a = read->records[r], &b = direct.records[r];
      EXPECT_EQ(a.name, b.name);
      EXPECT_EQ(a.role_given, b.role_given);
      EXPECT_EQ(a.role, b.role);
      ASSERT_EQ(a.trace.size(), b.trace.size());
      ASSERT_EQ(a.trace.channels.size(), b.trace.channels.size());
      for (const Channel& channel : b.trace.channels) {
        const Channel* other = a.trace.find(channel.name);
        ASSERT_NE(other, nullptr) << channel.name;
        for (std::size_t i = 0; i < channel.value.size(); i += 37) {
          if (std::isnan(channel.value[i]))
            EXPECT_TRUE(std::isnan(other->value[i]));
          else
            EXPECT_NEAR(channel.value[i], other->value[i], channel.name == "temp" ? 6e-3 : 6e-5)
                << channel.name;
        }
      }
    }
  }
}

TEST(HiddenCampaign, FilesSayNothingOfWhatIsHidden) {
  const Folder folder("silent");
  MadeCampaign m = made(7, {"thermal"});
  ASSERT_TRUE(write_campaign(m, folder.path(), false));
  std::ifstream file(folder.path() / "campaign.json");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_FALSE(text.empty());
  EXPECT_EQ(text.find("thermal"), std::string::npos);
  EXPECT_EQ(text.find("effect"), std::string::npos);
  EXPECT_EQ(text.find("seed"), std::string::npos);
}

TEST(HiddenCampaign, ACampaignThatIsThereIsNotOverwrittenUnasked) {
  const Folder folder("twice");
  const MadeCampaign m = made(7, {});
  ASSERT_TRUE(write_campaign(m, folder.path(), false));
  const auto again = write_campaign(m, folder.path(), false);
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::usage);
  EXPECT_TRUE(write_campaign(m, folder.path(), true));
}

TEST(HiddenCampaign, RecordingsOfAMysteryThatIsOverwrittenGoAndThoseOfAPersonStay) {
  const Folder folder("shorter");
  MadeCampaign m = made(7, {});
  const auto recordings = [&] {
    return std::count_if(fs::directory_iterator(folder.path()), {}, [](const auto& entry) { return entry.path().extension() == ".csv"; });
  };
  ASSERT_TRUE(write_campaign(m, folder.path(), false));
  const auto many = recordings();
  ASSERT_EQ(many, static_cast<std::ptrdiff_t>(m.records.size()));
  m.records.resize(2);
  ASSERT_TRUE(write_campaign(m, folder.path(), true));
  EXPECT_EQ(recordings(), many) << "without a seal the campaign is somebody's";
  m = made(7, {});
  ASSERT_TRUE(write_campaign(m, folder.path(), true));
  ASSERT_TRUE(write_sealed(seal("{}", "00"), folder.path()));
  std::ofstream(folder.path() / "mine.csv") << "t_s,F_ref_N,U_V\n";
  m.records.resize(2);
  ASSERT_TRUE(write_campaign(m, folder.path(), true));
  EXPECT_EQ(recordings(), 3);
  EXPECT_TRUE(fs::exists(folder.path() / "mine.csv"));
}

TEST(Sheet, TruthSurvivesSealingAndOpening) {
  const Truth truth = made(9, {"wear"}).truth;
  const std::string text = to_json(truth);
  const SealedSheet sheet = seal(text, "0123456789abcdef");
  EXPECT_EQ(sheet.commitment.size(), 64u);
  EXPECT_EQ(sheet.sealed.find("wear"), std::string::npos);
  const auto opened = open(sheet);
  ASSERT_TRUE(opened);
  EXPECT_EQ(*opened, text);
  const auto back = truth_from_json(*opened);
  ASSERT_TRUE(back);
  EXPECT_EQ(to_json(*back), text);
}

TEST(Sheet, AChangedSheetDoesNotFitItsCommitment) {
  SealedSheet sheet = seal(to_json(made(9, {"wear"}).truth), "0123456789abcdef");
  sheet.sealed[40] = sheet.sealed[40] == 'A' ? 'B' : 'A';
  EXPECT_FALSE(open(sheet));
  SealedSheet other = seal("{}", "0123456789abcdef");
  other.commitment = sheet.commitment;
  EXPECT_FALSE(open(other));
}

TEST(Sheet, TheCommitmentIsTheHashOfNonceAndSheet) {
  // printf noncetext | sha256sum
  EXPECT_EQ(seal("text", "nonce").commitment,
            "97b9bf91383c4908119931d98ef41d91c2b93901fe7079e946daccbe1c32cba1");
}

}  // namespace
}  // namespace forcegate::hidden
