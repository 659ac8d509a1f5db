// Pages with before and after: of a diagnosis with two claims, and of one effect that is added.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <sstream>

#include <nlohmann/json.hpp>

#include "tests/support/last_line.h"

namespace forcegate::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;
namespace fs = std::filesystem;

// A curve that saturates and a slow growth, on triangles at several rates and on slow steps.
void write_campaign(const fs::path& folder) {
  fs::create_directories(folder);
  unsigned state = 5;
  const auto noise = [&] { return 0.004 * (((state = state * 1664525u + 1013904223u) >> 8) / 16777216.0 - 0.5); };
  for (int k = 0; k < 6; ++k) {
    std::string csv = "t_s,F_ref_N,U_V\n";
    double fast = 0.0, slow = 0.0;
    for (int i = 0; i < 12000; ++i) {
      const double t = 0.01 * i, phase = t / (20.0 + 5.0 * k) - std::floor(t / (20.0 + 5.0 * k));
      const double F = k % 2 == 0 ? 0.8 + 2.6 * (phase < 0.5 ? 2.0 * phase : 2.0 - 2.0 * phase) : (t < 40.0 ? 1.0 : t < 80.0 ? 3.4 : 2.0) + 0.3 * std::sin(0.6 * t);
      fast += (F - fast) * -std::expm1(-0.01 / 5.0);
      slow += (F - slow) * -std::expm1(-0.01 / 50.0);
      char row[64];
      std::snprintf(row, sizeof row, "%.2f,%.5f,%.5f\n", t, F + noise(), 8.0 * std::tanh((F + 0.015 * fast + 0.03 * slow) / 6.0) + 0.2 + noise());
      csv += row;
    }
    write_text(folder / ("r" + std::to_string(k) + ".csv"), csv);
  }
}

TEST(EvidencePages, EveryClaimOfADiagnosisHasItsPicturesAndSpectraShowBeforeAndAfter) {
  const TemporaryFolder folder;
  write_campaign(folder / "two");
  const ProcessResult r = pasted("forcegate diagnose two --html two.html --pictures pictures --json", folder);
  ASSERT_EQ(r.exit_code, 0) << r.err;
  int claims = 0;
  const Json answer = Json::parse(r.out);
  for (const Json& f : answer["findings"]) {
    if (f["probability"] < 0.5) continue;
    ++claims;
    EXPECT_TRUE(fs::exists(folder / ("pictures/" + f["effect"].get<std::string>() + "_1.svg"))) << f["effect"];
  }
  EXPECT_EQ(claims, 2) << answer["findings"].dump(1);
  // one probability for one effect, wherever it stands
  for (const Json& f : answer["findings"])
    for (const Json& ranked : answer["ranking"])
      if (ranked["effect"] == f["effect"]) {
        EXPECT_EQ(ranked["probability"], f["probability"]) << f["effect"];
      }
  EXPECT_EQ(answer["format"], 1);
  EXPECT_EQ(answer["schema"], 1) << "what scripts read before";
  EXPECT_THAT(read_text(folder / "pictures/spectrum_1.svg"), AllOf(HasSubstr("residual before"), HasSubstr(">after<")));
  EXPECT_THAT(read_text(folder / "pictures/extrema_1.svg"), AllOf(HasSubstr("maxima before"), HasSubstr("maxima after")));
  EXPECT_THAT(read_text(folder / "two.html"), HasSubstr("which neither fit has seen"));
}

TEST(EvidencePages, AnEffectThatIsAddedShowsWhatItDidToEveryRecord) {
  const TemporaryFolder folder;
  write_campaign(folder / "two");
  const ProcessResult r = pasted("forcegate add creep --fit two -o better.toml --html added.html", folder);
  ASSERT_EQ(r.exit_code, 0) << r.err;
  const std::string page = read_text(folder / "added.html");
  EXPECT_THAT(page, AllOf(HasSubstr("creep added to the model of two"), HasSubstr("Residual map before"), HasSubstr("Residual map after"),
                          HasSubstr("With the effect"), HasSubstr("residual before"), HasSubstr("gain_N_per_V"), HasSubstr("r5")));
  EXPECT_THAT(page, Not(HasSubstr("probability")));
  // a comparison has no after
  ASSERT_EQ(pasted("forcegate compare two --html compared.html", folder).exit_code, 0);
  EXPECT_THAT(read_text(folder / "compared.html"), Not(HasSubstr("residual before")));
}

// RMS over the records of one column of their table, counted from the first that holds numbers.
double rms_of_records(const std::string& page, std::size_t column) {
  const std::string table = page.substr(page.find("<caption>RMS error of each record"));
  double sum = 0.0, n = 0.0;
  std::istringstream rows(table.substr(0, table.find("</table>")));
  for (std::string row; std::getline(rows, row);) {
    std::vector<double> numbers;
    for (std::size_t at = row.find("<td class=\"n\">"); at != std::string::npos; at = row.find("<td class=\"n\">", at + 1))
      numbers.push_back(std::atof(row.c_str() + at + std::strlen("<td class=\"n\">")));
    if (numbers.size() > column) sum += numbers[column] * numbers[column], n += 1.0;
  }
  return std::sqrt(sum / n);
}

TEST(EvidencePages, TheRecordsBeforeAndAfterAreThoseOfTheErrorsThatAreTold) {
  const TemporaryFolder folder;
  write_campaign(folder / "two");
  for (const std::string campaign : {"two", "two/r0.csv"}) {
    const ProcessResult r = pasted("forcegate add static_nonlinearity --fit " + campaign + " --html added.html --json", folder);
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const Json told = Json::parse(r.out);
    const double before_mV = 1e3 * told["error_before"].get<double>(), after_mV = 1e3 * told["error_after"].get<double>();
    const std::string page = read_text(folder / "added.html");
    EXPECT_LT(after_mV, 0.9 * before_mV);
    EXPECT_NEAR(rms_of_records(page, 0), before_mV, 0.01 * before_mV) << campaign;
    EXPECT_NEAR(rms_of_records(page, 1), after_mV, 0.02 * after_mV) << campaign;
    char floor[64];
    std::snprintf(floor, sizeof floor, "noise floor %.3g mV", 1e3 * told["floor"].get<double>());
    EXPECT_THAT(page, HasSubstr(floor));
  }
}

TEST(EvidencePages, AComparisonOfOneRecordingShowsOnlyWhatThereIs) {
  const TemporaryFolder folder;
  write_campaign(folder / "two");
  const ProcessResult one = pasted("forcegate compare two/r0.csv --html one.html", folder), all = pasted("forcegate compare two", folder);
  EXPECT_THAT(one.out, AllOf(HasSubstr("against 5 blocks of one recording"), HasSubstr("as written, the whole recording: "), Not(HasSubstr("  as written  "))));
  EXPECT_THAT(all.out, AllOf(HasSubstr("against 6 records"), HasSubstr("  as written  "), Not(HasSubstr("whole recording"))));
  EXPECT_THAT(read_text(folder / "one.html"), AllOf(HasSubstr("time since the last turn is about "), Not(HasSubstr("log10 s")), Not(HasSubstr(">before<")), Not(HasSubstr(">Before<")), Not(HasSubstr(">After<"))));
}

TEST(EvidencePages, OneRecordingHasAPageOfWhatWasAddedToo) {
  const TemporaryFolder folder;
  write_campaign(folder / "two");
  const ProcessResult r = pasted("forcegate add creep --fit two/r0.csv --html added.html", folder);
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_THAT(read_text(folder / "added.html"), AllOf(HasSubstr("<h1>creep "), HasSubstr("Residual map after")));
}

TEST(EvidencePages, AnEffectThatTheModelHasIsSaidOfTheFileThatWasGiven) {
  const TemporaryFolder folder;
  write_campaign(folder / "two");
  ASSERT_EQ(pasted("forcegate add creep --fit two -o 'my model.toml'", folder).exit_code, 0);
  const ProcessResult r = pasted("forcegate add creep --fit two --model 'my model.toml'", folder);
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_THAT(r.err, AllOf(HasSubstr("has creep already"), HasSubstr("where: my model.toml"), Not(HasSubstr("flexiforce"))));
}

TEST(EvidencePages, ADriftWithoutAnInputNamesNoSide) {
  const TemporaryFolder folder;
  std::string csv = "t_s,U_V\n";
  for (int i = 0; i < 2000; ++i) {
    char row[48];
    std::snprintf(row, sizeof row, "%.2f,%.5f\n", 0.05 * i, 1.0 + 0.8 * std::exp(-i / 800.0) + 0.001 * std::sin(1e3 * i));
    csv += row;
  }
  write_text(folder / "leak.csv", csv);
  const ProcessResult r = pasted("forcegate diagnose leak.csv --html leak.html", folder);
  ASSERT_EQ(r.exit_code, 0) << r.err;
  EXPECT_THAT(r.out, AllOf(HasSubstr("side unknown"), Not(HasSubstr("  sensor  "))));
  EXPECT_EQ(next_of(r), "forcegate explain drift");
  EXPECT_THAT(read_text(folder / "leak.html"), HasSubstr("<h1>Missing: drift (side unknown, "));
  const Json answer = Json::parse(pasted("forcegate diagnose leak.csv --json", folder).out);
  ASSERT_EQ(answer["records"].size(), 1u);
  EXPECT_LT(answer["records"][0]["after"], 0.1 * answer["records"][0]["before"].get<double>());
}

TEST(EvidencePages, RowsWithoutAStampAreTold) {
  const TemporaryFolder folder;
  std::string csv = "t_s,F_ref_N,U_V\n";
  for (int i = 0; i < 3000; ++i) {
    char row[64];
    const double t = 0.01 * i, F = 2.0 + std::sin(t);
    std::snprintf(row, sizeof row, "%.2f,%.5f,%.5f\n", t, F, 2.0 * F);
    csv += i % 1000 == 500 ? std::strchr(row, ',') : row;
  }
  write_text(folder / "a.csv", csv);
  const ProcessResult r = pasted("forcegate convert a.csv b.csv", folder);
  EXPECT_THAT(r.out, AllOf(HasSubstr("3 rows have no time stamp (lines 502, 1502, 2502); dropped"), Not(HasSubstr("in the clock")))) << r.out << r.err;
}

}  // namespace
}  // namespace forcegate::test
