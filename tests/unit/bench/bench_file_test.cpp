#include "hil/rig/bench_file.h"

#include <gtest/gtest.h>

#include "tests/support/twin_bench.h"

namespace forcegate {
namespace {

using test::bench_text;
using test::Changes;

Error mistake(const Changes& changes) {
  const auto bench = read_bench_text(bench_text("twin.toml", changes), "t.toml");
  if (!bench) return bench.error();
  const auto checked = check_devices(*bench);
  EXPECT_FALSE(checked) << changes[0].second;
  return checked ? Error{} : checked.error();
}

TEST(BenchFile, TheDeliveredBenchesAreSound) {
  for (const char* file : {"twin.toml", "twin_rtu.toml"}) {
    const auto bench = read_bench_text(bench_text(file), file);
    ASSERT_TRUE(bench) << bench.error().to_text();
    EXPECT_TRUE(check_devices(*bench)) << check_devices(*bench).error().to_text();
    EXPECT_TRUE(bench->twins);
    EXPECT_EQ(rig_info(*bench).details.at("calibration spring"), "SPRING-T-1, until 2099-12-31");
  }
}

TEST(BenchFile, EveryMistakeNamesItsLineAndHelps) {
  struct Case {
    Changes changes;
    const char* text;
  };
  const Case cases[] = {
      {{{"force_max_N = 5.5", "force_max = 5.5"}}, "force_max"},
      {{{"adapter = \"ati_serial\"", "adapter = \"ati_serail\""}}, "ati_serail"},
      {{{"expires = \"2099-12-31\" }\nspring", "expires = \"soon\" }\nspring"}}, "no date"},
      {{{"expires = \"2099-12-31\" }\nspring", "expires = \"2099-02-31\" }\nspring"}}, "no date"},
      {{{"noise_N = 0.006", "noise_N = 0.6"}}, "'noise_N' in [reference] = 0.6 is more than a tenth of force_max_N in [limits], 5.5 N"},
      {{{"eccentricity_mm = 10.0", "eccentricity_mm = -1"}}, "out of range"},
      {{{"eccentricity_mm = 10.0", "eccentricity_mm = 10.0\ntheta_min_rad = -0.5"}}, "'theta_min_rad' in [geometry] = -0.5 is out of range"},
      {{{"eccentricity_mm = 10.0", "eccentricity_mm = 10.0\ntheta_max_rad = 3.3"}}, "'theta_max_rad' in [geometry] = 3.3 is out of range"},
      {{{"serial = \"BOARD-T-1\"", "serial = \"BOARD-T-1\"\nv_range_V = 500"}}, "'v_range_V' in [board] = 500 is out of range"},
      {{{"limits = [-40.0, 40.0]", "offset = 0"}}, "limits"},
      {{{"scale = 20860.756700940907", "scale = 0"}}, "must not be 0"},
      {{{"addr = 0x0104", "addr = 0x0103"}}, "overlap"},
      {{{"emergency = [{ reg = \"control\", value = 0x00 }]\n", ""}}, "emergency"},
      {{{"emergency = [{ reg = \"control\"", "emergency = [{ reg = \"contrl\""}}, "contrl"},
      {{{"emergency = [{ reg = \"control\", value = 0x00 }]", "emergency = [{ reg = \"control\" }]"}},
       "command 'emergency' has no value for register 'control'"},
      {{{"stop = [{ reg = \"control\", value = 0x20 }]", "stop = [{ reg = \"velocity_set\" }]"}},
       "command 'stop' has no value for register 'velocity_set'"},
      {{{"enable = [{ reg = \"control\", value = 0x20 }]", "enable = [{ reg = \"control\" }]"}}, "command 'enable' has no value"},
      {{{"fault_reset = [{ reg = \"reset\", value = 1 }]", "fault_reset = [{ reg = \"reset\" }]"}}, "command 'fault_reset' has no value"},
      {{{"emergency = [{ reg = \"control\", value = 0x00 }]", "emergency = [{ reg = \"control\", value = 0x10000 }]"}},
       "65536 of command 'emergency' does not fit register 'control'"},
      {{{"emergency = [{ reg = \"control\", value = 0x00 }]", "emergency = [{ reg = \"control\", value = 0, after_ms = 100 }]"}},
       "'emergency' waits"},
      {{{"run = [{ reg = \"velocity_set\" }, ", "run = ["}}, "must write the velocity once"},
      {{{"run = [{ reg = \"velocity_set\" }, ", "run = [{ reg = \"velocity_set\" }, { reg = \"velocity_set\" }, "}},
       "must write the velocity once"},
      {{{"run = [{ reg = \"velocity_set\" }, ", "run = [{ reg = \"velocity_set\", value = 1 }, "}}, "fixed value"},
      {{{"run = [{ reg = \"velocity_set\" }, { reg = \"control\", value = 0x28 }]", "run = [{ reg = \"velocity_set\" }, { reg = \"control\" }]"}},
       "command 'run' has no value for register 'control'"},
      {{{"fault_reset = ", "fault_rest = "}}, "knows no command 'fault_rest'"},
      {{{"drive_timeout_reg = \"comm_timeout\"\n", ""}}, "drive_timeout_reg"},
      {{{"addr = 0x0200", "addr = 0xFFFF"}}, "last address"},
      {{{"fault = { reg = \"status\", mask = 0x80, equals = 0x80 }", "fault = { reg = \"status\" }"}},
       "either"},
      {{{"mask = 0x80, equals = 0x80", "mask = 0x08, equals = 0x80"}}, "'fault' never holds: 0x80 has bits outside of 0x8"},
      {{{"mask = 0x80, equals = 0x80", "mask = 0x08, not_equals = 0x80"}}, "'fault' always holds"},
      {{{"mask = 0x80, equals = 0x80", "equals = 0x10080"}}, "outside of 0xffff"},
      {{{"mask = 0x80, equals = 0x80", "mask = 0x800000, equals = 0"}}, "no bit of register 'status'"},
      {{{"form = \"binary\"", "form = \"hex\""}}, "hex"},
      {{{"form = \"binary\"", "form = \"binary\"\nsign = 0"}}, "neither -1 nor 1"},
      {{{"comm_timeout = { addr = 0x1000", "comm_timeout = { addr = 0x1000, scale = 0.01"}, {"drive_timeout_ms = 200", "drive_timeout_ms = 40"}},
       "drive_timeout_ms = 40 becomes 0 ms in register 'comm_timeout', which counts in steps of 100 ms"},
      {{{"comm_timeout = { addr = 0x1000", "comm_timeout = { addr = 0x1000, scale = 0.01"}, {"drive_timeout_ms = 200", "drive_timeout_ms = 250"}}, "becomes 200 ms"},
      {{{"comm_timeout = { addr = 0x1000", "comm_timeout = { addr = 0x1000, limits = [0, 100]"}}, "200 for register 'comm_timeout' is outside its limits"},
      {{{"limits = [-40.0, 40.0]", "limits = [0.0, 40.0]"}}, "must turn either way"},
      {{{"limits = [-40.0, 40.0]", "limits = [-40.0, 10.0]"}}, "takes no more than 10 rad/s in either direction"},
      {{{"force_max_N = 5.5", "force_max_N = 55"}}, "force_max_N = 55 in [limits], and the reference measures no more than 17 N"},
      {{{"force_max_N = 17", "force_max_N = 3"}}, "force_max_N = 5.5 in [limits], and the reference measures no more than 3 N"},
      {{{"resolution_N = 0.025", "resolution_N = 2.5"}}, "'resolution_N' in [reference] = 2.5 is more than a tenth of force_max_N"},
      {{{"u_rel = 0.005", "u_rel = 5"}}, "'u_rel' in [reference] = 5 is out of range: that is 500 % of the force"},
      {{{"u_rel = 0.005", "u_rel = -0.005"}}, "'u_rel' in [reference] = -0.005 is out of range"},
      {{{"port = \"board0\"", "port = \"ati0\""}}, "[reference] and [board] name one port, 'ati0'"},
  };
  for (const Case& c : cases) {
    const Error e = mistake(c.changes);
    EXPECT_EQ(e.code, ErrorCode::config) << c.text;
    EXPECT_NE((e.text + e.hint).find(c.text), std::string::npos) << e.to_text();
    EXPECT_NE(e.where.find(".toml:"), std::string::npos) << e.to_text();
  }
}

TEST(BenchFile, TwoNamesOfOnePortAreOnePortUnlessProgramsShareIt) {
  const Error e = mistake({{"[reference]\nadapter", "[ports]\nati0 = \"/dev/ttyUSB0\"\nboard0 = \"/dev/ttyUSB0\"\n\n[reference]\nadapter"}});
  EXPECT_NE(e.text.find("[reference] and [board] name one port, '/dev/ttyUSB0'"), std::string::npos) << e.to_text();
  EXPECT_NE(e.where.find("t.toml:28:"), std::string::npos) << "the second of the two: " << e.where;
  const auto shared = read_bench_text(bench_text("twin_python.toml", {{"port = \"board0\"", "port = \"ati0\""}}), "t.toml");
  ASSERT_TRUE(shared) << shared.error().to_text();
  EXPECT_TRUE(check_devices(*shared)) << check_devices(*shared).error().to_text();
}

TEST(BenchFile, ACalibrationOfTheReferenceThatNobodyLooksAfterIsRemarked) {
  const auto remark = [](const Changes& changes) {
    const auto bench = read_bench_text(bench_text("twin.toml", changes), "t.toml");
    EXPECT_TRUE(bench) << bench.error().to_text();
    return bench ? reference_calibration_remark(*bench) : std::string();
  };
  EXPECT_EQ(remark({}), "");
  EXPECT_EQ(remark({{"calibration_id = \"ATI-T-1\"", "calibration_id = \"OTHER\""}}), "the date under [calibration] is that of ATI-T-1, and calibration_id of [reference] is OTHER");
  EXPECT_NE(remark({{"reference = { id = \"ATI-T-1\", expires = \"2099-12-31\" }\n", ""}}).find("[calibration] has no 'reference'"), std::string::npos);
}

TEST(BenchFile, InputRegistersHaveAddressesOfTheirOwnUnlessTheyAreWritten) {
  // the scratch register at 0x0106 and an input register at the same number
  const std::string more = "scratch = { addr = 0x0106 }";
  const auto good = read_bench_text(bench_text("twin.toml", {{more, more + "\ntemperature = { addr = 0x0106, read_fc = 4 }"}}), "t.toml");
  ASSERT_TRUE(good);
  EXPECT_TRUE(check_devices(*good)) << check_devices(*good).error().to_text();
  EXPECT_NE(mistake({{more, more + "\ntemperature = { addr = 0x0106, read_fc = 4 }\nhumidity = { addr = 0x0106, read_fc = 4 }"}}).text.find("overlap"),
            std::string::npos);
  EXPECT_NE(mistake({{more, more + "\nbrake = { addr = 0x0106, read_fc = 4 }"},
                     {"fault_reset = [{ reg = \"reset\", value = 1 }]", "fault_reset = [{ reg = \"brake\", value = 1 }]"}})
                .text.find("overlap"),
            std::string::npos)
      << "what is written lies among the holding registers";
}

TEST(BenchFile, AFileInAFolderWithAColonKeepsItsLogBesideIt) {
  const auto bench = read_bench_text(bench_text("twin.toml") + "\n[specimens]\nlog = \"log.tsv\"\n", "/rigs/2026-11-27T08:30/t.toml");
  ASSERT_TRUE(bench) << bench.error().to_text();
  EXPECT_EQ(bench->specimens.log, "/rigs/2026-11-27T08:30/log.tsv");
}

TEST(BenchFile, ACalibrationOutOfDateIsFound) {
  const auto bench = read_bench_text(bench_text("twin.toml", {{"2099-12-31", "2026-01-31"}}), "t.toml");
  ASSERT_TRUE(bench);
  EXPECT_TRUE(expired(*bench, "2026-01-31").empty());
  ASSERT_EQ(expired(*bench, "2026-02-01").size(), 1U);
  EXPECT_EQ(expired(*bench, "2026-02-01")[0].id, "ATI-T-1");
}

}  // namespace
}  // namespace forcegate
