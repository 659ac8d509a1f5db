#include "hil/diagnose/base/open_contact.h"

#include <algorithm>

#include "hil/base/quantile.h"
#include "hil/model/record_input.h"

namespace forcegate::diagnose {

namespace {

struct Rests {
  std::vector<std::uint8_t> rows;
  std::size_t times = 0;
  double share = 0.0;
};

Rests rests_of(const RecordInput& r, double lowest_N, double range_N) {
  constexpr double kRest = 0.02;  // of the span, above the lowest
  constexpr double kShortest_s = 0.25, kLongest_s = 0.5, kOfContact = 1.0 / 3.0;
  constexpr std::size_t kShortest = 2;  // rows
  Rests out;
  out.rows.assign(r.rows(), 0);
  std::size_t resting = 0, in_a_row = 0;
  std::vector<double> made_s;  // how long the contact is made
  double left_s = -1e300;
  for (std::size_t i = 0; i < r.rows(); ++i) {
    if (r.F_N[i] >= lowest_N + kRest * range_N) {
      in_a_row = 0;
      continue;
    }
    ++resting;
    out.rows[i] = 1;
    if (in_a_row == 0 && left_s > -1e299) made_s.push_back(r.t_s[i] - left_s);
    if (++in_a_row == kShortest) ++out.times;
    left_s = r.t_s[i];
  }
  out.share = r.rows() > 0 ? static_cast<double>(resting) / static_cast<double>(r.rows()) : 0.0;
  const double after_s = made_s.empty() ? kShortest_s : std::max(kShortest_s, std::min(kLongest_s, kOfContact * quantile(std::move(made_s), 0.5)));
  left_s = -1e300;
  for (std::size_t i = 0; i < r.rows(); ++i) {
    if (out.rows[i] != 0) left_s = r.t_s[i];
    else if (r.t_s[i] - left_s < after_s) out.rows[i] = 1;
  }
  return out;
}

}  // namespace

OpenContact open_contact(const CampaignInput& input) {
  constexpr std::size_t kFewest = 8;
  constexpr double kLeast = 0.15, kMost = 0.6;  // of the recording
  OpenContact out;
  out.rows.resize(input.records.size());
  double share = 0.0;
  std::size_t records = 0;
  // the blocks of one recording are not made yet, or hold the same rows
  for (std::size_t k = 0; k < input.records.size(); ++k) {
    if (input.single && k > 0) {
      out.rows[k] = out.rows.front();
      continue;
    }
    Rests rests = rests_of(input.records[k], input.lowest_N, input.range_N);
    if (rests.times < kFewest || rests.share < kLeast || rests.share > kMost) continue;
    out.times += rests.times;
    share += rests.share;
    ++records;
    out.rows[k] = std::move(rests.rows);
  }
  const std::size_t of = input.single ? std::min<std::size_t>(1, input.records.size()) : input.records.size();
  if (records == 0 || 2 * records < of) return {};
  out.share = share / static_cast<double>(records);
  return out;
}

void leave_out_open(const OpenContact& open, CampaignInput& input) {
  for (std::size_t k = 0; k < std::min(input.records.size(), open.rows.size()); ++k)
    for (std::size_t i = 0; i < open.rows[k].size(); ++i)
      if (open.rows[k][i] != 0) input.records[k].ok[i] = 0;
}

}  // namespace forcegate::diagnose
