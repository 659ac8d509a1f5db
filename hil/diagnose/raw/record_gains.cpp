#include "hil/diagnose/raw/record_gains.h"

#include <algorithm>
#include <cmath>

#include "hil/base/plain_number.h"
#include "hil/trace/static_line.h"

namespace forcegate::diagnose {

namespace {

struct RecordSlope {
  std::string record;
  double V_per_N = 0.0;  // its size
  bool falls = false;    // the output, where the force rises
  double sd_N = 0.0;
};

std::vector<RecordSlope> slopes_of(const std::vector<RecordInput>& records) {
  constexpr double kFewestRows = 16.0, kFollows = 0.7;
  std::vector<RecordSlope> out;
  for (const RecordInput& r : records) {
    StaticLine line;
    for (std::size_t i = 0; i < r.rows(); ++i)
      if (r.ok[i] != 0) line.push(r.U_V[i], r.F_N[i]);
    if (line.n() < kFewestRows || !(line.variance_N2() > 0.0) || !(line.variance_V2() > 0.0)) continue;
    if (std::abs(line.covariance_VN()) < kFollows * std::sqrt(line.variance_N2() * line.variance_V2())) continue;
    out.push_back({r.name, std::abs(line.covariance_VN()) / line.variance_N2(), line.covariance_VN() < 0.0, std::sqrt(line.variance_N2())});
  }
  return out;
}

// Of records whose force moves as it does in others: in a hold the output may creep either way.
Result<void> check_signs(std::vector<RecordSlope> slopes) {
  constexpr double kMoves = 0.2;  // of the largest standard deviation of the force
  const double most_N = std::ranges::max_element(slopes, {}, &RecordSlope::sd_N)->sd_N;
  std::erase_if(slopes, [&](const RecordSlope& s) { return s.sd_N < kMoves * most_N; });
  const auto falling = std::ranges::count_if(slopes, &RecordSlope::falls), n = std::ssize(slopes);
  if (falling == 0 || falling == n) return {};
  const bool few_fall = 2 * falling <= n;
  const auto odd = std::ranges::find(slopes, few_fall, &RecordSlope::falls);
  return fail(ErrorCode::parse, std::string("the output ") + (few_fall ? "falls" : "rises") + " where the force rises, and in " + (n == 2 ? "the other record" : "most other records") + " it does not",
              odd->record, "does a column of one of them have the other sign? turn it over in the file, or leave the record out");
}

}  // namespace

Result<void> check_record_gains(const std::vector<RecordInput>& records, std::vector<std::string>& notes) {
  constexpr double kAnotherUnit = 300.0, kNoDecay = 8.0;
  const std::vector<RecordSlope> slopes = slopes_of(records);
  if (slopes.size() < 2) return {};
  FORCEGATE_CHECK_OK(check_signs(slopes));
  std::vector<double> sorted;
  for (const RecordSlope& s : slopes) sorted.push_back(s.V_per_N);
  std::ranges::sort(sorted);
  const double typical = sorted[sorted.size() / 2];
  const auto two = [](double many, double few) { return "the output per newton is " + plain_number(std::round(many / few)) + " times"; };
  const char* const wrong_unit = "is a column of one of them in mV or mN, and its header says V or N?";
  if (slopes.size() == 2) {
    const bool first = slopes[0].V_per_N > slopes[1].V_per_N;
    const RecordSlope &more = slopes[first ? 0 : 1], &less = slopes[first ? 1 : 0];
    if (more.V_per_N < kNoDecay * less.V_per_N) return {};
    const std::string text = two(more.V_per_N, less.V_per_N) + " that of " + less.record;
    if (more.V_per_N >= kAnotherUnit * less.V_per_N) return fail(ErrorCode::parse, text, more.record, wrong_unit);
    notes.push_back(more.record + ": " + text);
    return {};
  }
  for (const RecordSlope& s : slopes) {
    const double times = s.V_per_N / typical, far = std::max(times, 1.0 / times);
    if (far < kNoDecay) continue;
    const std::string text = two(far, 1.0) + (times > 1.0 ? "" : " less than") + " that of most other records";
    if (far >= kAnotherUnit) return fail(ErrorCode::parse, text, s.record, wrong_unit);
    notes.push_back(s.record + ": " + text);
  }
  return {};
}

}  // namespace forcegate::diagnose
