// What answers say to people on the console.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/app/diagnose/diagnose.h"
#include "hil/app/model/fit.h"

namespace forcegate {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(DiagnosisText, SaysWhenChanceAlonePassesTheThreshold) {
  Diagnosis d;
  EXPECT_THAT(diagnosis_text(d), Not(HasSubstr("by chance")));
  d.expected_false = 0.83;
  EXPECT_THAT(diagnosis_text(d), HasSubstr("turned over by chance, 0.83 effects pass the threshold"));
}

TEST(DiagnosisJson, GivesAClaimAboutRawSamplesTheErrorOfItsOwnStep) {
  Diagnosis d;
  d.error_before = 0.068;
  d.error_after = 0.0032;
  d.steps = {{"", 0.0532}, {"static_nonlinearity", 0.0032}};
  Finding hum;
  hum.effect = "hum", hum.form = "raw", hum.probability = 0.95, hum.error_before = 0.068, hum.error_after = 0.0032;
  d.findings = {hum};
  EXPECT_THAT(to_json(d), HasSubstr("\"error_after\": 0.0532"));
  const std::string json = to_json(d), all = "\"error_after\": 0.0032";
  EXPECT_NE(json.find(all), std::string::npos) << "of all that was found";
  EXPECT_EQ(json.find(all), json.rfind(all)) << "of all that was found, and of nothing else";
}

TEST(WaterfallText, PrintsNoRoundingOfTheFitAsAChange) {
  diagnose::Waterfall w;
  w.start = 2.5e-3;
  w.end = 1.2e-3;
  w.unit = "V";
  w.bars = {{.effect = "creep", .as_added = 1.3e-3, .average = 1.3e-3, .low = 1.3e-3, .high = 1.3e-3, .hollow = false},
            {.effect = "delay", .as_added = 3.54e-14, .average = -3.5e-14, .low = 0.0, .high = 1e-14, .hollow = true}};
  const std::string text = waterfall_text(w);
  EXPECT_THAT(text, HasSubstr("    -1.3 mV"));
  EXPECT_THAT(text, HasSubstr("over all orders 0 [0, 0]"));
  EXPECT_THAT(text, Not(HasSubstr("e-1")));
}

TEST(WaterfallText, SpeaksOfAllOrdersOnlyWhereTheyWereAsked) {
  diagnose::Waterfall w;
  w.start = 2.5e-3;
  w.end = 1.2e-3;
  w.all_orders = false;
  w.bars = {{.effect = "creep", .as_added = 1.3e-3, .average = 1.3e-3, .low = 1.3e-3, .high = 1.3e-3, .hollow = false}};
  EXPECT_THAT(waterfall_text(w), Not(HasSubstr("over all orders")));
  EXPECT_THAT(waterfall_text(w), HasSubstr("in this order"));
}

TEST(WaterfallText, AFitThatFailsIsNoFallToNothing) {
  diagnose::Waterfall w;
  w.start = w.end = 2.5e-3;
  w.bars = {{.effect = "creep", .as_added = kMissing, .average = kMissing, .low = kMissing, .high = kMissing, .hollow = true}};
  EXPECT_THAT(waterfall_text(w), HasSubstr("over all orders ? [?, ?]"));
  EXPECT_THAT(waterfall_text(w), Not(HasSubstr("nan")));
  EXPECT_THAT(waterfall_json(w), HasSubstr("\"as_added\":null"));
}

}  // namespace
}  // namespace forcegate
