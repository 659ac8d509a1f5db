#include "hil/app/play/case_recorder.h"

#include <algorithm>
#include <limits>

#include "hil/base/text.h"
#include "hil/gate/case_result.h"

namespace forcegate {

Result<void> CaseRecorder::begin(const CaseJob& job, const CaseRecord& so_far) {
  std::error_code error;
  std::filesystem::create_directories(hdf5_.parent_path(), error);
  JournalHeader header;
  header.name = job.id;
  header.time_bases.push_back({"rig", so_far.rig.rate_Hz});
  header.channels = {{"F_cmd", "N", "force", SampleType::f32, 0},
                     {"F_ref", "N", "force", SampleType::f32, 0},
                     {"U", "V", "voltage", SampleType::f32, 0},
                     {"U", "counts", "voltage", SampleType::u16, 0},
                     {"theta", "rad", "angle", SampleType::f32, 0},
                     {"status", "counts", "status", SampleType::u16, 0},
                     {"F_dut", "N", "force", SampleType::f32, 0},
                     {"flags", "counts", "flags", SampleType::u8, 0},
                     {"w_cmd", "rad/s", "angular velocity", SampleType::f32, 0}};
  header.provenance = {{"rig", so_far.rig.name + "/" + so_far.rig.version},
                       {"firmware_build", so_far.firmware.build_id},
                       {"algorithm", so_far.firmware.algorithm_id},
                       {"image", job.image},
                       {"lane", job.lane},
                       {"loop", std::string(to_string(job.planned.loop))},
                       {"stimulus", stimulus_in_words(job.planned.stimulus)},
                       {"specimen", job.specimen},
                       {"seed", std::to_string(job.seed)},
                       {"calibration", job.calibration.id},
                       {"calibration_level", std::string(to_string(job.calibration.level))},
                       {"gain_N_per_V", shortest(job.calibration.gain_N_per_V)},
                       {"offset_N", shortest(job.calibration.offset_N)},
                       {"b_scale", shortest(job.calibration.b_scale)},
                       {"q_scale", shortest(job.calibration.q_scale)}};
  volts_per_code_ = so_far.rig.v_range_V / static_cast<double>((1u << so_far.rig.adc_bits) - 1u);
  FORCEGATE_TRY(TraceRecorder recorder, TraceRecorder::create(hdf5_, std::move(header)));
  recorder_.emplace(std::move(recorder));
  return {};
}

Result<void> CaseRecorder::push(const RigBlock& block, std::span<const float> dut_N,
                                std::span<const std::uint8_t> flags, const float* commanded_rad_per_s,
                                std::size_t from, std::size_t n) {
  volts_.resize(n);
  for (std::size_t i = 0; i < n; ++i) volts_[i] = static_cast<float>(volts_per_code_ * block.adc[from + i]);
  commanded_.assign(n, std::numeric_limits<float>::quiet_NaN());
  if (commanded_rad_per_s != nullptr) std::copy_n(commanded_rad_per_s + from, n, commanded_.begin());
  const auto part = [from, n](const auto& column) { return ColumnView(std::span(column.data() + from, n)); };
  const ColumnView columns[] = {
      part(block.setpoint_N), part(block.force_ref_N), ColumnView(volts_), part(block.adc),
      part(block.theta_rad),  part(block.status),      part(dut_N),        part(flags),
      ColumnView(commanded_)};
  return recorder_->append({block.t_s.data() + from, n}, columns);
}

Result<void> CaseRecorder::finish() {
  FORCEGATE_TRY(const JournalReport report, recorder_->close());
  (void)report;
  return {};
}

}  // namespace forcegate
