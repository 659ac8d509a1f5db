// The last line of every answer is a command that works when it is pasted, and no chain of them comes back to where it was.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <set>

#include "tests/support/last_line.h"
#include "tests/support/noise.h"

namespace forcegate::test {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

bool is_an_end(const std::string& command) {
  return command.starts_with("forcegate explain ") || command.find("ci/firmware ") != std::string::npos || command.starts_with("cc -std=c11 ") ||
         command.ends_with(" --help");
}

// All commands of the chain, the last one included; that one is run too.
std::vector<std::string> chain(std::string command, const TemporaryFolder& folder) {
  std::vector<std::string> out;
  std::set<std::string> seen;
  while (out.size() < 15) {
    out.push_back(command);
    EXPECT_TRUE(seen.insert(command).second) << "again: " << ::testing::PrintToString(out);
    const ProcessResult r = pasted(command, folder);
    EXPECT_EQ(r.exit_code, 0) << command << "\n" << r.out << r.err;
    if (r.exit_code != 0 || is_an_end(command)) break;
    if (const std::string file = file_to_look_at(r); !file.empty()) {
      EXPECT_NE(read_text(folder / file), "") << file;
      break;
    }
    command = next_of(r);
    EXPECT_NE(command, "") << out.back() << "\n" << r.out;
    if (command.empty()) break;
  }
  EXPECT_LT(out.size(), 15u) << ::testing::PrintToString(out);
  return out;
}

// Slow triangles, a hold and sines at 100 Hz for 4 minutes; `output` sees time and force.
void write_recording(const std::string& path, const std::function<double(double, double)>& output) {
  Noise noise;
  std::string csv = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 24000; ++i) {
    const double t = 0.01 * i, phase = t / 40.0 - std::floor(t / 40.0);
    const double F = t < 120 ? 0.8 + 2.4 * (phase < 0.5 ? 2.0 * phase : 2.0 - 2.0 * phase)
                   : t < 180 ? 0.8 + 2.2 * std::min(1.0, (t - 120.0) / 2.0)
                             : 3.0 - 2.0 * std::min(1.0, (t - 180.0) / 2.0) + std::sin(3.14159265 * (t - 180.0));
    char row[64];
    std::snprintf(row, sizeof row, "%.2f,%.5f,%.5f\n", t, F + 0.004 * noise(), output(t, F) + 0.003 * noise());
    csv += row;
  }
  write_text(path, csv);
}

TEST(LastLines, NothingMissingLeadsToFirmwareWithAndWithoutAPage) {
  const TemporaryFolder folder;
  write_recording(folder / "my film.csv", [](double, double F) { return 2.0 * F - 0.2; });
  for (const char* page : {"", " --html film.html"}) {
    const std::vector<std::string> steps = chain("forcegate diagnose 'my film.csv'" + std::string(page), folder);
    ASSERT_GE(steps.size(), 3u) << ::testing::PrintToString(steps);
    EXPECT_EQ(steps[1], "forcegate fit 'my film.csv' -o model.toml");
    EXPECT_EQ(steps[2], "forcegate export model.toml --c comp.h");
  }
}

TEST(LastLines, AnEffectThatIsFoundIsAddedAndAskedAboutUntilNothingIsLeft) {
  const TemporaryFolder folder;
  double play = 0.8;
  write_recording(folder / "loop.csv", [&](double, double F) {
    play = std::min(std::max(play, F - 0.3), F + 0.3);
    return 2.0 * (0.9 * F + 0.1 * play) - 0.2;
  });
  const std::vector<std::string> steps = chain("forcegate diagnose loop.csv", folder);
  EXPECT_THAT(steps, ::testing::Contains("forcegate add hysteresis --fit loop.csv -o better.toml"));
  EXPECT_THAT(steps, ::testing::Contains("forcegate history better.toml --on loop.csv"));
}

// At one frequency a delay, a lag and a share of the rate are the same.
TEST(LastLines, WhatIsNotSeparableLeadsToTheExperimentAndNotToAFit) {
  const TemporaryFolder folder;
  const auto force_N = [](double t_s) { return 2.0 + 1.2 * std::sin(3.14159265 * t_s); };
  Noise noise;
  std::string csv = "t,F,U\n";
  for (int i = 0; i < 6000; ++i) {
    const double t_s = 0.01 * i;
    char row[64];
    std::snprintf(row, sizeof row, "%.2f,%.6f,%.5f\n", t_s, force_N(t_s), 1.0 + 0.9 * force_N(t_s - 0.03) + 0.003 * noise());
    csv += row;
  }
  write_text(folder / "sine.csv", csv);
  for (const char* page : {"", " --html sine.html"}) {
    const ProcessResult asked = pasted("forcegate diagnose sine.csv" + std::string(page), folder);
    ASSERT_THAT(asked.out, HasSubstr("cannot tell which")) << asked.out;
    EXPECT_EQ(next_of(asked), "forcegate next sine.csv");
  }
  chain("forcegate diagnose sine.csv", folder);
}

TEST(LastLines, WhatExportRefusesIsNotSentToExport) {
  const TemporaryFolder folder;
  double warmth = 0.0;
  write_recording(folder / "hold.csv", [&](double, double F) {
    warmth += (F - warmth) * 0.01 / 30.0;
    return 2.0 * F * (1.0 + 0.02 * warmth) - 0.2;
  });
  const ProcessResult added = pasted("forcegate add self_heating --fit hold.csv -o warm.toml", folder);
  ASSERT_EQ(added.exit_code, 0) << added.err;
  ASSERT_EQ(next_of(added), "forcegate history warm.toml --on hold.csv");
  ASSERT_EQ(pasted("forcegate export warm.toml --c comp.h", folder).exit_code, 2);
  for (const char* asked : {"forcegate history warm.toml --on hold.csv", "forcegate history warm.toml"}) {
    const std::string next = next_of(pasted(asked, folder));
    EXPECT_THAT(next, AllOf(StartsWith("forcegate "), Not(StartsWith("forcegate export")))) << asked;
    EXPECT_EQ(pasted(next, folder).exit_code, 0) << next;
  }
}

TEST(LastLines, WhatNoFirmwareCanUndoIsToldWhereItIsAdded) {
  const TemporaryFolder folder;
  write_recording(folder / "rail.csv", [](double, double F) { return std::min(2.0 * F - 0.2, 4.5); });
  double play = 0.0;
  write_recording(folder / "loop.csv", [&](double, double F) {
    play = std::clamp(play, F - 0.2, F + 0.2);
    return 1.9 * F + 0.1 * play - 0.2;
  });
  const ProcessResult added = pasted("forcegate add clipping --fit rail.csv -o better.toml", folder), other = pasted("forcegate add hysteresis --fit loop.csv", folder);
  ASSERT_EQ(added.exit_code, 0) << added.err;
  EXPECT_THAT(added.out, HasSubstr("note: export will refuse this model as it is: clipping cannot be compensated on a microcontroller"));
  ASSERT_EQ(other.exit_code, 0) << other.err;
  EXPECT_THAT(other.out, Not(HasSubstr("export will refuse")));
}

TEST(Export, WithoutPlansTheHeaderIsThatOfTheModelAlone) {
  const TemporaryFolder folder;
  const ProcessResult r = pasted("cp " FORCEGATE_BINARY_DIR "/forcegate alone && ./alone export flexiforce --c comp.h", folder);
  EXPECT_EQ(r.exit_code, 0) << r.out << r.err;
  EXPECT_THAT(r.err, HasSubstr("there is no plan smoke here"));
  EXPECT_THAT(pasted("./alone export flexiforce --json", folder).out, HasSubstr("there is no plan smoke here")) << "a program is told as well";
  EXPECT_NE(read_text(folder / "comp.h"), "");
  const ProcessResult named = pasted("./alone export flexiforce --plan nosuch --c other.h", folder);
  EXPECT_EQ(named.exit_code, 2);
  EXPECT_THAT(pasted("./alone export nosuch --c other.h", folder).err, StartsWith("error: ")) << "what was not made is not explained";
}

TEST(LastLines, ALawThatLacksATermIsAskedAgainWithIt) {
  const TemporaryFolder folder;
  Noise noise;
  std::string csv = "f_Hz,A_N,b,u_b\n";
  for (int k = 0; k < 14; ++k) {
    char row[64];
    const double f = 0.1 + 0.13 * k, A = 0.6 + 0.1 * ((5 * k) % 14);
    std::snprintf(row, sizeof row, "%.3f,%.3f,%.6f,0.0001\n", f, A, 0.0056 + 0.0019 * f + 0.0001 * noise());
    csv += row;
  }
  write_text(folder / "my table.csv", csv);
  const std::vector<std::string> steps = chain("forcegate laws 'my table.csv' --of b", folder);
  ASSERT_GE(steps.size(), 3u);
  EXPECT_EQ(steps[1], "forcegate laws 'my table.csv' --of b --law f");
  EXPECT_EQ(steps[2], "forcegate plan campaign");
}

TEST(LastLines, AFileIsOpenedByWhatTheMachineHasOrNamed) {
  const TemporaryFolder folder;
  const std::string draw = FORCEGATE_BINARY_DIR "/forcegate stimulus sine f_Hz=0.5 A_N=1 m_N=2 --plot 'my sine.svg'";
  EXPECT_THAT(pasted("env -i " + draw, folder).out, ::testing::EndsWith("\nlook at: my sine.svg\n"));
  EXPECT_THAT(pasted("mkdir bin; cp /bin/true bin/xdg-open; env -i PATH=bin " + draw, folder).out, ::testing::EndsWith("\nnext: xdg-open 'my sine.svg'\n"));
}

TEST(LastLines, AHeaderOutsideTheSourceTreeIsCheckedAndThenBuiltInto) {
  const TemporaryFolder folder;
  ASSERT_EQ(pasted("mkdir film", folder).exit_code, 0);
  for (const auto& [record, gain] : {std::pair{"film/a.csv", 2.0}, {"film/b.csv", 2.001}, {"film/c.csv", 1.999}})
    write_recording(folder / record, [gain = gain](double, double F) { return gain * F - 0.2; });
  const std::vector<std::string> steps = chain("forcegate export flexiforce --fit film -o model.toml --c comp.h", folder);
  ASSERT_EQ(steps.size(), 3u) << ::testing::PrintToString(steps);
  EXPECT_THAT(steps[1], ::testing::EndsWith("--c comp.h --check film"));
  EXPECT_THAT(steps[2], HasSubstr("ci/firmware comp.h mine firmware-mine"));
}

TEST(Next, SaysInJsonWhyNothingIsToBeMeasured) {
  const TemporaryFolder folder;
  write_recording(folder / "straight.csv", [](double, double F) { return 2.0 * F - 0.2; });
  const ProcessResult r = pasted("forcegate next straight.csv --json", folder), text = pasted("forcegate next straight.csv", folder);
  const std::size_t at = r.out.find("\"sentence\": \"");
  ASSERT_NE(at, std::string::npos) << r.out;
  const std::string sentence = r.out.substr(at + 13, 20);
  EXPECT_THAT(sentence, StartsWith("nothing competes")) << r.out;
  EXPECT_THAT(text.out, StartsWith("nothing competes"));
}

TEST(Simulate, SaysThatItsRowsAreMeans) {
  const TemporaryFolder folder;
  write_recording(folder / "film.csv", [](double, double F) { return 2.0 * F - 0.2; });
  const ProcessResult r = pasted("forcegate simulate film.csv -o out", folder);
  EXPECT_THAT(r.out, HasSubstr("12000 rows (means of 20 ms), model against measurement ")) << r.out << r.err;
}

TEST(Diagnose, GivesErrorsOfAPercentageInPercentAndOneLengthOfAGap) {
  const TemporaryFolder folder;
  Noise noise;
  std::string csv = "t_s,F_ref_N,U_pct\n";
  for (int i = 0; i < 24000; ++i) {
    const double t = 0.01 * i, F = 2.0 + 1.2 * std::sin(0.3 * t);
    char row[64];
    std::snprintf(row, sizeof row, "%.2f,%.5f,%.5f\n", t, F, 10.0 * F + 0.03 * noise());
    if (t < 100.0 || t >= 108.0) csv += row;
  }
  write_text(folder / "pct.csv", csv);
  const ProcessResult r = pasted("forcegate diagnose pct.csv --html p.html", folder);
  EXPECT_THAT(r.out, AllOf(ContainsRegex("floor [.0-9]+ %"), Not(HasSubstr(" mV")), HasSubstr("the longest 8.01 s\n"), HasSubstr("(the longest 8.01 s)"))) << r.out << r.err;
  EXPECT_THAT(read_text(folder / "p.html"), Not(HasSubstr(" mV")));
}

TEST(LastLines, ExplainLeadsOutOfItself) {
  const TemporaryFolder folder;
  EXPECT_THAT(chain("forcegate explain", folder).size(), 2u);
  for (const char* term : {"known", "not separable", "4", "ACCEPT", "creep"})
    EXPECT_THAT(next_of(forcegate({"explain", term})), Not(StartsWith("forcegate explain"))) << term;
  EXPECT_EQ(next_of(forcegate({"explain", "3"})), "forcegate explain NO-DECISION");
  EXPECT_EQ(next_of(forcegate({"explain", "NO-DECISION"})), "forcegate plan --help");
  const ProcessOptions there{.folder = folder.path()};
  EXPECT_EQ(next_of(forcegate({"explain", "mre_maxima"}, there)), "forcegate report --help");
  std::filesystem::create_directory(folder.path() / "forcegate-run");
  write_text(folder / "forcegate-run/report.html", "<!doctype html>");
  EXPECT_THAT(forcegate({"explain", "mre_maxima"}, there).out, HasSubstr("forcegate-run/report.html")) << "the page shows maxima over time";
}

TEST(Explain, HelpGroupsItsTermsAndKnowsTheEffects) {
  const std::string help = forcegate({"explain", "--help"}).out;
  EXPECT_THAT(help, HasSubstr("\n  decision      ACCEPT, REJECT, NO-DECISION\n"));
  EXPECT_THAT(help, Not(HasSubstr("none, none")));
  const ProcessResult creep = forcegate({"explain", "creep"});
  EXPECT_EQ(creep.exit_code, 0);
  EXPECT_THAT(creep.out, AllOf(HasSubstr("creep (effect)"), HasSubstr("what parts them: "), HasSubstr("\n  forcegate add creep --fit CAMPAIGN -o better.toml\n")));
}

TEST(ExportCheck, WhatHoldsNoSamplesIsNeitherCountedNorJudged) {
  const TemporaryFolder folder;
  Noise noise;
  std::string csv = "t_s,F_ref_N,U_V\n", gaps = csv;
  for (int i = 0; i < 12000; ++i) {
    const double t = 0.01 * i, F = 2.0 + 1.2 * std::sin(0.3 * t), U = 2.0 * F - 0.2 + 0.003 * noise();
    char row[64], empty[64];
    std::snprintf(row, sizeof row, "%.2f,%.5f,%.5f\n", t, F, U);
    std::snprintf(empty, sizeof empty, "%.2f,%.5f,\n", t, F);
    csv += row;
    if (t < 30.0 || t > 50.0) gaps += t > 80.0 && t < 90.0 ? empty : row;  // 20 s that the clock skips, 10 s without an output
  }
  write_text(folder / "whole.csv", csv);
  write_text(folder / "gaps.csv", gaps);
  ASSERT_EQ(pasted("forcegate fit whole.csv -o m.toml", folder).exit_code, 0);
  const ProcessResult r = pasted("forcegate export m.toml --check gaps.csv --c comp.h", folder),
                      all = pasted("forcegate export m.toml --check whole.csv --c comp.h", folder);
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr(" 90 s ")) << r.out;
  EXPECT_THAT(r.out, ContainsRegex("30[.0-9]* s without samples not judged")) << r.out;
  EXPECT_THAT(all.out, AllOf(HasSubstr(" 120 s "), Not(HasSubstr("not judged")))) << all.out;
}

TEST(ExportCheck, AHeaderThatMakesTheErrorLargerIsNoSuccess) {
  const TemporaryFolder folder;
  Noise noise;
  std::string csv = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 12000; ++i) {
    const double t = 0.01 * i, F = 2.0 + 1.2 * std::sin(0.3 * t);
    char row[64];
    std::snprintf(row, sizeof row, "%.2f,%.5f,%.5f\n", t, F, 2.0 * F - 0.2 + 0.003 * noise());
    csv += row;
  }
  write_text(folder / "straight.csv", csv);
  write_text(folder / "bent.toml",
             "format = 1\n[law]\nkind = \"static\"\nspan_N = 3.2\ngain_N_per_V = 0.5\noffset_N = 0.1\n[[effect]]\nname = \"mine\"\noutput = \"k * F * F\"\n"
             "parameter.k = { value = 0.1, unit = \"1/N\" }\n");
  const ProcessResult r = pasted("forcegate export bent.toml --plan none --check straight.csv --c comp.h", folder);
  EXPECT_EQ(r.exit_code, 1) << r.out << r.err;
  EXPECT_THAT(r.out, HasSubstr("warning: the error on these records is larger with the header than with the law alone"));
  EXPECT_EQ(next_of(r), "forcegate explain \"no gain\"") << "a diagnosis that finds nothing missing would lead back to export";
}

TEST(LastLines, ARecordingThatIsTooShortForADiagnosisIsNotSentToOne) {
  for (const int rows : {30, 400}) {
    TemporaryFolder folder;
    std::string csv = "t_s,F_ref_N,U_V\n";
    for (int i = 0; i < rows; ++i) csv += std::to_string(i) + "," + std::to_string(1.0 + 0.1 * (i % 7)) + "," + std::to_string(2.0 + 0.2 * (i % 7)) + "\n";
    write_text(folder / "a.csv", csv);
    const ProcessResult r = pasted("forcegate compare a.csv", folder);
    EXPECT_EQ(r.exit_code, 0) << r.err;
    EXPECT_EQ(next_of(r), rows < 200 ? "forcegate record --help" : "forcegate diagnose a.csv");
    EXPECT_EQ(pasted(next_of(r), folder).exit_code, 0) << rows;
  }
}

}  // namespace
}  // namespace forcegate::test
