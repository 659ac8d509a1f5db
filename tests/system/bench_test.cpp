// The bench as a user runs it: twins instead of instruments, the real adapters between them and the gate.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include <nlohmann/json.hpp>

#include "tests/support/process.h"

namespace forcegate::test {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

const ProcessOptions kHere{.folder = FORCEGATE_SOURCE_DIR, .timeout = std::chrono::minutes(10)};
constexpr const char* kNative = FORCEGATE_BINARY_DIR "/firmware/reference.native.so";
constexpr const char* kUart = FORCEGATE_BINARY_DIR "/firmware/reference.uart.elf";

class Bench : public ::testing::Test {
 protected:
  Json gate(const std::string& image, const std::string& rig, int exit_code = 0,
            std::vector<std::string> more = {}) {
    const std::string out = folder / std::to_string(runs_++);
    std::vector<std::string> words{"gate", image, "--rig", rig, "--plan", "twin", "-o", out};
    words.insert(words.end(), more.begin(), more.end());
    const ProcessResult r = forcegate(words, kHere);
    EXPECT_EQ(r.exit_code, exit_code) << r.out << r.err;
    Json result = Json::parse(read_text(out + "/result.json"), nullptr, false);
    EXPECT_FALSE(result.is_discarded());
    return result;
  }
  TemporaryFolder folder;
  int runs_ = 0;
};

double mean_of(const Json& result, std::size_t series) {
  const Json& values = result["cases"][0]["extrema"][series]["actual_N"];
  double sum = 0.0;
  for (const Json& v : values) sum += v.get<double>();
  return sum / static_cast<double>(values.size());
}

TEST_F(Bench, TwinsOverEitherLinkAndWithEitherImageDecideLikeTheRigInTheProcess) {
  const Json inside = gate(kNative, "emulated");
  const Json tcp = gate(kNative, "rigs/twin.toml");
  const Json rtu = gate(kUart, "rigs/twin_rtu.toml");
  EXPECT_EQ(tcp["decision"]["kind"], inside["decision"]["kind"]);
  EXPECT_EQ(rtu["decision"]["kind"], inside["decision"]["kind"]);
  // Time is virtual and bytes are counted: not a sample depends on the link or on where the firmware runs.
  EXPECT_EQ(tcp["cases"][0]["digest"], rtu["cases"][0]["digest"]);
  // The reference comes 274 times a second with 1.8 ms of doubt about its time; the force turns within 0.01 N of that.
  for (const std::size_t series : {0U, 1U}) EXPECT_NEAR(mean_of(tcp, series), mean_of(inside, series), 0.01);
  EXPECT_EQ(tcp["rig"]["details"]["reference serial"], "FT-T-1");
}

TEST_F(Bench, EveryReferenceDecidesLikeTheRigInTheProcess) {
  const Json inside = gate(kNative, "emulated");
  for (const char* file : {"rigs/twin_netft.toml", "rigs/twin_digital.toml"}) {
    const Json twins = gate(kNative, file);
    EXPECT_EQ(twins["decision"]["kind"], inside["decision"]["kind"]) << file;
    for (const std::size_t series : {0U, 1U})
      EXPECT_NEAR(mean_of(twins, series), mean_of(inside, series), 0.01) << file;
  }
}

TEST_F(Bench, AFaultOnAWireIsNeverChargedToTheFirmware) {
  const std::string text = read_text(FORCEGATE_SOURCE_DIR "/rigs/twin.toml");
  const auto with = [&](const std::string& device, const std::string& kind) {
    const std::string file = folder / (device + ".toml");
    write_text(file,
               text + "\n[[twins.fault]]\ndevice = \"" + device + "\"\nkind = \"" + kind + "\"\nat_s = 40\n");
    return file;
  };
  const std::vector<std::string> quick{"--calibration", "nominal"};
  const struct {
    const char *device, *kind, *blame;
  } cases[] = {{"board", "stall", "link"}, {"reference", "unplug", "reference"}, {"motor", "stall", "rig"}};
  for (const auto& c : cases) {
    const Json result = gate(kNative, with(c.device, c.kind), 4, quick);
    EXPECT_EQ(result["decision"]["kind"], "NO-DECISION") << c.device;
    EXPECT_EQ(result["decision"]["blame"], c.blame) << c.device;
  }
}

// Whatever the lane: an image that answers wrongly or not at all is the build's fault, and nobody plays it again.
TEST_F(Bench, AFirmwareThatFailsOnABenchIsRejectedAsInTheProcess) {
  const struct {
    const char *mutant, *said;
  } cases[] = {{"protocol_major_2", "protocol major 2"},  {"nonce_stale", "nonce"},
               {"cal_not_echoed", "calibration"},         {"crash_after_min@1", "crashed with signal"},
               {"exits_early", "ended with exit code"},   {"block_not_written", "without force or flags"}};
  for (const auto& c : cases) {
    const std::string image = std::string(FORCEGATE_BINARY_DIR "/firmware/mutants/") + c.mutant + ".native.so";
    for (const char* rig : {"emulated", "rigs/twin.toml"}) {
      const Json result = gate(image, rig, 1, {"--calibration", "nominal"});
      EXPECT_EQ(result["decision"]["kind"], "REJECT") << c.mutant << " " << rig;
      EXPECT_EQ(result["decision"]["blame"], "firmware") << c.mutant << " " << rig;
      EXPECT_EQ(result["cases"].size(), 1U) << c.mutant << " " << rig;
      if (std::string(rig) != "emulated") {
        EXPECT_THAT(result["decision"]["reason"].get<std::string>(), HasSubstr(c.said)) << rig;
      }
    }
  }
}

// A native image whose answer to one block is `body`, with `define` set.
void make_image(const std::string& path, const std::string& body, const std::string& define) {
  write_text(path + ".c", R"(#include <math.h>
#include <string.h>
#include "ports/native.h"
static unsigned long state = 1;
uint32_t forcegate_native_abi(void) { return 1; }
int32_t forcegate_native_open(uint32_t nonce, const ForcegateNativeCalibration* in, ForcegateNativeInfo* info) {
  memset(info, 0, sizeof *info);
  info->nonce = nonce, info->protocol_major = 1, info->rate_Hz = 1000, info->calibration = *in;
  memset(info->build_id, '0', 40);
  memcpy(info->algorithm_id, "made/1", 6);
  return 0;
}
int32_t forcegate_native_process(uint32_t first, uint32_t n, const uint16_t* adc, float* force_N, uint8_t* flags) {
  (void)first, (void)adc, (void)state;
)" + body + R"(
  return 0;
}
void forcegate_native_close(void) {}
)");
  const ProcessResult made = run_process({"cc", "-shared", "-fPIC", "-O1", "-D" + define, "-I" FORCEGATE_SOURCE_DIR "/rigs/firmware", "-o", path, path + ".c"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
}

// The answer of the firmware drives the loop: a wheel that cannot follow nonsense is no bad wheel.
TEST_F(Bench, AFirmwareThatAnswersNonsenseIsNotTheRigsFault) {
  for (const std::string not_finite : {"0", "1"}) {
    const std::string image = folder / ("nonsense" + not_finite + ".so");
    ASSERT_NO_FATAL_FAILURE(make_image(image, R"(  for (uint32_t i = 0; i < n; ++i) {
    state = state * 6364136223846793005ul + 1442695040888963407ul;
    force_N[i] = NOT_FINITE ? NAN : (float)((double)(state >> 33) / 1073741824.0 - 1.0) * 1000.0f;
    flags[i] = 0;
  })", "NOT_FINITE=" + not_finite));
    for (const char* rig : {"emulated", "rigs/twin.toml"})
      EXPECT_EQ(gate(image, rig, 1)["decision"]["blame"], "firmware") << not_finite << " " << rig;
  }
}

TEST_F(Bench, AFirmwareThatWritesBeyondItsBlockIsRejectedWhereItRunsInTheProcess) {
  const std::pair<std::string, std::string> kPlaces[] = {
      {"force_N[n] = 0", "writes beyond its block"},
      {"force_N[-1] = 0", "writes beyond its block"},
      {"flags[n + 4] = 0", "writes beyond its block"},
      {"flags[-2] = 0", "writes beyond its block"},
      // far beyond it the firmware crashes, and it is no defect of the harness
      {"force_N[n + 64] = 1", "the firmware crashed with signal SEGV"},
      {"force_N[n + 2000] = 1", "the firmware crashed with signal SEGV"},
      {"flags[n + 5000] = 1", "the firmware crashed with signal SEGV"},
      {"((uint16_t*)adc)[n + 2000] = 1", "the firmware crashed with signal SEGV"}};
  const std::string image = folder / "overrun.so";
  for (const auto& [place, said] : kPlaces) {
    ASSERT_NO_FATAL_FAILURE(make_image(image, R"(  for (uint32_t i = 0; i < n; ++i) force_N[i] = adc[i] * 1e-4f, flags[i] = 0;
  if (first > 0) PLACE;)", "PLACE=" + place));
    const ProcessResult r = forcegate({"gate", image, "--case", "four_sines", "--specimen", "q50", "-o", folder / "run"}, kHere);
    EXPECT_EQ(r.exit_code, 1) << place << r.out << r.err;
    EXPECT_THAT(r.out, HasSubstr(said)) << place;
  }
}

// What the oracle, the checks of the rig and the record see are the codes that were played, never what an image makes of them.
TEST_F(Bench, AFirmwareThatWritesIntoItsCodesIsRejectedAndNoCableIsLookedFor) {
  const std::string image = folder / "in_place.so";
  for (const std::string how : {"w[i] = (uint16_t)(w[i] * 0.98)", "w[i] &= 0xFFF8", "w[0] = 0"}) {
    ASSERT_NO_FATAL_FAILURE(make_image(image, R"(  uint16_t* w = (uint16_t*)adc;
  for (uint32_t i = 0; i < n; ++i) HOW, force_N[i] = adc[i] * 1e-4f, flags[i] = 0;)", "HOW=" + how));
    const ProcessResult r = forcegate({"gate", image, "--case", "four_sines", "--specimen", "q50", "-o", folder / "run"}, kHere);
    EXPECT_EQ(r.exit_code, 1) << how << r.out << r.err;
    EXPECT_THAT(r.out, HasSubstr("writes into the codes that it is given")) << how;
    EXPECT_THAT(r.out, HasSubstr("the firmware")) << how;
  }
}

TEST_F(Bench, EveryVerbThatTakesARigTakesABenchFile) {
  const std::string made = folder / "campaign";
  const ProcessResult recorded =
      forcegate({"record", "--rig", "rigs/twin.toml", "--plan", "selfcheck", "-o", made}, kHere);
  EXPECT_EQ(recorded.exit_code, 0) << recorded.err;
  EXPECT_THAT(read_text(made + "/campaign.json"), HasSubstr("known_profile"));
  const ProcessResult checked =
      forcegate({"bench", "selfcheck", kNative, "--rig", "rigs/twin.toml", "--seed", "3"}, kHere);
  EXPECT_EQ(checked.exit_code, 0) << checked.out << checked.err;
  EXPECT_THAT(checked.out, HasSubstr("rig bench/"));
}

TEST_F(Bench, ArmingARigWhereNothingMovesIsAnErrorOfTheCommandLine) {
  const ProcessResult r = forcegate({"gate", kNative, "--arm", "-o", folder / "run"}, kHere);
  EXPECT_EQ(r.exit_code, 2) << r.out;
  EXPECT_THAT(r.err, HasSubstr("--rig BENCH.toml --arm"));
}

TEST_F(Bench, WhatAnActionDoesNotTakeIsRefusedAndNotIgnored) {
  const std::string twin = "rigs/twin.toml";
  const std::vector<std::pair<std::vector<std::string>, std::string>> told = {
      {{"bench", "calibrate", twin, "reference", "--yes", "-o", folder / "z.toml"}, "--output means nothing to bench calibrate reference"},
      {{"bench", "calibrate", twin, "sensor", "--masses", "0,100"}, "--masses means nothing to bench calibrate sensor"},
      {{"bench", "calibrate", twin, "spring", "--yes"}, "--yes means nothing to bench calibrate spring"},
      {{"bench", "doctor", twin, "rigs/twin_rtu.toml"}, "bench doctor takes one bench file"},
      {{"bench", "reset", twin, "--angle", "3"}, "--angle means nothing to bench reset"},
      {{"bench", "scan", twin}, "bench scan takes no file"},
      {{"bench", "list", twin, "--angle", "3", "--arm"}, "means nothing to bench list"},
      {{"characterize", "--plan", "capacitance", "--sensor", "fsr", "-o", folder / "out"}, "those of its packs"},
  };
  for (const auto& [words, what] : told) {
    const ProcessResult r = forcegate(words, kHere);
    EXPECT_EQ(r.exit_code, 2) << what << r.out;
    EXPECT_THAT(r.err, HasSubstr(what));
    EXPECT_THAT(r.err, HasSubstr("\n  help: ")) << what;
  }
  EXPECT_EQ(forcegate({"bench", "list", twin, "rigs/twin_rtu.toml"}, kHere).exit_code, 0);
}

TEST_F(Bench, ABenchFileWithAMistakeIsNamedByItsLine) {
  std::string text = read_text(FORCEGATE_SOURCE_DIR "/rigs/twin.toml");
  text.replace(text.find("ati_serial\""), 11, "ati_cereal\"");
  write_text(folder / "b.toml", text);
  const ProcessResult r = forcegate({"gate", kNative, "--rig", folder / "b.toml"}, kHere);
  EXPECT_EQ(r.exit_code, 2);
  EXPECT_THAT(r.err, HasSubstr("b.toml:"));
  EXPECT_THAT(r.err, HasSubstr("did you mean 'ati_serial'?"));
}

TEST_F(Bench, DoctorSeesEveryInstrumentOfTheDeliveredBenches) {
  for (const char* file : {"rigs/twin.toml", "rigs/twin_rtu.toml"}) {
    const ProcessResult r = forcegate({"bench", "doctor", file, "--json"}, kHere);
    EXPECT_EQ(r.exit_code, 0) << r.out << r.err;
    const Json document = Json::parse(r.out, nullptr, false);
    EXPECT_EQ(document["ready"], true) << r.out;
    EXPECT_EQ(document["items"].size(), 5U);
  }
}

TEST_F(Bench, DoctorSaysOfRecordsThatItCannotBelieveThatTheyCame) {
  std::string text = read_text(FORCEGATE_SOURCE_DIR "/rigs/twin.toml");
  text.replace(text.find("counts_per_force = 1000\n"), 24, "counts_per_force = 10\n");  // 0.5 N reads as 50 N
  write_text(folder / "grams.toml", text);
  const ProcessResult r = forcegate({"bench", "doctor", folder / "grams.toml"}, kHere);
  EXPECT_NE(r.exit_code, 0);
  EXPECT_THAT(r.out, HasSubstr("that can be believed"));
  EXPECT_THAT(r.out, HasSubstr("ok    board"));
  EXPECT_THAT(r.out, HasSubstr("(by the bench file)"));
}

TEST_F(Bench, KnownMassesFindAReferenceWhoseScaleIsWrong) {
  std::string text = read_text(FORCEGATE_SOURCE_DIR "/rigs/twin.toml");
  text.replace(text.find("counts_per_force = 1000\n"), 24, "counts_per_force = 1050\n");  // the twin has 1000
  write_text(folder / "b.toml", text);
  const ProcessResult r = forcegate(
      {"bench", "calibrate", folder / "b.toml", "reference", "--masses", "0,100,200,400", "--yes", "--json"},
      kHere);
  ASSERT_EQ(r.exit_code, 0) << r.out << r.err;
  const Json document = Json::parse(r.out, nullptr, false);
  EXPECT_NEAR(document["line"]["slope"].get<double>(), 1000.0 / 1050.0, 0.001);
  // how many samples a mass gets depends on the clock on the wall, and the last digits with it
  const std::string line = document["lines"][0].get<std::string>(), key = "counts_per_force = ";
  ASSERT_EQ(line.rfind(key, 0), 0u) << line;
  EXPECT_NEAR(std::stod(line.substr(key.size())), 1000.0, 5.0 * 1000.0 * document["u_rel"].get<double>());
  EXPECT_LT(document["u_rel"].get<double>(), 0.001);
}

TEST_F(Bench, AJogComesAsNearAsAMilliradian) {
  const ProcessResult r = forcegate({"bench", "jog", "rigs/twin.toml", "--angle", "1", "--json"}, kHere);
  ASSERT_EQ(r.exit_code, 0) << r.out << r.err;
  EXPECT_NEAR(Json::parse(r.out, nullptr, false)["to_rad"].get<double>(), 1.0, 0.0015);
}

TEST_F(Bench, TheSpringIsFoundAgainstTheReferenceAndTheSensorBySweeps) {
  std::string text = read_text(FORCEGATE_SOURCE_DIR "/rigs/twin.toml");
  text.replace(text.find("spring_N_per_mm = 0.25"), 22, "spring_N_per_mm = 0.23");  // the plant has 0.25
  write_text(folder / "b.toml", text);
  const ProcessResult spring =
      forcegate({"bench", "calibrate", folder / "b.toml", "spring", "--seconds", "0.5", "--json"}, kHere);
  ASSERT_EQ(spring.exit_code, 0) << spring.out << spring.err;
  EXPECT_NEAR(Json::parse(spring.out, nullptr, false)["line"]["slope"].get<double>(), 0.25, 0.002);
  const ProcessResult sensor =
      forcegate({"bench", "calibrate", "rigs/twin.toml", "sensor", "-o", folder / "q50.toml"}, kHere);
  ASSERT_EQ(sensor.exit_code, 0) << sensor.out << sensor.err;
  // The gate takes what was written: the plan's own sweeps are not made.
  const Json result = gate(kNative, "rigs/twin.toml", 0, {"--cal", folder / "q50.toml"});
  EXPECT_EQ(result["cases"].size(), 1U);
}

TEST_F(Bench, HoweverARunIsEndedItsMotorIsStoppedAndAKilledOneLosesNoMoreThanASecond) {
  const ProcessResult r = run_process({"/usr/bin/python3", FORCEGATE_SOURCE_DIR "/ci/lib/kill_bench.py",
                                       FORCEGATE_BINARY_DIR "/forcegate", kNative, "rigs/twin.toml", "6"},
                                      kHere);
  EXPECT_EQ(r.exit_code, 0) << r.out << r.err;
  EXPECT_THAT(r.out, HasSubstr("6 kills: 6 journals readable and motors parked"));
  for (const char* end : {"SIGINT", "SIGTERM", "bench park"})
    EXPECT_THAT(r.out, HasSubstr(std::string(end) + ": motor stopped"));
}

TEST_F(Bench, AGateInTimeOfTheWallKeepsWhatItRecordedWhenItIsInterrupted) {
  ProcessOptions options = kHere;
  options.signal = 2;
  // Whenever the signal comes, it must once come in the middle of the record.
  for (const int after_ms : {2500, 4000, 8000}) {
    options.signal_after = std::chrono::milliseconds(after_ms);
    const std::string out = folder / ("gate" + std::to_string(after_ms));
    const ProcessResult r = forcegate({"gate", kNative, "--rig", "rigs/twin.toml", "--rig-option", "clock=paced", "--plan", "twin", "--calibration", "nominal", "-o", out}, options);
    EXPECT_EQ(r.exit_code, 130) << r.out << r.err;
    EXPECT_FALSE(std::filesystem::exists(out));
    const std::size_t at = r.out.find("forcegate recover ");
    if (at == std::string::npos) continue;
    const std::string journal = r.out.substr(at + 18, r.out.find('\n', at) - at - 18);
    const ProcessResult recovered = forcegate({"recover", journal, "-o", folder / "r.h5"}, kHere);
    EXPECT_EQ(recovered.exit_code, 0) << recovered.err;
    return;
  }
  FAIL() << "no signal has hit a record";
}

TEST_F(Bench, AKilledRecordingIsRecoveredFromItsJournal) {
  // Whenever the kill comes, it must once come in the middle; a busy machine is later than a quiet one.
  for (const int after_ms : {700, 1200, 2000, 4000, 8000}) {
    const std::string out = folder / ("record" + std::to_string(after_ms));
    ProcessOptions options = kHere;
    options.signal_after = std::chrono::milliseconds(after_ms);
    (void)forcegate({"record", "--rig", "rigs/twin.toml", "--case", "slow_triangles", "-o", out}, options);
    const std::string journal = out + "/r01_slow_triangles.fgj";
    if (!std::filesystem::exists(journal)) continue;
    const ProcessResult r = forcegate({"recover", journal, "-o", folder / "r.h5", "--json"}, kHere);
    ASSERT_EQ(r.exit_code, 0) << r.err;
    const Json report = Json::parse(r.out, nullptr, false);
    if (report["samples"].get<int>() == 0) continue;
    EXPECT_EQ(report["closed"], false);
    EXPECT_GT(report["last_s"].get<double>(), 0.4);
    return;
  }
  FAIL() << "no kill has hit a recording";
}

TEST_F(Bench, TwoHostsOfTwinsDoNotShareAFolderAndNothingStaysBehind) {
  const ProcessResult r = run_process(
      {"bash", "-c", R"sh(set -m; "$0" bench serve rigs/twin.toml --folder "$1" > "$1.out" & first=$!
for i in $(seq 100); do grep -q next: "$1.out" && break; sleep 0.1; done
ls "$1" | sort > "$1.before"; readlink "$1/ati0" > "$1.link"
"$0" bench serve rigs/twin.toml --folder "$1"; echo "second $?"
readlink "$1/ati0" | cmp - "$1.link" && echo "link kept"
"$0" bench doctor rigs/twin.toml --attach "$1" > /dev/null; echo "doctor $?"
kill -TERM $first; wait $first; echo "left $(ls "$1" | wc -l) of $(wc -l < "$1.before")"; echo "process $first")sh",
       FORCEGATE_BINARY_DIR "/forcegate", folder / "twins"},
      kHere);
  for (const char* part : {"second 2\n", "link kept\n", "doctor 0\n", "left 0 of "}) EXPECT_THAT(r.out, HasSubstr(part)) << r.err;
  EXPECT_THAT(r.out, ::testing::Not(HasSubstr("left 0 of 0")));
  EXPECT_THAT(r.err, HasSubstr("twins are served in this folder already, by process " + r.out.substr(r.out.rfind(' ') + 1, r.out.size() - r.out.rfind(' ') - 2)));
}

TEST_F(Bench, ADriveThatStoppedByItselfIsResetByAVerb) {
  const ProcessResult r = run_process(
      {"bash", "-c", R"sh(set -m; "$0" bench serve rigs/twin.toml --folder "$1" > "$1.out" & host=$!
for i in $(seq 100); do grep -q next: "$1.out" && break; sleep 0.1; done
/usr/bin/python3 - "$1/motor.port" <<'END'
import socket, struct, sys, time
line = socket.create_connection(("127.0.0.1", int(open(sys.argv[1]).read())))
for register, word in ((0x1000, 50), (0x007D, 0x28)):  # runs, and nobody talks to it any more
    line.send(struct.pack(">HHHBBHH", 1, 0, 6, 1, 6, register, word))
    line.recv(12)
time.sleep(0.5)
END
"$0" bench doctor rigs/twin.toml --attach "$1"; echo "doctor $?"
"$0" bench reset rigs/twin.toml --attach "$1"; echo "reset $?"
"$0" bench reset rigs/twin.toml --attach "$1" --json; echo "again $?"
"$0" bench doctor rigs/twin.toml --attach "$1" > /dev/null; echo "doctor $?"
kill -TERM $host; wait $host)sh",
       FORCEGATE_BINARY_DIR "/forcegate", folder / "twins"},
      kHere);
  for (const char* part : {"doctor 4\n", "then forcegate bench reset", "the drive has forgotten fault 0x84; the motor is stopped", "reset 0\n",
                           "\"reset\": false", "again 0\n", "doctor 0\n"})
    EXPECT_THAT(r.out, HasSubstr(part)) << r.err;
}

TEST_F(Bench, NobodyHoldsABenchThatNobodyUses) {
  const ProcessResult r = forcegate({"bench", "who", "rigs/twin.toml"}, kHere);
  EXPECT_EQ(r.exit_code, 0) << r.err;
  EXPECT_THAT(r.out, HasSubstr("nobody"));
}

}  // namespace
}  // namespace forcegate::test
