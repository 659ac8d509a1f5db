#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "hil/report/result_json.h"
#include "tests/support/sample_run.h"

namespace forcegate {
namespace {

using nlohmann::json;
using sample::Variant;
using testing::HasSubstr;

json schema() {
  std::ifstream in(FORCEGATE_SOURCE_DIR "/docs/schema/result.schema.json");
  return json::parse(in);
}

/// The part of JSON Schema 2020-12 that the schema uses; any other keyword is an error of the schema.
void validate(const json& root, const json& rule, const json& value, const std::string& where,
              std::vector<std::string>& errors) {
  static const std::set<std::string> kKnown{
      "$schema",     "$id",  "$defs",      "$ref",     "title",
      "description", "type", "properties", "required", "additionalProperties",
      "items",       "enum", "const",      "minimum",  "pattern"};
  for (const auto& item : rule.items())
    if (!kKnown.contains(item.key())) errors.push_back("schema keyword " + item.key() + " at " + where);
  if (rule.contains("$ref")) {
    const std::string name = rule["$ref"].get<std::string>().substr(std::string("#/$defs/").size());
    return validate(root, root.at("$defs").at(name), value, where, errors);
  }
  const auto is = [&](const std::string& type) {
    return (type == "object" && value.is_object()) || (type == "array" && value.is_array()) ||
           (type == "string" && value.is_string()) || (type == "boolean" && value.is_boolean()) ||
           (type == "integer" && value.is_number_integer()) || (type == "number" && value.is_number()) ||
           (type == "null" && value.is_null());
  };
  if (rule.contains("type")) {
    bool fits = false;
    if (rule["type"].is_string())
      fits = is(rule["type"]);
    else
      for (const auto& t : rule["type"]) fits |= is(t);
    if (!fits) return errors.push_back(where + " is not " + rule["type"].dump());
  }
  if (rule.contains("const") && value != rule["const"])
    errors.push_back(where + " is not " + rule["const"].dump());
  if (rule.contains("enum") &&
      std::find(rule["enum"].begin(), rule["enum"].end(), value) == rule["enum"].end())
    errors.push_back(where + " = " + value.dump() + " is not allowed");
  if (rule.contains("minimum") && value.is_number() && value < rule["minimum"])
    errors.push_back(where + " is too small");
  if (rule.contains("pattern") && value.is_string() && !(value == "inf" || value == "-inf"))
    errors.push_back(where + " is a text that is no number");
  if (value.is_object()) {
    for (const auto& name : rule.value("required", json::array()))
      if (!value.contains(name.get<std::string>()))
        errors.push_back(where + "." + name.get<std::string>() + " is missing");
    for (const auto& item : value.items()) {
      const json& properties = rule.contains("properties") ? rule["properties"] : json::object();
      if (properties.contains(item.key()))
        validate(root, properties[item.key()], item.value(), where + "." + item.key(), errors);
      else if (rule.contains("additionalProperties") && rule["additionalProperties"].is_object())
        validate(root, rule["additionalProperties"], item.value(), where + "." + item.key(), errors);
      else
        errors.push_back(where + "." + item.key() + " is not in the schema");
    }
  }
  if (value.is_array() && rule.contains("items"))
    for (std::size_t i = 0; i < value.size(); ++i)
      validate(root, rule["items"], value[i], where + "[" + std::to_string(i) + "]", errors);
}

TEST(ResultJson, of_every_variant_follows_the_schema) {
  const json rules = schema();
  for (const Variant v : {Variant::accept, Variant::reject, Variant::no_decision, Variant::rig_fault}) {
    std::vector<std::string> errors;
    validate(rules, rules, json::parse(to_json(sample::run(v, 60.0))), "result", errors);
    EXPECT_THAT(errors, testing::IsEmpty());
  }
}

/// The list of words of every "enum" of the schema that a key of this name has.
std::vector<std::vector<std::string>> enums(const json& node, const std::string& name) {
  std::vector<std::vector<std::string>> out;
  if (node.is_object())
    for (const auto& item : node.items()) {
      if (item.key() == name && item.value().is_object() && item.value().contains("enum")) out.push_back(item.value()["enum"]);
      for (auto& deeper : enums(item.value(), name)) out.push_back(std::move(deeper));
    }
  return out;
}

template <class E>
std::vector<std::string> words() {
  const auto views = words_of<E>();
  return {views.begin(), views.end()};
}

TEST(ResultJson, the_words_of_the_enumerations_are_those_of_the_schema) {
  using Lists = std::vector<std::vector<std::string>>;
  const json rules = schema();
  EXPECT_EQ(enums(rules, "verdict"), Lists{words<Verdict>()});
  EXPECT_EQ(enums(rules, "blame"), (Lists{words<Blame>(), words<Blame>()}));
  EXPECT_EQ(enums(rules, "level"), Lists{words<CalibrationLevel>()});
  EXPECT_THAT(enums(rules, "kind"), testing::UnorderedElementsAre(words<DecisionKind>(), words<Limit::Kind>()));
  EXPECT_EQ(words<Verdict>().size(), 7U);
  EXPECT_EQ(words<Blame>().size(), 10U);
}

TEST(ResultJson, a_value_beyond_its_enumeration_is_no_word_and_is_refused) {
  RunResult r = sample::run(Variant::accept, 60.0);
  r.checks.front().verdict = static_cast<Verdict>(99);
  const auto back = result_from_json(to_json(r));
  ASSERT_FALSE(back.has_value());
  EXPECT_THAT(back.error().to_text(), HasSubstr("is not one of the allowed words"));
}

TEST(ResultJson, the_time_of_a_reading_stands_only_where_it_is_declared) {
  RunResult r = sample::run(Variant::accept, 60.0);
  EXPECT_THAT(to_json(r), testing::Not(HasSubstr("reference_u_time_s")));
  r.rig.reference_u_time_s = 0.1;
  std::vector<std::string> errors;
  const json rules = schema();
  validate(rules, rules, json::parse(to_json(r)), "result", errors);
  EXPECT_THAT(errors, testing::IsEmpty());
  EXPECT_EQ(result_from_json(to_json(r))->rig.reference_u_time_s, 0.1);
}

TEST(ResultJson, the_schema_refuses_what_is_not_a_result) {
  const json rules = schema();
  json value = json::parse(to_json(sample::run(Variant::accept, 60.0)));
  value["decision"]["kind"] = "MAYBE";
  value["cases"][0]["checks"][0].erase("u");
  value["cases"][0]["samples"] = "many";
  value["surprise"] = 1;
  std::vector<std::string> errors;
  validate(rules, rules, value, "result", errors);
  EXPECT_EQ(errors.size(), 4u);
}

TEST(ResultJson, reads_back_to_the_same_bytes) {
  for (const Variant v : {Variant::accept, Variant::reject, Variant::no_decision, Variant::rig_fault}) {
    const std::string text = to_json(sample::run(v, 60.0));
    const auto back = result_from_json(text);
    ASSERT_TRUE(back.has_value()) << back.error().to_text();
    EXPECT_EQ(to_json(*back), text);
  }
}

TEST(ResultJson, keeps_all_digits_and_large_seeds) {
  RunResult r = sample::run(Variant::accept, 60.0);
  r.checks[0].value = 0.1 + 0.2;
  r.seed = 0xFFFFFFFFFFFFFFFFull;
  r.cases[0].window[0].value[0] = 0.1f;
  const auto back = result_from_json(to_json(r));
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->checks[0].value, 0.1 + 0.2);
  EXPECT_EQ(back->seed, 0xFFFFFFFFFFFFFFFFull);
  EXPECT_EQ(back->cases[0].window[0].value[0], 0.1f);
  EXPECT_THAT(to_json(r), HasSubstr("0.30000000000000004"));
}

TEST(ResultJson, writes_nan_as_null_and_infinity_as_text) {
  RunResult r = sample::run(Variant::accept, 60.0);
  r.checks[0].value = std::nan("");
  r.checks[1].value = -INFINITY;
  const std::string text = to_json(r);
  EXPECT_THAT(text, HasSubstr("\"value\": null"));
  EXPECT_THAT(text, HasSubstr("\"value\": \"-inf\""));
  const auto back = result_from_json(text);
  ASSERT_TRUE(back.has_value());
  EXPECT_TRUE(std::isnan(back->checks[0].value));
  EXPECT_EQ(back->checks[1].value, -INFINITY);
}

TEST(ResultJson, differs_between_two_runs_in_the_time_stamp_line_only) {
  RunResult a = sample::run(Variant::accept, 60.0), b = a;
  b.started_at = "2027-01-01T00:00:00Z";
  std::istringstream la(to_json(a)), lb(to_json(b));
  std::string x, y;
  int different = 0;
  while (std::getline(la, x) && std::getline(lb, y))
    if (x != y) {
      ++different;
      EXPECT_THAT(x, HasSubstr("started_at"));
    }
  EXPECT_EQ(different, 1);
}

TEST(ResultJson, is_valid_json_even_with_hostile_texts) {
  const json value = json::parse(to_json(sample::hostile()), nullptr, false);
  ASSERT_FALSE(value.is_discarded());
  EXPECT_EQ(value["plan_name"].get<std::string>().find('\x1b'), std::string::npos);
}

struct Mistake {
  std::string find, replace, expect;
};
class ResultJsonMistake : public testing::TestWithParam<Mistake> {};

TEST_P(ResultJsonMistake, is_named_with_its_place) {
  std::string text = to_json(sample::run(Variant::accept, 60.0));
  const std::size_t at = text.find(GetParam().find);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, GetParam().find.size(), GetParam().replace);
  const auto result = result_from_json(text, "x.json");
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::parse);
  EXPECT_EQ(result.error().where, "x.json");
  EXPECT_THAT(result.error().text, HasSubstr(GetParam().expect));
}

INSTANTIATE_TEST_SUITE_P(
    Places, ResultJsonMistake,
    testing::Values(Mistake{"\"format\": 1", "\"format\": 2", "format 2"},
                    Mistake{"\"format\": 1", "\"format\": \"1\"", "whole number 'format'"},
                    Mistake{"\"seed\": 7", "\"seed\": -7", "seed is not a whole number"},
                    Mistake{"\"exit_code\": 0", "\"exit_code\": 1e99", "decision.exit_code"},
                    Mistake{"\"level\": \"identified\"", "\"level\": \"best\"", "cases[0].calibration.level"},
                    Mistake{"\"safety_stop\"", "\"safety_stopp\"", "decision.safety_stop is missing"},
                    Mistake{"\"tool_version\"", "\"x\": 1, \"tool_version\"", "x is not a field"},
                    Mistake{"\"notes\": [", "\"notes\": [{},", "notes[0] is not a text"}));

/// A small result as format 1 was written; it is never made anew while the format is 1.
TEST(ResultJson, reads_the_stored_sample_of_format_1) {
  const std::string path = FORCEGATE_SOURCE_DIR "/tests/data/report/result_format1.json";
  const auto result = read_result(path);
  ASSERT_TRUE(result.has_value()) << result.error().to_text();
  EXPECT_EQ(result->decision.kind, DecisionKind::reject);
  EXPECT_EQ(result->cases.size(), 3u);
  EXPECT_EQ(result->cases[1].calibration.level, CalibrationLevel::identified);
  std::ifstream in(path, std::ios::binary);
  std::ostringstream stored;
  stored << in.rdbuf();
  EXPECT_EQ(to_json(*result), stored.str());
}

TEST(ResultJson, refuses_what_is_not_json) {
  for (const char* text : {"", "[]", "{", "null", "{}", "\xff\xfe"}) {
    const auto result = result_from_json(text);
    ASSERT_FALSE(result.has_value()) << text;
    EXPECT_EQ(result.error().code, ErrorCode::parse);
  }
}

TEST(ResultJson, names_a_file_that_is_not_there) {
  const auto result = read_result("/no/such/result.json");
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::io);
  EXPECT_EQ(result.error().where, "/no/such/result.json");
}

}  // namespace
}  // namespace forcegate
