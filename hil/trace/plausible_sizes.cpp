#include "hil/trace/plausible_sizes.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "hil/base/plain_number.h"
#include "hil/base/text.h"

namespace forcegate {

Result<void> check_plausible_sizes(const Trace& trace, const std::map<std::string, std::string>& headers, const std::filesystem::path& file) {
  constexpr double kMost = 1e12, kSpikes = 1e-3;  // V or N: codes of a converter that nobody called so may be 32 bits long; share of the rows
  for (const auto& [name, unit, smaller] : {std::tuple{"F_ref", "N", "mN or uN"}, std::tuple{"U", "V", "mV or uV; codes: U_counts"}}) {
    const Channel* c = trace.find(name);
    if (c == nullptr || c->unit != unit) continue;
    const auto far = static_cast<double>(std::ranges::count_if(c->value, [](double v) { return std::fabs(v) > kMost; }));
    if (far <= kSpikes * static_cast<double>(c->value.size())) continue;
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const double v : c->value)
      if (!std::isnan(v)) low = std::min(low, v), high = std::max(high, v);
    const auto header = headers.find(c->name);
    const std::string column = header != headers.end() && !header->second.empty() ? header->second : c->name;
    return fail(ErrorCode::parse, "column \"" + column + "\" runs from " + plain_number(low) + " to " + plain_number(high) + " " + unit + ", and no bench has that", file.string(),
                std::string("name its unit (") + smaller + "), for instance --map " + shell_quoted(column + "=" + name + "_m" + unit) + ", or leave its damaged rows empty");
  }
  return {};
}

}  // namespace forcegate
