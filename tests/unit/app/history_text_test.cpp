// Steps of a model: an export's law for all records is measured by another error than an effect that was added.

#include "hil/app/model/history.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "hil/model/model_toml.h"

namespace forcegate {
namespace {

History with_both_steps() {
  History out;
  HistoryStep added, exported;
  added.effect = "hysteresis";
  added.campaign = exported.campaign = "m7";
  added.error_before = 0.06;
  added.error_after = 0.012;
  added.floor = 0.004;
  exported.error_before = exported.plain_before = 0.107;
  exported.error_after = exported.plain_after = 0.0663;
  exported.one_law = true;
  out.model.history = {added, exported};
  return out;
}

TEST(HistoryText, TellsTheLawForAllRecordsApartFromARefit) {
  const std::string text = history_text(with_both_steps());
  EXPECT_NE(text.find("+ hysteresis"), std::string::npos) << text;
  EXPECT_NE(text.find("one law for all"), std::string::npos) << text;
  EXPECT_EQ(text.find("refit"), std::string::npos) << text;
  EXPECT_EQ(text.find("floor 0"), std::string::npos) << text;
}

TEST(HistoryText, AFloorThatIsNotKnownIsNull) {
  const auto steps = nlohmann::json::parse(history_json(with_both_steps()))["steps"];
  EXPECT_DOUBLE_EQ(steps[0]["floor"].get<double>(), 0.004);
  EXPECT_TRUE(steps[1]["floor"].is_null());
  EXPECT_TRUE(steps[1]["one_law"].get<bool>());
}

TEST(HistoryText, WhatAddAdvisesToLeaveOutLeadsToNoHeader) {
  History h = with_both_steps();
  h.model.effects.emplace_back().effect = "hysteresis";
  EXPECT_FALSE(leads_to_no_use(h.model));
  HistoryStep& step = h.model.history.front();
  step.error_before = 0.00180, step.error_after = 0.00179;  // "accepted", by half a percent
  step.plain_before = 0.1336, step.plain_after = 0.1337;
  EXPECT_TRUE(leads_to_no_use(h.model));
  EXPECT_NE(history_text(h).find("not shown by them"), std::string::npos) << history_text(h);
  step.plain_after = 0.08;
  EXPECT_FALSE(leads_to_no_use(h.model)) << "a law for all records needs it";
  step.error_after = step.error_before;
  EXPECT_FALSE(leads_to_no_use(h.model));
  step.plain_after = step.plain_before;
  EXPECT_TRUE(leads_to_no_use(h.model));
}

TEST(HistoryText, AModelFileKeepsIt) {
  const auto again = parse_model(write_model(with_both_steps().model), "m.toml");
  ASSERT_TRUE(again) << again.error().to_text();
  ASSERT_EQ(again->history.size(), 2U);
  EXPECT_FALSE(again->history[0].one_law);
  EXPECT_DOUBLE_EQ(again->history[0].floor, 0.004);
  EXPECT_TRUE(again->history[1].one_law);
}

}  // namespace
}  // namespace forcegate
