// The firmware evaluates an equation as muParser does.

#include "hil/model/compensator/c_expression.h"

#include <gtest/gtest.h>

#include <cmath>

#include "hil/app/export/compensator_check.h"
#include "hil/model/compensator/compensator.h"
#include "tests/unit/compensator/to_and_fro.h"

namespace forcegate {
namespace {

std::string c_of(const std::string& equation) {
  const auto c = c_expression(equation, "test", {{"x", "x"}, {"t", "t"}, {"n", "n"}});
  return c ? c->text : c.error().to_text();
}

TEST(CExpression, AWholePowerIsAProductOfNegativeNumbersToo) {
  EXPECT_EQ(c_of("x^3"), "((x * x) * x)");
  EXPECT_EQ(c_of("x^(2)"), "(x * x)");
  EXPECT_EQ(c_of("x^0"), "1.0f");
  EXPECT_EQ(c_of("x^8"), "fg_power(x, 8)");
  EXPECT_EQ(c_of("x^-1"), "(1.0f / x)");
  EXPECT_EQ(c_of("x^(-2)"), "(1.0f / (x * x))");
  EXPECT_EQ(c_of("-x^2"), "(-(x * x))");
}

TEST(CExpression, AnotherPowerAsksForABaseThatIsNeverNegative) {
  for (const char* equation : {"x^0.5", "x^n", "(x - 1)^1.5", "x^-0.5", "(x^3)^0.5", "min(x, 1)^0.5"})
    EXPECT_NE(c_of(equation).find("may be negative"), std::string::npos) << equation << ": " << c_of(equation);
  for (const char* equation : {"abs(x)^0.5", "max(x, 0)^n", "t^0.3", "(x^2 + 1)^0.5", "2^x", "exp(x)^n", "(t / 3)^0.2"})
    EXPECT_NE(c_of(equation).find("fg_pow("), std::string::npos) << equation << ": " << c_of(equation);
}

// All of them are asked on both sides of zero.
TEST(CExpression, PowersAreThoseOfTheModel) {
  Campaign c;
  c.name = "powers";
  c.records = {record()};
  for (const char* equation : {"k * (F - 2)^3", "k * (F - 2)^7", "k * ((F - 2) / 2)^8", "k * (F - 9)^-2", "k * abs(F - 2)^1.5", "k * max(F - 2, 0)^1.3"}) {
    Model m;
    m.law.decays = false;
    m.user_effects.push_back({"mine", {{"k", "1", 0.004}}, {}, equation});
    const auto made = make_compensator(m, {});
    ASSERT_TRUE(made) << equation << made.error().to_text();
    const auto check = check_compensator(m, *made, 1000.0, c);
    ASSERT_TRUE(check) << equation << check.error().to_text();
    EXPECT_LT(check->largest_N, 1e-5) << equation;
  }
}

}  // namespace
}  // namespace forcegate
