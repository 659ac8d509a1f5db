#include "hil/trace/sensor_name.h"

#include <gtest/gtest.h>

#include <string>

#include "hil/trace/campaign.h"
#include "tests/support/folder_test.h"

namespace forcegate {
namespace {

TEST(SensorName, IsThatOfOneOfTheTwo) {
  for (const char* fsr : {"FSR 402", "Interlink 406, new", "fsr-like film (40 mm)", "two FSRs", "U_FSR_V", "fsr402_run1", "a force sensing resistor"})
    EXPECT_EQ(sensor_named_in(fsr), NamedSensor::fsr) << fsr;
  for (const char* flexiforce : {"FlexiForce A201", "FlexiForce beside an FSR", "U_flexiforce_V"}) EXPECT_EQ(sensor_named_in(flexiforce), NamedSensor::flexiforce) << flexiforce;
  for (const char* neither : {"", "A201", "fsrc_N", "offsrate", "U_V", "load cell"}) EXPECT_EQ(sensor_named_in(neither), NamedSensor::none) << neither;
}

class SensorOfFiles : public FolderTest {
 protected:
  std::string sensor(const std::string& of = "") const {
    const auto campaign = read_campaign(of.empty() ? folder_ : folder_ / of);
    EXPECT_TRUE(campaign) << campaign.error().to_text();
    return campaign ? campaign->sensor : "nothing was read";
  }
};

const std::string kRows = "0,1,2\n0.1,2,3\n0.2,3,4\n";
const std::string kPlain = "t_s,F_ref_N,U_V\n" + kRows;

TEST_F(SensorOfFiles, StandsAboveTheRows) {
  put("a.csv", "# bench 3\n#  FSR 402, divider 2.2 kOhm\n" + kPlain);
  EXPECT_EQ(sensor("a.csv"), "FSR 402, divider 2.2 kOhm");
  put("b.csv", "bench 3\nInterlink 406\n\n" + kPlain);
  EXPECT_EQ(sensor("b.csv"), "Interlink 406");
  put("c.csv", "# FSR\n# t_s F_ref_N U_V\n0 1 2\n0.1 2 3\n0.2 3 4\n");
  EXPECT_EQ(sensor("c.csv"), "FSR");
}

TEST_F(SensorOfFiles, IsTheNameOfTheOutput) {
  put("a.csv", "t_s,F_ref_N,U_FSR_V\n" + kRows);
  EXPECT_EQ(sensor("a.csv"), "U_FSR_V");
  put("b.csv", "t_s,F_fsr_N,U_V\n" + kRows);
  EXPECT_EQ(sensor("b.csv"), "") << "of the output alone";
}

TEST_F(SensorOfFiles, IsTheNameOfTheFileWhereNothingElseTells) {
  put("fsr402_1.csv", kPlain);
  EXPECT_EQ(sensor("fsr402_1.csv"), "fsr402_1");
  EXPECT_EQ(sensor(), "fsr402_1");
  put("fsr402_2.csv", "# FlexiForce A201\n" + kPlain + "0.3,4,5\n");
  EXPECT_EQ(sensor(), "FlexiForce A201");
}

TEST_F(SensorOfFiles, IsOpenWhereFilesContradict) {
  put("fsr_a.csv", "# FSR 402\n" + kPlain);
  put("fsr_b.csv", "# FlexiForce A201\n" + kPlain + "0.3,4,5\n");
  EXPECT_EQ(sensor(), "") << "nor do their names decide";
}

TEST_F(SensorOfFiles, WhatIsDeclaredGoesBefore) {
  put("a.csv", "# FSR 402\n" + kPlain);
  put("campaign.json", R"({"sensor": "A201"})");
  EXPECT_EQ(sensor(), "A201");
  put("campaign.json", R"({"records": [{"file": "a.csv"}]})");
  EXPECT_EQ(sensor(), "FSR 402");
}

}  // namespace
}  // namespace forcegate
