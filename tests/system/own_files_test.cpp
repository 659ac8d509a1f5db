// A verb replaces what it wrote before, and a file of somebody else only when it is told to.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/noise.h"
#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using ::testing::HasSubstr;

constexpr const char* kForeign = "what I wrote last night\n";

class OwnFiles : public ::testing::Test {
 protected:
  TemporaryFolder folder;
  void SetUp() override {
    Noise noise;
    std::string csv = "t_s,F_ref_N,U_V\n";
    for (int i = 0; i < 4000; ++i) {
      const double t = 0.05 * i, F = 2.0 - std::cos(0.1 * t);
      csv += std::to_string(t) + "," + std::to_string(F + 0.004 * noise()) + "," + std::to_string(2.0 * F - 0.2 + 0.003 * noise()) + "\n";
    }
    write_text(folder / "film.csv", csv);
  }
  /// The command writes `file`, replaces its own, leaves a foreign one alone and replaces it with --force.
  void keeps(std::vector<std::string> words, const std::string& file) {
    const auto code = [&] { return forcegate(words, {.folder = folder.path()}).exit_code; };
    EXPECT_NE(code(), 2) << words[0] << " " << file;
    EXPECT_NE(code(), 2) << words[0] << " " << file << ": its own again";
    write_text(folder / file, kForeign);
    const ProcessResult r = forcegate(words, {.folder = folder.path()});
    EXPECT_EQ(r.exit_code, 2) << words[0] << " " << file;
    EXPECT_THAT(r.err, HasSubstr("this command did not write it")) << words[0] << " " << file;
    EXPECT_THAT(r.err, HasSubstr(file));
    EXPECT_EQ(read_text(folder / file), kForeign) << words[0] << " " << file;
    words.push_back("--force");
    EXPECT_NE(code(), 2) << words[0] << " " << file << ": forced";
    EXPECT_NE(read_text(folder / file), kForeign) << words[0] << " " << file;
  }
};

TEST_F(OwnFiles, OfModelsAndPages) {
  keeps({"fit", "film.csv", "-o", "model.toml"}, "model.toml");
  keeps({"add", "hysteresis", "--fit", "film.csv", "-o", "better.toml", "--html", "page.html"}, "better.toml");
  keeps({"add", "hysteresis", "--fit", "film.csv", "-o", "better.toml", "--html", "page.html"}, "page.html");
  keeps({"fit", "film.csv", "-o", "better.toml"}, "better.toml");
  keeps({"diagnose", "film.csv", "--html", "film.html"}, "film.html");
  keeps({"compare", "film.csv", "--html", "film.html"}, "film.html");
}

TEST_F(OwnFiles, OfPicturesModelCurvesAndLeagues) {
  keeps({"diagnose", "film.csv", "--pictures", "pictures"}, "pictures/records.svg");
  keeps({"simulate", "film.csv", "-o", "curves"}, "curves/film.csv");
  keeps({"league", "--only", "none", "--controls", "1", "--out", "league.json"}, "league.json");
}

TEST_F(OwnFiles, OfACalibration) {
  keeps({"bench", "calibrate", FORCEGATE_SOURCE_DIR "/rigs/twin.toml", "sensor", "-o", "cal.toml"}, "cal.toml");
}

TEST_F(OwnFiles, OfAStudy) {
  for (const char* file : {"study.json", "sheet-recording.html", "sheet-recording.json", "recording.toml", "calibration-recording-film.csv-s0.toml"})
    keeps({"characterize", "--record", "film.csv", "-o", "mine"}, std::string("mine/") + file);
}

}  // namespace
}  // namespace forcegate::test
