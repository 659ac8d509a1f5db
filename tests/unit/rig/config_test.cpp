#include "hil/rig/config.h"

#include <gtest/gtest.h>

namespace forcegate {
namespace {

TEST(Config, names_line_and_column_of_a_wrong_type) {
  const auto root = parse_config("a = 1\nlimit = \"two\"\n", "x.toml");
  ASSERT_TRUE(root);
  ConfigReader r(*root, "the file");
  double a = 0.0, limit = 0.0;
  r.number("a", a, 0.0, 10.0);
  r.number("limit", limit, 0.0, 10.0);
  const auto done = r.finish();
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().where, "x.toml:2:1");
  EXPECT_NE(done.error().text.find("must be a number"), std::string::npos);
}

TEST(Config, suggests_the_key_that_was_meant) {
  const auto root = parse_config("duratoin_s = 5\n", "x.toml");
  ConfigReader r(*root, "the file");
  double duration = 0.0;
  r.number("duration_s", duration, 0.0, 10.0);
  const auto done = r.finish();
  ASSERT_FALSE(done);
  EXPECT_NE(done.error().hint.find("duration_s"), std::string::npos);
}

TEST(Config, refuses_nan_where_a_range_is_asked) {
  const auto root = parse_config("a = nan\n", "x.toml");
  ConfigReader r(*root, "the file");
  double a = 0.0;
  EXPECT_FALSE(r.number("a", a, 0.0, 1.0));
  EXPECT_FALSE(r.finish());
}

TEST(Config, says_where_the_syntax_is_wrong) {
  const auto root = parse_config("a = [1, 2\nb = 3\n", "x.toml");
  ASSERT_FALSE(root);
  EXPECT_EQ(root.error().where.substr(0, 7), "x.toml:");
}

}  // namespace
}  // namespace forcegate
