#include "hil/diagnose/candidates/command_jumps.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace forcegate::diagnose {
namespace {

RecordInput commanded(std::vector<double> command) {
  RecordInput out;
  out.row_step_s = 0.02;
  out.rig_force_N = std::move(command);
  return out;
}

std::vector<std::size_t> all_rows(const RecordInput& record) {
  std::vector<std::size_t> out(record.rig_force_N.size());
  std::iota(out.begin(), out.end(), 0u);
  return out;
}

TEST(CommandJumps, TheTenthOfASecondBehindAJumpSaysNothing) {
  const RecordInput record = commanded([] {
    std::vector<double> c(100, 1.0);
    for (std::size_t i = 50; i < c.size(); ++i) c[i] = 4.0;
    return c;
  }());
  std::vector<std::size_t> rows = all_rows(record);
  leave_out_command_jumps(record, 5.0, rows);
  EXPECT_THAT(rows, ::testing::Contains(47u));
  for (std::size_t row = 49; row <= 55; ++row) EXPECT_THAT(rows, ::testing::Not(::testing::Contains(row)));
  EXPECT_THAT(rows, ::testing::Contains(60u));
}

TEST(CommandJumps, RampsAndSlowSinesKeepEveryRow) {
  for (const double frequency_Hz : {0.1, 1.0, 2.0}) {
    std::vector<double> c;
    for (int i = 0; i < 500; ++i) c.push_back(2.5 + 2.5 * std::sin(2.0 * 3.14159265 * frequency_Hz * 0.02 * i));
    const RecordInput record = commanded(c);
    std::vector<std::size_t> rows = all_rows(record);
    leave_out_command_jumps(record, 5.0, rows);
    EXPECT_EQ(rows.size(), c.size()) << frequency_Hz;
  }
}

TEST(CommandJumps, ACommandThatIsAllJumpsIsTakenAsItIs) {
  std::vector<double> c;
  for (int i = 0; i < 300; ++i) c.push_back(i / 3 % 2 == 0 ? 1.0 : 4.0);
  const RecordInput record = commanded(c);
  std::vector<std::size_t> rows = all_rows(record);
  leave_out_command_jumps(record, 5.0, rows);
  EXPECT_EQ(rows.size(), c.size());
}

}  // namespace
}  // namespace forcegate::diagnose
