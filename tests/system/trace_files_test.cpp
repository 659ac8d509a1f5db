#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using Json = nlohmann::json;

TEST(StimulusVerb, WritesThePaperSineAsCsvAndSvg) {
  TemporaryFolder folder;
  const ProcessResult r = forcegate({"stimulus", "sine", "f_Hz=0.5", "A_N=1.05", "m_N=2.15", "--csv",
                                     folder / "s.csv", "--plot", folder / "s.svg", "--json"});
  ASSERT_EQ(r.exit_code, 0) << r.err;
  const Json facts = Json::parse(r.out);
  EXPECT_DOUBLE_EQ(facts["mean_N"], 2.15);
  EXPECT_DOUBLE_EQ(facts["amplitude_N"], 1.05);
  EXPECT_DOUBLE_EQ(facts["lowest_frequency_Hz"], 0.5);

  std::istringstream csv(read_text(folder / "s.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "t_s,F_cmd_N");
  double high = -1.0, low = 99.0, last_t = -1.0;
  std::size_t rows = 0;
  while (std::getline(csv, line)) {
    const double t = std::stod(line), force = std::stod(line.substr(line.find(',') + 1));
    ASSERT_GT(t, last_t);
    last_t = t;
    if (t > facts["excitation_start_s"].get<double>() + 2.0)
      high = std::max(high, force), low = std::min(low, force);
    ++rows;
  }
  EXPECT_EQ(rows, facts["samples"].get<std::size_t>());
  EXPECT_NEAR(high, 3.2, 1e-9);
  EXPECT_NEAR(low, 1.1, 1e-9);
  const std::string svg = read_text(folder / "s.svg");
  EXPECT_THAT(svg, HasSubstr("<svg"));
  EXPECT_THAT(svg, HasSubstr("Force"));
  EXPECT_THAT(svg, HasSubstr("</svg>"));
}

TEST(StimulusVerb, SameSeedSameBytesOtherSeedOtherBytes) {
  TemporaryFolder folder;
  const auto make = [&](const char* name, const char* seed) {
    const ProcessResult r = forcegate(
        {"stimulus", "prbs", "A_N=1.6", "m_N=2.6", "duration_s=30", "--seed", seed, "--csv", folder / name});
    EXPECT_EQ(r.exit_code, 0) << r.err;
    return read_text(folder / name);
  };
  const std::string first = make("a.csv", "7");
  EXPECT_GT(first.size(), 10000u);
  EXPECT_EQ(make("b.csv", "7"), first);
  EXPECT_NE(make("c.csv", "8"), first);
}

TEST(StimulusVerb, RefusesValuesOutOfRangeAndSaysTheRange) {
  const ProcessResult r = forcegate({"stimulus", "sine", "f_Hz=0.5", "A_N=99", "m_N=2"});
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_THAT(r.err, HasSubstr("A_N"));
  EXPECT_THAT(r.err, HasSubstr("help: "));
  EXPECT_EQ(forcegate({"stimulus", "sine", "f_Hz"}).exit_code, 2);
  EXPECT_EQ(forcegate({"stimulus", "sine", "f_Hz=abc"}).exit_code, 2);
  EXPECT_EQ(forcegate({"stimulus", "sine", "f_Hz=nan"}).exit_code, 2);
  EXPECT_EQ(forcegate({"stimulus", "sine", "--rate", "0"}).exit_code, 2);
}

TEST(StimulusVerb, AnUnwritableFileIsAnErrorAndLeavesNothingBehind) {
  TemporaryFolder folder;
  write_text(folder / "file", "x");
  const ProcessResult r =
      forcegate({"stimulus", "sine", "f_Hz=0.5", "A_N=1", "m_N=2", "--csv", folder / "file/s.csv"});
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

class Convert : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string text = "t_s,F_ref_mN,U_V\n";
    for (int i = 0; i < 500; ++i)
      text += std::to_string(i / 1000.0) + "," + std::to_string(1000.0 + 10.0 * std::sin(0.1 * i)) + "," +
              std::to_string(2.0 + 0.01 * i) + "\n";
    write_text(folder / "in.csv", text);
  }
  TemporaryFolder folder;
};

TEST_F(Convert, ThroughHdf5AndMatAndBackKeepsEveryNumber) {
  ASSERT_EQ(forcegate({"convert", folder / "in.csv", folder / "a.csv"}).exit_code, 0);
  ASSERT_EQ(forcegate({"convert", folder / "in.csv", folder / "b.h5"}).exit_code, 0);
  ASSERT_EQ(forcegate({"convert", folder / "b.h5", folder / "c.mat"}).exit_code, 0);
  const ProcessResult last = forcegate({"convert", folder / "c.mat", folder / "d.csv"});
  ASSERT_EQ(last.exit_code, 0) << last.err;
  const std::string direct = read_text(folder / "a.csv");
  EXPECT_THAT(direct, HasSubstr("F_ref_N")) << "millinewton became newton";
  EXPECT_EQ(read_text(folder / "d.csv"), direct);
}

TEST_F(Convert, NeverOverwritesUnasked) {
  write_text(folder / "out.csv", "mine");
  const ProcessResult refused = forcegate({"convert", folder / "in.csv", folder / "out.csv"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--force"));
  EXPECT_EQ(read_text(folder / "out.csv"), "mine");
  EXPECT_EQ(forcegate({"convert", folder / "in.csv", folder / "out.csv", "--force"}).exit_code, 0);
  EXPECT_EQ(forcegate({"convert", folder / "in.csv", folder / "in.csv", "--force"}).exit_code, 2);
}

TEST_F(Convert, SaysWhatIsWrongWithHostileFiles) {
  const std::map<std::string, std::string> files = {{"empty.csv", ""},
                                                    {"header_only.csv", "t_s,F_ref_N\n"},
                                                    {"binary.csv", std::string("\x7f"
                                                                               "ELF\0\0\1\2",
                                                                               8)},
                                                    {"words.csv", "t_s,F_ref_N\nhello,world\n"},
                                                    {"fake.h5", "not an HDF5 file"},
                                                    {"fake.mat", "not a MAT file"},
                                                    {"fake.fgj", "not a journal"}};
  for (const auto& [name, text] : files) {
    write_text(folder / name, text);
    const ProcessResult r = forcegate({"convert", folder / name, folder / "out.h5"});
    EXPECT_EQ(r.exit_code, 2) << name << ": " << r.out;
    EXPECT_THAT(r.err, StartsWith("error: ")) << name;
    EXPECT_FALSE(std::filesystem::exists(folder / "out.h5")) << name;
  }
  EXPECT_EQ(forcegate({"convert", folder / "gone.csv", folder / "out.h5"}).exit_code, 2);
  EXPECT_EQ(forcegate({"convert", folder / "in.csv", folder / "out.xyz"}).exit_code, 2);
}

TEST_F(Convert, MapsForeignColumnsAndSuppliesAClock) {
  write_text(folder / "foreign.csv", "Load cell,Volt\n1.0,2.0\n1.1,2.1\n1.2,2.2\n");
  const std::string out = folder / "out.csv";
  EXPECT_EQ(
      forcegate({"convert", folder / "foreign.csv", out, "--map", "Load cell=F_ref_N", "--map", "Volt=U_V"})
          .exit_code,
      2)
      << "no clock and no rate";
  const ProcessResult r = forcegate({"convert", folder / "foreign.csv", out, "--map", "Load cell=F_ref_N",
                                     "--map", "Volt=U_V", "--rate", "100"});
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_THAT(read_text(out), HasSubstr("0.01,1.1,2.1"));
}

TEST_F(Convert, AMapThatMeetsNoColumnIsAMistakeAndOneOfAnHdf5FileWorks) {
  write_text(folder / "foreign.csv", "t_s,kgf,U_V\n0,1.0,2.0\n1,1.1,2.1\n2,1.2,2.2\n");
  const std::string h5 = folder / "foreign.h5", out = folder / "out.csv";
  ASSERT_EQ(forcegate({"convert", folder / "foreign.csv", h5}).exit_code, 0);
  for (const std::string& from : {folder / "foreign.csv", h5}) {
    const ProcessResult typo = forcegate({"convert", from, out, "--map", "kfg=F_ref_kgf"});
    EXPECT_EQ(typo.exit_code, 2) << from;
    EXPECT_THAT(typo.err, HasSubstr("no record has a column \"kfg\"")) << from;
    EXPECT_FALSE(std::filesystem::exists(out));
  }
  const ProcessResult r = forcegate({"convert", h5, out, "--map", "kgf=F_ref_kgf"});
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_THAT(read_text(out), HasSubstr("0,9.80665,2"));
}

TEST_F(Convert, ATableOfTrialsBecomesOneFileForEach) {
  std::string csv = "trial,t_s,F_ref_mN,U_V\n";
  for (int trial = 1; trial <= 11; ++trial)
    for (int i = 0; i < 60; ++i) csv += std::to_string(trial) + "," + std::to_string(0.01 * i) + "," + std::to_string(1000 * trial + i) + "," + std::to_string(0.1 * trial) + "\n";
  write_text(folder / "all.csv", csv);
  const ProcessResult refused = forcegate({"convert", folder / "all.csv", folder / "one.csv"});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("--split trial"));
  const ProcessResult r = forcegate({"convert", folder / "all.csv", folder / "parts", "--split", "trial", "--json"});
  ASSERT_EQ(r.exit_code, 0) << r.err;
  const Json answer = Json::parse(r.out);
  ASSERT_EQ(answer["parts"].size(), 11u);
  EXPECT_EQ(answer["parts"][10]["part"], "11");
  EXPECT_EQ(answer["parts"][10]["samples"], 60);
  EXPECT_THAT(read_text(folder / "parts/all-11.csv"), StartsWith("t_s,F_ref_N,U_V\n0,11,1.1\n"));
  EXPECT_EQ(forcegate({"convert", folder / "all.csv", folder / "parts", "--split", "trial"}).exit_code, 2) << "overwrites nothing unasked";
  EXPECT_EQ(forcegate({"convert", folder / "all.csv", folder / "parts", "--split", "trial", "--force"}).exit_code, 0);
  ASSERT_EQ(forcegate({"convert", folder / "parts/all-1.csv", folder / "one.h5"}).exit_code, 0);
  EXPECT_THAT(forcegate({"convert", folder / "one.h5", folder / "h5", "--split", "trial"}).err, HasSubstr("--split reads tables of text"));
  EXPECT_THAT(forcegate({"convert", folder / "all.csv", folder / "parts/all-1.csv", "--split", "trial"}).err, HasSubstr("name a folder"));
}

// The limit on the size of a file stands for the full disk.
TEST_F(Convert, AFullDiskIsAnErrorAndLeavesNoFile) {
  std::string csv = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 20000; ++i) csv += std::to_string(0.01 * i) + "," + std::to_string(std::sin(0.01 * i)) + "," + std::to_string(std::cos(0.013 * i)) + "\n";
  write_text(folder / "long.csv", csv);
  for (const char* ending : {"mat", "h5", "csv"})
    for (const char* kilobytes : {"8", "48", "96"}) {
      const std::string out = folder / (std::string("out.") + ending);
      const ProcessResult r = run_process({"bash", "-c", "trap '' XFSZ; ulimit -f \"$0\"; exec \"$@\"", kilobytes, FORCEGATE_BINARY_DIR "/forcegate", "convert", folder / "long.csv", out});
      EXPECT_EQ(r.exit_code, 2) << ending << " " << kilobytes << r.out << r.err;
      EXPECT_THAT(r.err, HasSubstr("file cannot be ")) << ending;
      EXPECT_FALSE(std::filesystem::exists(out)) << ending << " " << kilobytes;
    }
}

TEST(Recover, RefusesWhatIsNoJournalAndKeepsExistingFiles) {
  TemporaryFolder folder;
  write_text(folder / "a.fgj", "nonsense");
  const ProcessResult r = forcegate({"recover", folder / "a.fgj"});
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_THAT(r.err, HasSubstr("error: "));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.h5"));
  write_text(folder / "a.h5", "mine");
  EXPECT_EQ(forcegate({"recover", folder / "a.fgj"}).exit_code, 2);
  EXPECT_EQ(read_text(folder / "a.h5"), "mine");
  EXPECT_EQ(forcegate({"recover", folder / "gone.fgj"}).exit_code, 2);
}

}  // namespace
}  // namespace forcegate::test
