#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <thread>

#include "hil/base/rng.h"
#include "hil/trace/convert.h"
#include "hil/trace/hdf5_io.h"
#include "hil/trace/mat_io.h"
#include "hil/trace/missing_count.h"
#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

using Storage = FolderTest;

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

TEST_F(Storage, AnHdf5FileHoldsNoTimeOfItsWriting) {
  Trace trace;
  trace.time_bases.emplace_back();
  trace.time_bases[0].t_s = {0.0, 1.0};
  trace.channels = {{"U", "V", "voltage", 0, {1.0, 2.0}, {}}};
  trace.provenance = {{"firmware", std::string(40000, 'f')}};
  ASSERT_TRUE(write_hdf5(trace, folder_ / "a.h5"));
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  ASSERT_TRUE(write_hdf5(trace, folder_ / "b.h5"));
  EXPECT_EQ(bytes_of(folder_ / "a.h5"), bytes_of(folder_ / "b.h5"));
}

TEST_F(Storage, TheColumnsOfAnHdf5FileCanBeMappedAsThoseOfText) {
  Trace trace;
  trace.time_bases.emplace_back();
  trace.time_bases[0].t_s = {0.0, 1.0};
  trace.channels = {{"kgf", "", "", 0, {1.0, 2.0}, {}}, {"sensor", "V", "voltage", 0, {3.0, 4.0}, {}}};
  ASSERT_TRUE(write_hdf5(trace, folder_ / "a.h5"));
  const auto file = read_trace(folder_ / "a.h5", {.column_map = {{"kgf", "F_ref_N"}, {"sensor_V", "U_V"}, {"other", "U_V"}}});
  ASSERT_TRUE(file) << file.error().to_text();
  ASSERT_NE(file->trace.find("F_ref"), nullptr);
  ASSERT_NE(file->trace.find("U"), nullptr);
  EXPECT_EQ(file->trace.find("F_ref")->unit, "N");
  EXPECT_DOUBLE_EQ(file->trace.find("F_ref")->value[1], 2 * 9.80665);
  EXPECT_DOUBLE_EQ(file->trace.find("U")->value[1], 4.0);
  EXPECT_THAT(file->notes, Contains(HasSubstr("was read in kgf, as it is called")));
  EXPECT_THAT(file->mapped, ::testing::ElementsAre("kgf", "sensor_V"));
}

Trace sample_trace() {
  Trace trace;
  trace.name = "run 7";
  trace.provenance = {{"seed", "7"}, {"firmware", std::string(40000, 'f')}, {"note", ""}};
  TimeBase rig, ati;
  rig.device = "rig";
  rig.nominal_rate_Hz = 1000;
  ati.device = "ati";
  ati.invented = true;
  Channel u{"U", "V", "voltage", 0, {}, {}}, f{"F_ref", "N", "force", 1, {}, {}},
      flags{"flags", "counts", "code", 0, {}, {}};
  Rng rng(1, "trace");
  for (int i = 0; i < 70000; ++i) {
    rig.t_s.push_back(i * 1e-3 + (i >= 100 ? 0.5 : 0.0));
    u.value.push_back(i % 13 == 0 ? kMissing : rng.normal());
    u.raw.push_back(i % 65536);
    flags.raw.push_back(i % 7);
    flags.value.push_back(i % 7);
  }
  rig.gaps.push_back({100, 0.099, 0.6});
  for (int i = 0; i < 500; ++i) {
    ati.t_s.push_back(i * 0.01);
    f.value.push_back(i);
  }
  trace.time_bases = {rig, ati};
  trace.channels = {u, f, flags};
  return trace;
}

bool same(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin(), [](double x, double y) {
           return x == y || (std::isnan(x) && std::isnan(y));
         });
}

TEST_F(Storage, Hdf5ReturnsTheTraceAsItWas) {
  const Trace trace = sample_trace();
  ASSERT_TRUE(write_hdf5(trace, folder_ / "a.h5"));
  EXPECT_FALSE(fs::exists(folder_ / "a.h5.part"));
  const auto back = read_hdf5(folder_ / "a.h5");
  ASSERT_TRUE(back) << back.error().to_text();
  EXPECT_EQ(back->trace.name, trace.name);
  EXPECT_EQ(back->trace.provenance, trace.provenance);
  ASSERT_EQ(back->trace.time_bases.size(), 2u);
  EXPECT_EQ(back->trace.time_bases[0].t_s, trace.time_bases[0].t_s);
  EXPECT_EQ(back->trace.time_bases[0].nominal_rate_Hz, 1000.0);
  ASSERT_EQ(back->trace.time_bases[0].gaps.size(), 1u);
  EXPECT_EQ(back->trace.time_bases[0].gaps[0].to_s, 0.6);
  EXPECT_TRUE(back->trace.time_bases[1].invented);
  EXPECT_EQ(back->trace.time_bases[1].device, "ati");
  ASSERT_EQ(back->trace.channels.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(back->trace.channels[i].name, trace.channels[i].name);
    EXPECT_EQ(back->trace.channels[i].unit, trace.channels[i].unit);
    EXPECT_EQ(back->trace.channels[i].time_base, trace.channels[i].time_base);
    EXPECT_TRUE(same(back->trace.channels[i].value, trace.channels[i].value));
    EXPECT_EQ(back->trace.channels[i].raw, trace.channels[i].raw);
  }
}

TEST_F(Storage, TextWithTheEndingOfHdf5IsToldAsThat) {
  std::ofstream(folder_ / "table.h5") << "t_s,F_ref_N,U_V\n0,1,2\n";
  EXPECT_THAT(read_hdf5(folder_ / "table.h5").error().hint, HasSubstr("give it the ending .csv"));
  std::ofstream(folder_ / "cut.h5") << "\x89HDF\r\n\x1a\n";
  EXPECT_THAT(read_hdf5(folder_ / "cut.h5").error().hint, HasSubstr("cut short"));
}

TEST_F(Storage, Hdf5RefusesForeignAndDamagedFiles) {
  std::ofstream(folder_ / "a.h5") << "no";
  EXPECT_THAT(read_hdf5(folder_ / "a.h5").error().text, HasSubstr("not an HDF5 file"));
  EXPECT_EQ(read_hdf5(folder_ / "b.h5").error().code, ErrorCode::io);
  ASSERT_TRUE(write_hdf5(sample_trace(), folder_ / "c.h5"));
  fs::resize_file(folder_ / "c.h5", fs::file_size(folder_ / "c.h5") / 2);
  EXPECT_FALSE(read_hdf5(folder_ / "c.h5"));
  EXPECT_EQ(write_hdf5(sample_trace(), folder_ / "nowhere" / "d.h5").error().code, ErrorCode::io);
}

TEST_F(Storage, AnUnfinishedHdf5FileNeverHasTheFinalName) {
  {
    auto writer =
        Hdf5Writer::create(folder_ / "a.h5", {{"rig", 1000}}, {{"U", "V", "voltage", SampleType::f32, 0}});
    ASSERT_TRUE(writer);
    EXPECT_TRUE(fs::exists(folder_ / "a.h5.part"));
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Storage, MatReturnsTheColumns) {
  Trace trace = sample_trace();
  trace.time_bases.pop_back();
  trace.channels.erase(trace.channels.begin() + 1);
  trace.provenance.erase("note");
  ASSERT_TRUE(write_mat(trace, folder_ / "a.mat"));
  const auto back = read_mat(folder_ / "a.mat");
  ASSERT_TRUE(back) << back.error().to_text();
  EXPECT_EQ(back->trace.time_bases[0].t_s, trace.time_bases[0].t_s);
  EXPECT_TRUE(same(back->trace.find("U")->value, trace.channels[0].value));
  EXPECT_EQ(back->trace.find("U")->raw, trace.channels[0].raw);
  EXPECT_EQ(back->trace.provenance, trace.provenance);
  std::ofstream(folder_ / "b.mat") << "no MAT file at all";
  EXPECT_EQ(read_mat(folder_ / "b.mat").error().code, ErrorCode::parse);
}

// What the gate keeps has channels of nothing but counts: status and flags.
TEST_F(Storage, AChannelOfCountsIsOneColumnInEveryFormat) {
  Trace trace;
  trace.time_bases.emplace_back();
  trace.time_bases[0].t_s = {0.0, 0.001, 0.002};
  trace.channels = {{"F_ref", "N", "force", 0, {1.0, 1.5, 2.0}, {}},
                    {"U", "V", "voltage", 0, {1.0, 2.0, 3.0}, {6553, 13107, 19660}},
                    {"status", "counts", "status", 0, {0.0, 1.0, 0.0}, {0, 1, 0}}};
  ASSERT_TRUE(write_csv(trace, folder_ / "a.csv"));
  std::string header;
  std::ifstream file(folder_ / "a.csv");
  std::getline(file, header);
  EXPECT_EQ(header, "t_s,F_ref_N,U_V,U_counts,status_counts");
  ASSERT_TRUE(write_mat(trace, folder_ / "a.mat"));
  for (const char* name : {"a.csv", "a.mat"}) {
    const auto back = read_trace(folder_ / name, {});
    ASSERT_TRUE(back) << name << " " << back.error().to_text();
    ASSERT_NE(back->trace.find("U"), nullptr) << name;
    EXPECT_EQ(back->trace.find("U")->raw, trace.channels[1].raw) << name;
    ASSERT_NE(back->trace.find("status"), nullptr) << name;
    EXPECT_EQ(back->trace.find("status")->value, trace.channels[2].value) << name;
  }
}

TEST_F(Storage, AMatFileThatIsCutShortOrDamagedIsRefused) {
  Trace trace;
  trace.time_bases.push_back({});
  trace.channels.resize(2);
  trace.channels[0] = {"F_ref", "N", "force", 0, {}, {}};
  trace.channels[1] = {"U", "V", "voltage", 0, {}, {}};
  Rng rng(7, "mat");
  for (int i = 0; i < 3000; ++i) {
    trace.time_bases[0].t_s.push_back(i * 0.01);
    for (Channel& channel : trace.channels) channel.value.push_back(rng.normal());
  }
  ASSERT_TRUE(write_mat(trace, folder_ / "whole.mat"));
  std::ifstream file(folder_ / "whole.mat", std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(file), {}};
  for (const double share : {0.1, 0.5, 0.9}) {
    std::ofstream(folder_ / "cut.mat", std::ios::binary) << whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size())));
    const auto cut = read_mat(folder_ / "cut.mat");
    ASSERT_FALSE(cut) << share;
    EXPECT_THAT(cut.error().text, ::testing::HasSubstr("cut short")) << share;
  }
  std::string damaged = whole;
  damaged.replace(damaged.size() / 2, 40, 40, 'U');
  std::ofstream(folder_ / "damaged.mat", std::ios::binary) << damaged;
  const auto refused = read_mat(folder_ / "damaged.mat");
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().text, ::testing::HasSubstr("damaged"));
  std::string overwritten = whole;
  overwritten.replace(132, 4, "\x64\0\0\0", 4);  // what a full disk leaves of the length of the first variable
  std::ofstream(folder_ / "overwritten.mat", std::ios::binary) << overwritten;
  const auto odd = read_mat(folder_ / "overwritten.mat");
  ASSERT_FALSE(odd);
  EXPECT_EQ(odd.error().text, "the MAT file is damaged: no variable begins at byte 236") << "and no size out of random bytes";
  EXPECT_TRUE(read_mat(folder_ / "whole.mat"));
  std::string level73 = whole.substr(0, 124) + std::string("\0\2IM", 4) + std::string(384, '\0') + "\x89HDF\r\n\x1a\n";
  std::ofstream(folder_ / "v73.mat", std::ios::binary) << level73;
  EXPECT_THAT(read_mat(folder_ / "v73.mat").error().text, ::testing::Not(::testing::HasSubstr("cut short"))) << "its variables stand in HDF5";

  std::string level4;  // three vectors as MATLAB 4 stores them
  const std::vector<double> values(400, 1.0);
  for (const char* name : {"t_s", "F_ref_N", "U_V"}) {
    const std::int32_t head[] = {0, 400, 1, 0, static_cast<std::int32_t>(std::strlen(name)) + 1};
    level4.append(reinterpret_cast<const char*>(head), sizeof head).append(name, std::strlen(name) + 1);
    level4.append(reinterpret_cast<const char*>(values.data()), 8 * values.size());
  }
  std::ofstream(folder_ / "v4.mat", std::ios::binary) << level4.substr(0, level4.size() - 1500);
  const auto cut4 = read_mat(folder_ / "v4.mat");
  ASSERT_FALSE(cut4) << "matio leaves the last variable out";
  EXPECT_THAT(cut4.error().text, ::testing::HasSubstr("cut short"));
}

// Vectors as MATLAB 4 stores them.
std::string level4(std::initializer_list<std::pair<const char*, std::size_t>> vectors) {
  std::string out;
  for (const auto& [name, n] : vectors) {
    const std::int32_t head[] = {0, static_cast<std::int32_t>(n), 1, 0, static_cast<std::int32_t>(std::strlen(name)) + 1};
    out.append(reinterpret_cast<const char*>(head), sizeof head).append(name, std::strlen(name) + 1);
    for (std::size_t i = 0; i < n; ++i) {
      const double value = 0.1 * static_cast<double>(i);
      out.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
  }
  return out;
}

TEST_F(Storage, AVariableThatIsLeftOutSaysWhyAndAForceOfAnotherLengthIsAnError) {
  std::ofstream(folder_ / "short.mat", std::ios::binary) << level4({{"t_s", 400}, {"F_ref_N", 395}, {"U_V", 400}});
  const auto refused = read_mat(folder_ / "short.mat");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().text, "F_ref_N has 395 values, and t_s, U_V have 400");
  EXPECT_THAT(refused.error().hint, HasSubstr("--map F_ref_N=unused"));
  CsvOptions without;
  without.column_map["F_ref_N"] = "unused";
  const auto drift = read_mat(folder_ / "short.mat", without);
  ASSERT_TRUE(drift) << drift.error().to_text();
  EXPECT_THAT(drift->notes, ::testing::Contains("variables left out: F_ref_N (395 values, the record has 400)"));

  std::ofstream(folder_ / "one.mat", std::ios::binary) << level4({{"fs", 1}});
  EXPECT_EQ(read_mat(folder_ / "one.mat").error().text, "the MAT file holds no real numeric vector, only fs (one value)");

  std::ofstream(folder_ / "extra.mat", std::ios::binary) << level4({{"t_s", 400}, {"F_ref_N", 400}, {"U_V", 400}, {"limits", 7}, {"fs", 1}, {"force", 20}});
  const auto read = read_mat(folder_ / "extra.mat");
  ASSERT_TRUE(read) << read.error().to_text();
  EXPECT_THAT(read->notes, ::testing::Contains("variables left out: fs (one value), limits (7 values, the record has 400), force (20 values, the record has 400)"));
}

TEST_F(Storage, ConvertGoesRoundThroughAllFormats) {
  std::ofstream(folder_ / "a.csv")
      << "t_s,F_ref_N,U_V,U_counts\n0,1,2,3\n0.1,1.25,,4\n0.2,3,4,5\n0.3,3,4,6\n";
  ASSERT_TRUE(convert_trace(folder_ / "a.csv", folder_ / "b.h5"));
  ASSERT_TRUE(convert_trace(folder_ / "b.h5", folder_ / "c.mat"));
  ASSERT_TRUE(convert_trace(folder_ / "c.mat", folder_ / "d.csv"));
  std::ifstream file(folder_ / "d.csv");
  std::string text((std::istreambuf_iterator<char>(file)), {});
  EXPECT_EQ(text, "t_s,F_ref_N,U_V,U_counts\n0,1,2,3\n0.1,1.25,,4\n0.2,3,4,5\n0.3,3,4,6\n");
  EXPECT_EQ(convert_trace(folder_ / "a.csv", folder_ / "a.xls").error().code, ErrorCode::config);
  const auto many = write_hdf5(sample_trace(), folder_ / "e.h5");
  ASSERT_TRUE(many);
  EXPECT_THAT(convert_trace(folder_ / "e.h5", folder_ / "e.csv").error().text, HasSubstr("2 time bases"));
}

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

TEST_F(Storage, CountsBelowZeroGoRoundThroughAllFormats) {
  for (const char* text : {"t_s,F_ref_N,U_V,U_counts\n0,1,2,-1\n0.1,1.25,2.5,\n0.2,3,4,-8388608\n0.3,3,4,6\n", "t_s,F_ref_N,U_counts\n0,1,-1\n0.1,1.25,\n0.2,3,-8388608\n0.3,3,6\n"}) {
    std::ofstream(folder_ / "a.csv") << text;
    ASSERT_TRUE(convert_trace(folder_ / "a.csv", folder_ / "b.h5"));
    ASSERT_TRUE(convert_trace(folder_ / "b.h5", folder_ / "c.csv"));
    EXPECT_EQ(text_of(folder_ / "c.csv"), text);
    ASSERT_TRUE(convert_trace(folder_ / "b.h5", folder_ / "d.mat"));
    ASSERT_TRUE(convert_trace(folder_ / "d.mat", folder_ / "e.csv"));
    EXPECT_EQ(text_of(folder_ / "e.csv"), text);
  }
}

// Written when a missing count was -1: counts 3, missing, -7, 6.
TEST_F(Storage, AMissingCountOfAFormerFileIsMissing) {
  for (const char* name : {"former_counts.h5", "former_counts.mat"}) {
    const auto file = read_trace(fs::path(FORCEGATE_SOURCE_DIR "/tests/data/trace") / name, {});
    ASSERT_TRUE(file) << file.error().to_text();
    EXPECT_EQ(file->trace.find("U")->raw, (std::vector<std::int32_t>{3, kMissingCount, -7, 6})) << name;
  }
}

}  // namespace
}  // namespace forcegate
