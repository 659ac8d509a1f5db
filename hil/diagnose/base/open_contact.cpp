#include "hil/diagnose/base/open_contact.h"

namespace forcegate::diagnose {

OpenContact open_contact(const CampaignInput& input) {
  constexpr double kRest = 0.02;     // of the span, above the lowest
  constexpr double kAfter_s = 0.25;
  constexpr std::size_t kFewest = 8, kShortest = 2;  // times; rows
  constexpr double kLeast = 0.15, kMost = 0.6;       // of the recording
  if (!input.single || input.records.empty()) return {};
  const RecordInput& r = input.records.front();
  OpenContact out;
  out.rows.assign(r.rows(), 0);
  std::size_t resting = 0, in_a_row = 0;
  double left_s = -1e300;
  for (std::size_t i = 0; i < r.rows(); ++i) {
    if (r.F_N[i] < input.lowest_N + kRest * input.range_N) {
      ++resting;
      if (++in_a_row == kShortest) ++out.times;
      left_s = r.t_s[i];
      out.rows[i] = 1;
    } else {
      in_a_row = 0;
      out.rows[i] = r.t_s[i] - left_s < kAfter_s ? 1 : 0;
    }
  }
  out.share = r.rows() > 0 ? static_cast<double>(resting) / static_cast<double>(r.rows()) : 0.0;
  if (out.times < kFewest || out.share < kLeast || out.share > kMost) return {};
  return out;
}

}  // namespace forcegate::diagnose
