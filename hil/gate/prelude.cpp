#include "hil/gate/prelude.h"

#include <algorithm>
#include <cmath>

#include "hil/base/portable_math.h"
#include "hil/base/rng.h"

namespace forcegate {
namespace {

constexpr std::size_t kBlock = 4090;
constexpr double kTwoPi = 6.283185307179586;

Calibration other_calibration(const Calibration& own) {
  Calibration c = own;
  c.gain_N_per_V = own.gain_N_per_V > 0.6 ? 0.3 : 1.3;
  c.offset_N = own.offset_N > 0.0 ? -0.4 : 0.4;
  c.b_scale = own.b_scale > 1.2 ? 0.5 : 2.0;
  c.q_scale = own.q_scale > 0.8 ? 0.4 : 1.6;
  c.id = "prelude";
  return c;
}

}  // namespace

std::vector<std::uint16_t> hostile_codes(std::size_t n, int bits, double rate_Hz) {
  const double full = static_cast<double>((1u << bits) - 1u);
  std::vector<std::uint16_t> codes(n);
  Rng rng(1, "prelude");
  for (std::size_t i = 0; i < n; ++i) {
    const double t_s = static_cast<double>(i) / rate_Hz,
                 share = static_cast<double>(i) / static_cast<double>(n);
    double level = 0.0;
    if (share < 0.05)
      level = 0.0;  // no load at all
    else if (share < 0.75)
      level = 0.5 - 0.6 * portable::cos(kTwoPi * 0.5 * t_s);  // cycles from rail to rail
    else if (share < 0.80)
      level = 1.0;  // stands at the upper rail
    else if (share < 0.90)
      level = (i / 700) % 2 == 0 ? 0.02 : 0.97;  // jumps
    else if (share < 0.95)
      level = rng.uniform();
    else
      level = 0.3;
    codes[i] = static_cast<std::uint16_t>(std::lround(std::clamp(level, 0.0, 1.0) * full));
  }
  return codes;
}

Result<DutInfo> play_prelude(Dut& dut, Comparator* comparator, const DutSession& session, double seconds,
                             PreludeFacts& facts) {
  DutSession before = session;
  before.nonce = ~session.nonce;
  before.calibration = other_calibration(session.calibration);
  FORCEGATE_TRY(const DutInfo first, dut.open(before));
  const auto n = static_cast<std::size_t>(std::llround(seconds * session.rate_Hz));
  const std::vector<std::uint16_t> codes = hostile_codes(n, before.calibration.adc_bits, session.rate_Hz);
  std::vector<float> force_N(kBlock);
  std::vector<std::uint8_t> flags(kBlock);
  if (comparator != nullptr)
    FORCEGATE_CHECK_OK(comparator->begin({first.algorithm_id, before.calibration, session.rate_Hz}));
  for (std::size_t at = 0; at < n; at += kBlock) {
    const std::size_t m = std::min(kBlock, n - at);
    const std::span<const std::uint16_t> adc(codes.data() + at, m);
    FORCEGATE_CHECK_OK(
        dut.process(static_cast<std::uint32_t>(at), adc, {force_N.data(), m}, {flags.data(), m}));
    for (std::size_t i = 0; i < m; ++i) {
      if (std::isfinite(force_N[i]))
        facts.largest_N = std::max(facts.largest_N, std::fabs(static_cast<double>(force_N[i])));
      else
        ++facts.not_finite;
    }
    if (comparator != nullptr) comparator->push(adc, {force_N.data(), m}, {flags.data(), m});
  }
  facts.samples = n;
  if (comparator != nullptr) {
    const Comparison c = comparator->finish();
    facts.conformance_known = !std::isnan(c.value);
    facts.conformance = c.value;
    facts.conformance_limit = c.limit;
    facts.conformance_unit = c.unit;
    facts.conformance_source = c.limit_source;
    facts.conformance_evidence = c.evidence;
  }
  return dut.restart(session);
}

}  // namespace forcegate
