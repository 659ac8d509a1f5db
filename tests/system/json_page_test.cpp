// docs/json.md names every key that the verbs print.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/support/noise.h"
#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using Json = nlohmann::ordered_json;

std::string section_of(const std::string& page, const std::string& title) {
  const std::size_t from = page.find("\n## " + title + "\n");
  return from == std::string::npos ? "" : page.substr(from, page.find("\n## ", from + 4) - from);
}

bool names(const std::string& text, const std::string& key) { return text.find("`" + key + "`") != std::string::npos; }

// Names of a stimulus' parameters and of channels are no keys of ours.
void expect_named(const std::string& section, const Json& value, const std::string& where) {
  if (value.is_array())
    for (const Json& item : value) expect_named(section, item, where);
  if (!value.is_object()) return;
  for (const auto& [key, item] : value.items()) {
    EXPECT_TRUE(names(section, key)) << where << "." << key;
    if (key != "numbers" && key != "errors" && key != "before" && key != "after" && key != "conditions") expect_named(section, item, where + "." + key);
  }
}

std::string slow_sines(double A_N, double tau_s) {
  Noise noise;
  std::string text = "t_s,F_ref_N,U_V\n";
  double y = 2.0;
  for (int i = 0; i < 4000; ++i) {
    const double t = 0.02 * i, F = 2.0 + A_N * std::sin(3.0 * t) * std::sin(0.11 * t);
    y += (F - y) * 0.02 / tau_s;
    text += std::to_string(t) + "," + std::to_string(F) + "," + std::to_string(2.0 * y + 0.2 + 0.003 * noise()) + "\n";
  }
  return text;
}

// Details of a rig and the environment are named by whoever tells them.
Json without_names(Json result) {
  result["rig"]["details"].clear();
  result["environment"].clear();
  return result;
}

class JsonPage : public ::testing::Test {
 protected:
  const std::string page = read_text(FORCEGATE_SOURCE_DIR "/docs/json.md");
  TemporaryFolder folder;

  Json answer(std::vector<std::string> words) {
    words.push_back("--json");
    const ProcessResult r = forcegate(words, {.folder = folder.path()});
    EXPECT_EQ(r.exit_code, 0) << words[0] << r.out << r.err;
    return Json::parse(r.out, nullptr, false);
  }
  void told(const std::string& title, const Json& answer, std::size_t fewest_keys) {
    ASSERT_TRUE(answer.is_object()) << title;
    EXPECT_GE(answer.size(), fewest_keys) << title << " " << answer.dump();
    expect_named(section_of(page, title), answer, title);
  }
};

TEST_F(JsonPage, NamesEveryKeyOfTheVerbs) {
  std::filesystem::create_directory(folder / "film");
  for (const auto& [name, A_N] : {std::pair{"a", 1.2}, {"b", 1.5}, {"c", 0.9}, {"d", 1.7}}) write_text(folder / (std::string("film/") + name + ".csv"), slow_sines(A_N, 0.15));
  told("compare", answer({"compare", "film"}), 15);
  told("fit and add", answer({"fit", "film", "-o", "m.toml"}), 12);
  told("fit and add", answer({"add", "lag", "--fit", "film", "-o", "lag.toml"}), 12);
  told("history", answer({"history", "lag.toml", "--on", "film"}), 4);
  told("export", answer({"export", "m.toml", "--fit", "film", "--check", "film"}), 13);
  told("next", answer({"next", "film"}), 4);
  told("simulate", answer({"simulate", "film", "--model", "m.toml", "-o", "out"}), 3);
  told("convert", answer({"convert", "film/a.csv", "a.h5"}), 6);
}

TEST_F(JsonPage, NamesEveryKeyOfGateAndLeague) {
  write_text(folder / "mine.toml", "format = 1\nname = \"mine\"\n[panel]\nspecimens = [\"q50\"]\n[calibration]\nlevel = \"static\"\n[safety]\nforce_max_N = 5.2\n[[case]]\nname = \"s\"\n"
                                   "checks = [\"conformance\"]\nstimulus = { name = \"sine\", f_Hz = 0.5, A_N = 1, m_N = 2, duration_s = 60 }\n");
  std::string limited = read_text(folder / "mine.toml");
  limited.replace(limited.find("conformance"), 11, "accuracy");
  write_text(folder / "limited.toml", limited + "[limits]\nderived = \"limits.toml\"\n");
  told("plan", answer({"plan", "mine.toml"}), 11);
  for (const char* image : {"reference", "mutants/gain_pct@2"}) {
    const std::string name = image == std::string("reference") ? "a" : "b";
    forcegate({"gate", FORCEGATE_BINARY_DIR "/firmware/" + std::string(image) + ".native.so", "--plan", "mine.toml", "-o", name}, {.folder = folder.path()});
  }
  const Json result = Json::parse(read_text(folder / "a/result.json"), nullptr, false);
  told("gate", without_names(result), 17);
  EXPECT_FALSE(result["cases"][0]["checks"].empty());
  EXPECT_FALSE(result["cases"][0]["extrema"].empty());
  std::filesystem::create_directory(folder / "goldens");
  forcegate({"gate", FORCEGATE_BINARY_DIR "/firmware/reference.native.so", "--plan", "mine.toml", "--golden", "goldens", "-o", "g"}, {.folder = folder.path()});
  told("bless", answer({"bless", "g", "--goldens", "goldens", "--reason", "first", "--who", "A. Smith", "--dry-run"}), 4);
  told("limits", answer({"limits", FORCEGATE_BINARY_DIR "/firmware/reference.native.so", "--plan", "limited.toml", "--count", "10"}), 7);
  told("check", answer({"check", "a"}), 11);
  told("report", answer({"report", "a"}), 6);
  told("diff", answer({"diff", "a", "b"}), 10);
  told("record", answer({"record", "--plan", "mine.toml", "-o", "film"}), 5);
  told("mystery", answer({"mystery", "--seed", "4", "hidden"}), 7);
  told("mystery", answer({"mystery", "--list"}), 2);
  const Json revealed = answer({"reveal", "hidden", "--effect", "creep"});
  told("reveal", revealed, 4);
  EXPECT_FALSE(revealed["truth"]["effects"].empty());
  EXPECT_FALSE(revealed["truth"]["conditions"].empty());
  expect_named(section_of(page, "reveal"), revealed["truth"]["conditions"], "reveal.truth.conditions");
  std::string table = "f_Hz,A_N,b\n";
  for (int i = 1; i < 25; ++i) table += std::to_string(0.1 * i) + "," + std::to_string(0.5 + 0.07 * ((i * 7) % 11)) + "," + std::to_string(0.004 + 0.003 * 0.1 * i + 1e-5 * ((i * 5) % 7)) + "\n";
  write_text(folder / "table.csv", table);
  const Json law = answer({"laws", "table.csv", "--of", "b"});
  told("laws", law, 2);
  EXPECT_FALSE(law["parameters"][0]["missing"].empty());
  told("stimulus", answer({"stimulus", "sine", "f_Hz=0.5", "A_N=1", "m_N=2"}), 14);
  told("bench list and doctor", answer({"bench", "list"}), 2);
  told("bench list and doctor", answer({"doctor"}), 3);
}

TEST_F(JsonPage, NamesEveryKeyOfABench) {
  const std::string twin = FORCEGATE_SOURCE_DIR "/rigs/twin.toml";
  told("bench list and doctor", answer({"bench", "doctor", twin}), 3);
  const std::string others = "bench scan, who, park, reset, jog, specimens and serve";
  told(others, answer({"bench", "scan"}), 2);
  told(others, answer({"bench", "who", twin}), 2);
  Json fit = answer({"bench", "selfcheck", FORCEGATE_BINARY_DIR "/firmware/reference.native.so", "--history", "visits.jsonl"});
  EXPECT_FALSE(fit["charts"].empty());
  EXPECT_FALSE(fit["values"].empty());
  fit["values"].clear();  // their names are those of the checks
  told("bench selfcheck", fit, 8);
}

TEST_F(JsonPage, NamesEveryKeyOfPowerAndOfTheLeague) {
  Json power = Json::parse(forcegate({"power", "--mutant", "gain_pct", "--mutant-seeds", "1", "--seeds", "1", "--quick", "--json"}, {.folder = folder.path()}).out, nullptr, false);
  ASSERT_TRUE(power.is_object());
  ASSERT_FALSE(power["mutants"].empty());
  for (Json& mutant : power["mutants"]) mutant["rejected_by"].clear();  // ids of checks
  told("power", power, 14);
  Json league = answer({"league", "--size", "small", "--only", "creep"});
  told("league", league, 19);
}

TEST_F(JsonPage, NamesEveryKeyOfACharacterisation) {
  write_text(folder / "plan.toml", "format = 1\nkind = \"characterize\"\nname = \"short\"\nseed = 5\n[population]\nspecimens = [\"q25\", \"q75\"]\nsessions = 1\nexemplar = \"\"\n"
                                   "[procedures]\nfsr = [\"static_calibration\", \"step_response\"]\n[[limit]]\nkey = \"step.sensor\"\nmaximum = 250\nsource = \"a test\"\n");
  told("characterize", answer({"characterize", "--plan", "plan.toml", "-o", "out"}), 8);
  Json study = Json::parse(read_text(folder / "out/study.json"));
  for (Json& session : study["sensors"][0]["sessions"]) session["values"].clear();  // their names are those of the quantities
  told("characterize", study, 7);
}

TEST_F(JsonPage, NamesEveryKeyOfWordsAboutTheProgram) {
  told("explain", answer({"explain"}), 2);
  told("version, completion and man", answer({"version"}), 3);
  told("version, completion and man", answer({"completion", "bash"}), 3);
  told("version, completion and man", answer({"man"}), 2);
  for (const char* verb : {"gate", "characterize", "explain"}) {
    Json help = answer({verb, "--help"});
    help["exit_codes"].clear();
    told("help", help, 9);
  }
  Json all = answer({"--help"});
  all["exit_codes"].clear();
  told("help", all, 4);
}

// At one frequency a delay and a lag are the same.
TEST_F(JsonPage, NamesEveryKeyOfAnExperiment) {
  Noise noise;
  std::string text = "t,F,U\n";
  for (int i = 0; i < 6000; ++i) {
    const auto force_N = [](double t_s) { return 2.0 + 1.2 * std::sin(3.14159265 * t_s); };
    text += std::to_string(0.01 * i) + "," + std::to_string(force_N(0.01 * i)) + "," + std::to_string(1.0 + 0.9 * force_N(0.01 * i - 0.03) + 0.003 * noise()) + "\n";
  }
  write_text(folder / "sine.csv", text);
  const Json planned = answer({"next", "sine.csv"});
  told("next", planned, 4);
  EXPECT_FALSE(planned["segments"].empty());
  told("next", answer({"next", "sine.csv", "--run", "--rig-option", "hidden=creep:medium", "-o", "more"}), 7);
}

}  // namespace
}  // namespace forcegate::test
