// The calibration file that a study writes for the gate.

#include <gtest/gtest.h>

#include "hil/app/characterize/characterize.h"

namespace forcegate {
namespace {

TEST(CalibrationText, MarksWhatOfTheConverterIsAssumed) {
  characterize::SessionSheet sheet;
  sheet.specimen = "a.csv";
  EXPECT_EQ(calibration_text(sheet).find("assumed"), std::string::npos);
  sheet.assumed_converter = "adc_bits = 16, v_range_V = 10";
  const std::string text = calibration_text(sheet);
  EXPECT_NE(text.find("\n# assumed, since nothing states the converter: adc_bits = 16, v_range_V = 10\nadc_bits = 16\n"), std::string::npos) << text;
}

}  // namespace
}  // namespace forcegate
