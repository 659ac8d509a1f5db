#include "hil/trace/set_earlier.h"

#include <fmt/format.h>

#include <cmath>

#include "hil/trace/common_clock.h"

namespace forcegate {

Result<void> set_output_earlier(Campaign& campaign, double late_s) {
  if (late_s == 0.0) return {};
  for (Record& record : campaign.records) {
    Channel* output = record.trace.find("U");
    if (output == nullptr) continue;
    TimeBase own = record.trace.time_bases[output->time_base];
    if (own.t_s.empty() || own.t_s.back() - own.t_s.front() <= std::abs(late_s))
      return fail(ErrorCode::config, fmt::format("the record is no longer than the output is said to be late ({:.4g} s)", late_s), record.place(), "a shorter --late, in seconds");
    for (double& t_s : own.t_s) t_s -= late_s;
    for (Gap& gap : own.gaps) gap.from_s -= late_s, gap.to_s -= late_s;
    output->time_base = record.trace.time_bases.size();
    record.trace.time_bases.push_back(std::move(own));
    put_on_common_clock(record.trace);
  }
  campaign.notes.push_back(fmt::format("the output was set {:.4g} s earlier, as asked", late_s));
  return {};
}

}  // namespace forcegate
