#include "hil/diagnose/candidates/command_jumps.h"

#include <algorithm>
#include <cmath>

namespace forcegate::diagnose {

void leave_out_command_jumps(const RecordInput& record, double range_N, std::vector<std::size_t>& rows) {
  constexpr double kJump = 0.15, kBehind_s = 0.1, kFewestLeft = 0.4;
  const std::vector<double>& command = record.rig_force_N;
  const auto n = static_cast<std::ptrdiff_t>(command.size());
  const auto behind = static_cast<std::ptrdiff_t>(std::ceil(kBehind_s / record.row_step_s)) + 1;
  std::vector<char> jumps(command.size(), 0);
  for (std::ptrdiff_t i = 1; i + 1 < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (std::abs(command[at + 1] - 2.0 * command[at] + command[at - 1]) > kJump * range_N)
      std::fill(jumps.begin() + i - 1, jumps.begin() + std::min(n, i + behind + 1), char{1});
  }
  std::vector<std::size_t> left;
  for (const std::size_t row : rows)
    if (jumps[row] == 0) left.push_back(row);
  if (static_cast<double>(left.size()) >= kFewestLeft * static_cast<double>(rows.size())) rows = std::move(left);
}

}  // namespace forcegate::diagnose
