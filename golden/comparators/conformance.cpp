// Comparator "conformance": |F_dut - F_oracle| in units of the converter's step G v_range / (2^bits - 1),
// worst sample of the record. Limit half an LSB, what rounding to the converter's step would cost: single
// precision costs 0.04 LSB at 16 bits in the worst profile tried (2^-24 of 10 N is 6e-7 N, a few operations
// deep, against 7.6e-5 N), while full scale taken as 2^bits instead of 2^bits - 1 costs 0.7 LSB and more. The state flags are decisions and must be equal: where the forces
// are, the samples whose flags differ are the value, and none may.

#include <fmt/format.h>

#include <cmath>
#include <optional>

#include "golden/compare/lebosse_oracle.h"
#include "hil/base/text.h"
#include "hil/interface/comparator.h"
#include "hil/interface/dut.h"

namespace forcegate {
namespace {

constexpr double kLimit_LSB = 0.5;
constexpr std::uint8_t kDecisions = kDutExcited | kDutLearning | kDutHeld | kDutInputRail;

class Conformance final : public Comparator {
 public:
  Result<void> begin(const ComparatorSession& session) override {
    if (session.algorithm_id != LebosseOracle::kAlgorithm)
      return fail(ErrorCode::config,
                  "there is no oracle for the algorithm '" + printable_utf8(session.algorithm_id) + "'");
    if (session.rate_Hz != 1000.0)
      return fail(ErrorCode::config,
                  "the algorithm lebosse-eq7/1 is defined at 1000 Hz, not at " + shortest(session.rate_Hz));
    oracle_.emplace(session.calibration);
    n_ = worst_at_ = flags_differ_ = first_flag_ = 0;
    worst_ = 0.0;
    return {};
  }

  void push(std::span<const std::uint16_t> adc, std::span<const float> force_N,
            std::span<const std::uint8_t> flags) override {
    const double per_lsb = 1.0 / oracle_->lsb_N();
    const double full_scale = static_cast<double>(oracle_->code_max());
    for (std::size_t i = 0; i < adc.size(); ++i, ++n_) {
      const LebosseOracle::Output expected = oracle_->step(adc[i]);
      double error = std::abs(static_cast<double>(force_N[i]) - expected.force_N) * per_lsb;
      if (((flags[i] ^ expected.flags) & kDecisions) != 0) {
        if (flags_differ_++ == 0) first_flag_ = n_, said_ = flags[i] & kDecisions, expected_ = expected.flags & kDecisions;
      }
      if (error <= worst_) continue;
      if (!(error <= full_scale)) error = full_scale;  // NaN and infinity too
      if (error > worst_) {
        worst_ = error;
        worst_at_ = n_;
      }
    }
  }

  Comparison finish() override {
    Comparison c;
    c.limit = kLimit_LSB;
    c.limit_source =
        "half a step of the converter, ten times what single precision costs (docs/algorithm.md)";
    c.n = n_;
    if (n_ == 0) {
      c.value = std::nan("");
      c.evidence = "no sample was compared";
      return c;
    }
    c.value = worst_;
    c.worst_at_s = static_cast<double>(worst_at_) / 1000.0;
    c.evidence = "largest difference at " + shortest(c.worst_at_s) + " s";
    if (flags_differ_ == 0) return c;
    const std::string flags = fmt::format("state flags differ in {} samples, first at sample {} ({} s): 0x{:02x} instead of 0x{:02x}", flags_differ_, first_flag_,
                                          shortest(static_cast<double>(first_flag_) / 1000.0), said_, expected_);
    if (worst_ > kLimit_LSB) {
      c.evidence += "; " + flags;
      return c;
    }
    c.evidence = fmt::format("{}; the forces differ by {:.2g} LSB at most", flags, worst_);
    c.value = static_cast<double>(flags_differ_);
    c.unit = "samples";
    c.limit = 0.0;
    c.limit_source = "state flags are decisions and must be equal (docs/algorithm.md)";
    c.worst_at_s = static_cast<double>(first_flag_) / 1000.0;
    return c;
  }

 private:
  std::optional<LebosseOracle> oracle_;
  std::uint64_t n_ = 0, worst_at_ = 0, flags_differ_ = 0, first_flag_ = 0;
  unsigned said_ = 0, expected_ = 0;  ///< flags at the first sample that differs
  double worst_ = 0.0;
};

const Registration<ComparatorKind> kRegistered{{
    "conformance",
    "The firmware's force against an independent double-precision implementation of the algorithm it "
    "declares.",
    [](std::string_view algorithm_id) { return algorithm_id == LebosseOracle::kAlgorithm; },
    [] { return std::unique_ptr<Comparator>(std::make_unique<Conformance>()); },
    {LebosseOracle::kAlgorithm},
}};

}  // namespace
}  // namespace forcegate
