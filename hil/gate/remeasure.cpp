#include "hil/gate/remeasure.h"

#include <algorithm>
#include <cmath>

#include "hil/gate/measurement.h"

namespace forcegate {
namespace {

constexpr std::size_t kBlock = 4090;

Result<const Channel*> column(const Trace& trace, const char* name, bool counts) {
  const Channel* c = trace.find(name);
  if (c == nullptr || (counts ? c->raw.size() : c->value.size()) != trace.size())
    return fail(ErrorCode::parse, std::string("the recording has no whole column ") + name, trace.name);
  return c;
}

template <class To, class From>
void copy_part(const std::vector<From>& from, std::size_t at, std::size_t n, std::vector<To>& to) {
  for (std::size_t i = 0; i < n; ++i) to[i] = static_cast<To>(from[at + i]);
}

}  // namespace

Result<CaseRecord> measure_again(const CaseJob& job, const CaseRecord& stored, const Trace& trace,
                                 Comparator* comparator) {
  FORCEGATE_TRY(const Channel* setpoint, column(trace, "F_cmd", false));
  FORCEGATE_TRY(const Channel* reference, column(trace, "F_ref", false));
  FORCEGATE_TRY(const Channel* code, column(trace, "U", true));
  FORCEGATE_TRY(const Channel* theta, column(trace, "theta", false));
  FORCEGATE_TRY(const Channel* status, column(trace, "status", true));
  FORCEGATE_TRY(const Channel* dut, column(trace, "F_dut", false));
  FORCEGATE_TRY(const Channel* flags, column(trace, "flags", true));
  const Channel* commanded = trace.find("w_cmd");
  FORCEGATE_TRY(const auto stimulus, make_stimulus(job.planned.stimulus));
  CaseRecord record = stored;
  record.samples = trace.size();
  record.pairs.clear();
  record.overview.clear();
  record.window.clear();
  record.window_reason.clear();
  if (comparator != nullptr)
    FORCEGATE_CHECK_OK(
        comparator->begin({stored.firmware.algorithm_id, job.calibration, stored.rig.rate_Hz}));
  RecordMeasurement measurement(job, record, comparator, kBlock);
  measurement.zero_before(
      {stored.observed.zero_start_N, 0.0, std::isfinite(stored.observed.zero_start_N) ? 1u : 0u});
  measurement.zero_after(
      {stored.observed.zero_end_N, 0.0, std::isfinite(stored.observed.zero_end_N) ? 1u : 0u});
  RigBlock block;
  block.resize(kBlock);
  std::vector<float> dut_N(kBlock), told(kBlock);
  std::vector<std::uint8_t> flag(kBlock);
  const std::vector<double>& t_s = trace.time_bases.front().t_s;
  for (std::size_t at = 0; at < trace.size(); at += kBlock) {
    const std::size_t n = std::min(kBlock, trace.size() - at);
    copy_part(t_s, at, n, block.t_s);
    copy_part(setpoint->value, at, n, block.setpoint_N);
    copy_part(reference->value, at, n, block.force_ref_N);
    copy_part(code->raw, at, n, block.adc);
    copy_part(theta->value, at, n, block.theta_rad);
    copy_part(status->raw, at, n, block.status);
    copy_part(dut->value, at, n, dut_N);
    copy_part(flags->raw, at, n, flag);
    if (commanded != nullptr && commanded->value.size() == trace.size())
      copy_part(commanded->value, at, n, told);
    measurement.push(block, {dut_N.data(), n}, {flag.data(), n},
                     stored.rig.can_move && commanded != nullptr ? told.data() : nullptr, n);
  }
  measurement.finish(*stimulus);
  return record;
}

}  // namespace forcegate
