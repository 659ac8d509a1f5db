// What bench doctor says of instruments that answer, and of which the answer is worth nothing.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "hil/app/bench/bench.h"
#include "tests/support/folder_test.h"
#include "tests/support/twin_bench.h"

namespace forcegate {
namespace {

using ::testing::HasSubstr;

class BenchDoctor : public FolderTest {
 protected:
  BenchItem item(const std::string& name, const std::string& text) const {
    const auto items = examine_bench(put("b.toml", text), {});
    EXPECT_TRUE(items) << items.error().to_text();
    if (items)
      for (const BenchItem& one : *items)
        if (one.name == name) return one;
    ADD_FAILURE() << "nothing is said of the " << name;
    return {};
  }
};

TEST_F(BenchDoctor, AReferenceWithoutAnyValidReadingIsBad) {
  const std::string text = test::bench_text("twin.toml");
  const BenchItem sound = item("reference", text);
  EXPECT_TRUE(sound.good);
  EXPECT_THAT(sound.found, HasSubstr(" readings in 0.1 s"));
  EXPECT_EQ(sound.found.find("not valid"), std::string::npos) << sound.found;
  const BenchItem faulty = item("reference", text + "\n[[twins.fault]]\ndevice = \"reference\"\nkind = \"saturation\"\nat_s = 0\nfor_s = 1000\n");
  EXPECT_FALSE(faulty.good);
  EXPECT_THAT(faulty.found, HasSubstr("is valid: the reference is overloaded"));
  EXPECT_THAT(faulty.remedy, HasSubstr("unload the sensor"));
}

TEST_F(BenchDoctor, ACalibrationOfTheReferenceWithoutADateOfItsOwnIsBad) {
  const BenchItem other = item("calibration", test::bench_text("twin.toml", {{"calibration_id = \"ATI-T-1\"", "calibration_id = \"OTHER\""}}));
  EXPECT_FALSE(other.good);
  EXPECT_THAT(other.found, HasSubstr("calibration_id of [reference] is OTHER"));
}

TEST_F(BenchDoctor, OfASilentReferenceNamesWhatThereIsToLookAt) {
  EXPECT_THAT(no_reading({}, "ati_serial").error().hint, HasSubstr("the controller's display"));
  const std::string of_program = no_reading({{"refused", 0}}, "process").error().hint;
  EXPECT_THAT(of_program, HasSubstr("answers 'poll' without rows"));
  EXPECT_EQ(of_program.find("display"), std::string::npos) << of_program;
  EXPECT_THAT(no_reading({{"refused", 3}}, "process").error().text, HasSubstr("3 refused"));
}

TEST_F(BenchDoctor, AStreamFarFromItsDeclaredRateIsBad) {
  EXPECT_EQ(far_from_declared(27, 0.1, 274), "");
  EXPECT_EQ(far_from_declared(110, 0.1, 274), "") << "what an adapter had gathered";
  EXPECT_EQ(far_from_declared(200000, 0.5, 0), "") << "none is declared";
  EXPECT_EQ(far_from_declared(200000, 0.5, 274), ", and rate_Hz = 274 declares 137");
}

TEST_F(BenchDoctor, AnAngleOutsideTheTravelIsBad) {
  for (const char* scale : {"scale = -20860.756700940907", "scale = 1"}) {
    const BenchItem motor = item("motor", test::bench_text("twin.toml", {{"scale = 20860.756700940907", scale}}));
    EXPECT_FALSE(motor.good) << scale;
    EXPECT_THAT(motor.found, HasSubstr("outside its travel of 0 to 3.14")) << scale;
    EXPECT_THAT(motor.remedy, HasSubstr("sign and scale of 'position'")) << scale;
  }
}

}  // namespace
}  // namespace forcegate
