#pragma once
// Keeps the samples of a record: journal while it runs, HDF5 at the end (hil/trace/trace_recorder.h).

#include <filesystem>
#include <optional>
#include <vector>

#include "hil/gate/runner.h"
#include "hil/trace/trace_recorder.h"

namespace forcegate {

class CaseRecorder final : public RecordWriter {
 public:
  explicit CaseRecorder(std::filesystem::path hdf5) : hdf5_(std::move(hdf5)) {}

  Result<void> begin(const CaseJob& job, const CaseRecord& so_far) override;
  Result<void> push(const RigBlock& block, std::span<const float> dut_N, std::span<const std::uint8_t> flags,
                    const float* commanded_rad_per_s, std::size_t from, std::size_t n) override;
  Result<void> finish() override;

 private:
  std::filesystem::path hdf5_;
  std::optional<TraceRecorder> recorder_;
  double volts_per_code_ = 0.0;
  std::vector<float> volts_, commanded_;
};

}  // namespace forcegate
