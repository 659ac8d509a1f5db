// What a command reads is there afterwards, byte for byte.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using ::testing::HasSubstr;

std::string short_record(double A_N) {
  std::string text = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 1500; ++i) {
    const double t = 0.02 * i, F = 2.0 + A_N * std::sin(1.3 * t);
    text += std::to_string(t) + "," + std::to_string(F) + "," + std::to_string(2.0 * F + 0.05 * std::sin(97.0 * t)) + "\n";
  }
  return text;
}

std::map<std::string, std::string> bytes_of(const std::filesystem::path& folder) {
  std::map<std::string, std::string> out;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) out[entry.path().string()] = read_text(entry.path());
  return out;
}

TEST(LostFiles, NoVerbWritesOverWhatItReads) {
  TemporaryFolder folder;
  std::filesystem::create_directory(folder / "d");
  write_text(folder / "d/campaign.json", R"({"records": [{"file": "a.csv"}, {"file": "b.csv"}, {"file": "c.csv"}]})");
  for (const auto& [name, A_N] : {std::pair{"d/a.csv", 1.0}, {"d/b.csv", 1.5}, {"d/c.csv", 0.7}, {"one.csv", 1.2}}) write_text(folder / name, short_record(A_N));
  ASSERT_EQ(forcegate({"fit", "d", "-o", "m.toml"}, {.folder = folder.path()}).exit_code, 0);
  const auto before = bytes_of(folder.path());
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"simulate", "d", "-o", "d"},
           {"simulate", "one.csv", "-o", "."},
           {"fit", "d", "-o", "d/a.csv"},
           {"fit", "d", "--model", "m.toml", "-o", "m.toml"},
           {"add", "creep", "--fit", "one.csv", "-o", "one.csv"},
           {"add", "creep", "--fit", "d", "-o", "b.toml", "--html", "b.toml"},
           {"compare", "one.csv", "--html", "one.csv"},
           {"diagnose", "one.csv", "--html", "one.csv"},
           {"diagnose", "d", "--html", "d/campaign.json"},
           {"diagnose", "d/campaign.json", "--html", "d/b.csv"},
           {"next", "d", "-o", "d"},
           {"export", "m.toml", "--c", "m.toml", "--plan", "none"},
           {"export", "m.toml", "--c", "one.csv", "--check", "one.csv"},
           {"export", "m.toml", "--fit", "d", "-o", "d/campaign.json"},
           {"convert", "one.csv", "one.csv", "--force"}}) {
    std::string line;
    for (const std::string& word : words) line += word + " ";
    const ProcessResult r = forcegate(words, {.folder = folder.path()});
    EXPECT_EQ(r.exit_code, 2) << line << r.err;
    for (const char* part : {"error: ", "\n  where: ", "\n  help: "}) EXPECT_THAT(r.err, HasSubstr(part)) << line;
    EXPECT_EQ(bytes_of(folder.path()), before) << line;
  }
}

TEST(LostFiles, WhatAnotherCommandWroteIsReplacedWithForceAlone) {
  TemporaryFolder folder;
  const ProcessOptions here{.folder = folder.path()};
  const std::vector<std::string> profile{"stimulus", "sine", "f_Hz=0.5", "A_N=1", "m_N=2", "--csv", "s.csv"}, header{"export", "flexiforce", "--plan", "none", "--c", "comp.h"};
  for (const auto& [line, file] : {std::pair{profile, "s.csv"}, std::pair{header, "comp.h"}}) {
    write_text(folder / file, "t_s,F_ref_N,U_V\n0,1,2\n");
    const ProcessResult refused = forcegate(line, here);
    EXPECT_EQ(refused.exit_code, 2) << file;
    EXPECT_THAT(refused.err, HasSubstr("add --force to replace it"));
    EXPECT_EQ(read_text(folder / file), "t_s,F_ref_N,U_V\n0,1,2\n");
    std::vector<std::string> forced = line;
    forced.push_back("--force");
    EXPECT_EQ(forcegate(forced, here).exit_code, 0) << file;
    EXPECT_EQ(forcegate(line, here).exit_code, 0) << "it is its own file now: " << file;
  }
}

TEST(LostFiles, LimitsInForceAreReplacedByBlessAlone) {
  TemporaryFolder folder;
  std::filesystem::create_directories(folder / "ci/plans");
  std::filesystem::create_directories(folder / "golden/limits");
  write_text(folder / "ci/plans/smoke.toml", read_text(FORCEGATE_SOURCE_DIR "/ci/plans/smoke.toml"));
  const std::string limits = read_text(FORCEGATE_SOURCE_DIR "/golden/limits/smoke.toml");
  const std::string good = FORCEGATE_BINARY_DIR "/firmware/reference.native.so";
  for (const char* file : {"smoke", "other"}) {  // the file of the plan, and one beside what bless writes
    const std::string path = "golden/limits/" + std::string(file) + ".toml";
    write_text(folder / path, limits);
    for (const std::vector<std::string>& words : {std::vector<std::string>{"limits", good, "--count", "10"}, {"bench", "repeatability", good, "--plan", "smoke", "--count", "5"}}) {
      std::vector<std::string> line = words;
      line.insert(line.end(), {"-o", path});
      const ProcessResult r = forcegate(line, {.folder = folder.path()});
      EXPECT_EQ(r.exit_code, 2) << r.out;
      EXPECT_THAT(r.err, HasSubstr("forcegate bless new.toml --reason"));
      EXPECT_EQ(read_text(folder / path), limits);
    }
    write_text(folder / "golden/limits/CHANGES.md", "");
  }
}

// The limit on the size of a file stands for the full disk.
TEST(LostFiles, AMysteryThatTheDiskCutsOffLeavesNoShortRecording) {
  TemporaryFolder folder;
  const ProcessResult r = run_process({"bash", "-c", "trap '' XFSZ; ulimit -f 300; exec \"$0\" mystery --seed 3 my", FORCEGATE_BINARY_DIR "/forcegate"}, {.folder = folder.path()});
  EXPECT_EQ(r.exit_code, 2) << r.out;
  EXPECT_THAT(r.err, HasSubstr("is the folder writable and the disk not full?"));
  for (const auto& [file, text] : bytes_of(folder.path())) EXPECT_TRUE(text.ends_with('\n') && !file.ends_with(".part")) << file;
}

TEST(LostFiles, AGateThatTheDiskCutsOffTellsItsDecisionAllTheSame) {
  TemporaryFolder folder;
  const auto gated = [&](const std::string& image, const std::string& more) {
    return run_process({"bash", "-c", "trap '' XFSZ; ulimit -f 20; exec \"$0\" gate " FORCEGATE_BINARY_DIR "/firmware/" + image + " --plan " FORCEGATE_SOURCE_DIR "/ci/plans/smoke.toml -o run" + more, FORCEGATE_BINARY_DIR "/forcegate"},
                       {.folder = folder.path(), .timeout = std::chrono::minutes(2)});
  };
  const ProcessResult good = gated("reference.native.so", "");
  EXPECT_EQ(good.exit_code, 2) << good.out << good.err;
  EXPECT_THAT(good.out, HasSubstr("ACCEPT"));
  EXPECT_THAT(good.out, HasSubstr("note: the decision stands, and its folder could not be written"));
  EXPECT_THAT(good.err, HasSubstr("error: cannot write file"));
  const ProcessResult bad = gated("mutants/gain_pct@2.native.so", " --json");
  EXPECT_EQ(bad.exit_code, 1) << bad.err;
  EXPECT_THAT(bad.out, HasSubstr("\"kind\": \"REJECT\""));
  EXPECT_EQ(bad.out.find("\"error\""), std::string::npos) << "one document";
  EXPECT_THAT(bad.err, HasSubstr("error: cannot write file"));
  EXPECT_FALSE(std::filesystem::exists(folder / "run"));
}

TEST(LostFiles, AFolderIsNoFileToConvertInto) {
  TemporaryFolder folder;
  write_text(folder / "one.csv", short_record(1.2));
  for (const char* name : {"dir.csv", "dir.mat", "dir.h5"}) {
    std::filesystem::create_directory(folder / name);
    for (const char* force : {"-f", "-q"}) {
      const ProcessResult r = forcegate({"convert", force, "one.csv", name}, {.folder = folder.path()});
      EXPECT_EQ(r.exit_code, 2);
      EXPECT_THAT(r.err, HasSubstr("the output is a folder"));
      EXPECT_FALSE(std::filesystem::exists(folder / (std::string(name) + ".part")));
    }
  }
}

TEST(LostFiles, WhatAPipeBringsIsReadOnceAndUsedAsOftenAsItIsAsked) {
  TemporaryFolder folder;
  write_text(folder / "one.csv", short_record(1.2));
  const auto shell = [&](const std::string& line) {
    return run_process({"bash", "-c", "PATH=" FORCEGATE_BINARY_DIR ":$PATH; " + line}, {.folder = folder.path(), .timeout = std::chrono::minutes(1)});
  };
  // below the first line, which names the file
  const auto figures = [](const ProcessResult& r) { return r.out.substr(r.out.find("mV"), r.out.find("\nnext: ") - r.out.find("mV")); };
  std::filesystem::create_directory(folder / "a");
  const ProcessResult file = shell("cp one.csv stdin; forcegate compare stdin");
  ASSERT_EQ(file.exit_code, 0) << file.err;
  const ProcessResult piped = shell("cat one.csv | forcegate compare /dev/stdin");
  EXPECT_EQ(piped.exit_code, 0) << piped.err;
  EXPECT_EQ(figures(piped), figures(file));
  const ProcessResult fifo = shell("mkfifo a/stdin; cat one.csv > a/stdin & forcegate compare a/stdin");
  EXPECT_EQ(fifo.exit_code, 0) << fifo.err;
  EXPECT_EQ(figures(fifo), figures(file));
  // the campaign is read again for the last line and for the page
  const ProcessResult twice = shell("cat one.csv | forcegate add creep --fit /dev/stdin --html page.html");
  EXPECT_EQ(twice.exit_code, 0) << twice.err;
  const ProcessResult hdf5 = shell("forcegate convert one.csv one.h5 && cat one.h5 | forcegate compare /dev/stdin");
  EXPECT_EQ(hdf5.exit_code, 2);
  EXPECT_THAT(hdf5.err, HasSubstr("cannot be read from a pipe"));
}

TEST(LostFiles, AFileWhoseNameBeginsWithAHyphenIsNoOptionOfTheNextLine) {
  TemporaryFolder folder;
  write_text(folder / "-q.csv", short_record(1.2));
  const ProcessResult r = forcegate({"compare", "--", "-q.csv"}, {.folder = folder.path()});
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("next: forcegate diagnose ./-q.csv\n"));
  const auto next_of = [&](const std::vector<std::string>& words) {
    const ProcessResult said = forcegate(words, {.folder = folder.path()});
    const std::size_t at = said.out.rfind("next: ");
    return at == std::string::npos ? said.err : said.out.substr(at);
  };
  EXPECT_THAT(next_of({"convert", "--", "-q.csv", "-r.csv"}), HasSubstr("forcegate diagnose ./-r.csv"));
  EXPECT_THAT(next_of({"mystery", "--seed", "3", "--minutes", "1", "--", "-m"}), HasSubstr("forcegate diagnose ./-m\n"));
  EXPECT_THAT(next_of({"export", "--check", "./-q.csv", "--", "flexiforce"}), HasSubstr("forcegate export --check ./-q.csv flexiforce --c comp.h")) << "the word -- is not said again, what stands behind it is";
  ASSERT_EQ(forcegate({"fit", "-o", "./-m.toml", "--", "-q.csv"}, {.folder = folder.path()}).exit_code, 0);
  EXPECT_THAT(next_of({"history", "--", "-m.toml"}), HasSubstr(" ./-m.toml"));
}

}  // namespace
}  // namespace forcegate::test
