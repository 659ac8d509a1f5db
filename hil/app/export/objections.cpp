// What speaks against putting a header into firmware.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/app/export/compensator_check.h"
#include "hil/base/plain_number.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

constexpr double kLarger = 1.02;

using Records = std::vector<const ReplayedRecord*>;

double root_mean_square(const Records& records, double ReplayedRecord::* error_N) {
  double sum = 0.0;
  for (const ReplayedRecord* r : records) sum += r->*error_N * (r->*error_N);
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, records.size())));
}

std::string from_to(const Records& records, double ReplayedRecord::* before_N, double ReplayedRecord::* after_N) {
  return plain_number(1e3 * root_mean_square(records, before_N)) + " -> " + plain_number(1e3 * root_mean_square(records, after_N)) + " mN";
}

bool larger(const Records& records) {
  return root_mean_square(records, &ReplayedRecord::compensated_rms_N) > kLarger * root_mean_square(records, &ReplayedRecord::plain_rms_N);
}

// Worst first: the records without which the error of the others is not larger.
struct Carried {
  Records by, others;
};

Carried carried(const CompensatorCheck& check) {
  Carried out;
  for (const ReplayedRecord& r : check.records) out.others.push_back(&r);
  const auto added = [](const ReplayedRecord* r) { return r->compensated_rms_N * r->compensated_rms_N - r->plain_rms_N * r->plain_rms_N; };
  std::ranges::sort(out.others, std::greater{}, added);
  while (!out.others.empty() && larger(out.others)) {
    out.by.push_back(out.others.front());
    out.others.erase(out.others.begin());
  }
  return out;
}

std::string few_carry_it(const Carried& c) {
  std::vector<std::string> names;
  for (const ReplayedRecord* r : c.by) names.push_back(r->record);
  const bool one = names.size() == 1;
  return fmt::format(
      ", by {} alone; the other {} records {}. With a gain and a zero of {} own {}: what {} off in gain, zero and decay no firmware knows, "
      "and it grows where an effect is undone. "
      "Record {} again, or leave {} out and fit and check anew; a firmware for such records needs a calibration before each",
      join(names, ", "), c.others.size(), from_to(c.others, &ReplayedRecord::plain_rms_N, &ReplayedRecord::compensated_rms_N), one ? "its" : "their",
      from_to(c.by, &ReplayedRecord::own_plain_rms_N, &ReplayedRecord::own_compensated_rms_N), one ? "it is" : "they are", one ? "it" : "them", one ? "it" : "them");
}

std::string most_carry_it(const CompensatorCheck& check) {
  const auto worse = std::ranges::count_if(check.records, [](const ReplayedRecord& r) { return r.compensated_rms_N > kLarger * r.plain_rms_N; });
  Records all;
  for (const ReplayedRecord& r : check.records) all.push_back(&r);
  const bool undoes = root_mean_square(all, &ReplayedRecord::own_plain_rms_N) > kLarger * root_mean_square(all, &ReplayedRecord::own_compensated_rms_N);
  return fmt::format(
      " ({} of {} records): do not build it in, the firmware is better without it. With a gain and a zero of its own for each record {}: {}",
      worse, check.records.size(), from_to(all, &ReplayedRecord::own_plain_rms_N, &ReplayedRecord::own_compensated_rms_N),
      undoes ? "what is larger is how the records differ in them, and that takes a calibration before each"
             : "a calibration before each would not mend it");
}

}  // namespace

bool differs_from_model(const CompensatorCheck& check) {
  constexpr double kFewLSB = 8.0, kOfWhatIsLeft = 0.1;
  return check.largest_N > std::max(kFewLSB * check.lsb_N, kOfWhatIsLeft * check.compensated_rms_N);
}

bool is_off_in_gain(const CompensatorCheck& check) {
  constexpr double kOfTheSpan = 0.05;
  const double raw = check.raw_compensated_rms_N, line = check.compensated_rms_N;
  return check.by_model && raw * raw > 2.0 * line * line + kOfTheSpan * kOfTheSpan * check.span_N * check.span_N;
}

std::vector<std::string> objections(const CompensatorCheck& check) {
  std::vector<std::string> out;
  if (differs_from_model(check))
    out.push_back(fmt::format("the header differs from the model's own inverse by {}: it does not undo this model",
                              check.lsb_N > 0.0 ? fmt::format("{:.2g} LSB", check.largest_N / check.lsb_N) : fmt::format("{:.2g} N", check.largest_N)));
  if (check.compensated_rms_N > kLarger * check.plain_rms_N) {
    const Carried c = carried(check);
    const bool few = !c.by.empty() && 2 * c.by.size() < c.others.size();
    out.push_back(fmt::format("the error on these records is larger with the header than with the law alone: {} -> {} mN{}", plain_number(1e3 * check.plain_rms_N),
                              plain_number(1e3 * check.compensated_rms_N), few ? few_carry_it(c) : most_carry_it(check)));
  }
  if (is_off_in_gain(check))
    out.push_back(fmt::format(
        "gain and offset of the model are not those of these records: {} mN as they are, {} mN with {:.3g} times the force and {:+.3g} N. "
        "A firmware that calibrates by the model "
        "has them: refit the model on records of this sensor (--fit), or calibrate on the bench (--plan)",
        plain_number(1e3 * check.raw_compensated_rms_N), plain_number(1e3 * check.compensated_rms_N), check.line_gain, check.line_zero_N));
  return out;
}

std::string gains_nothing(const CompensatorCheck& check) {
  if (!(check.plain_rms_N > 0.0) || check.compensated_rms_N < check.plain_rms_N || check.compensated_rms_N > kLarger * check.plain_rms_N) return {};
  return fmt::format("the error on these records is not smaller with the header than with the law alone: {} -> {} mN. A firmware is as well off without it "
                     "(it is an objection, and exit code 1, from {:.0f} % more on)",
                     plain_number(1e3 * check.plain_rms_N), plain_number(1e3 * check.compensated_rms_N), 100.0 * (kLarger - 1.0));
}

}  // namespace forcegate
