#pragma once
// One specimen on one rig for one session: plays profiles one after the other, each after its rest, and shows every
// block to a sink. Knows rigs only through hil/interface, so the emulated bench and a real one are the same to it.

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>

#include "hil/base/result.h"
#include "hil/interface/rig.h"
#include "hil/interface/stimulus.h"
#include "hil/rig/safety_gate.h"

namespace forcegate::characterize {

/// Force from one converter code, N; called for every sample in order.
using Estimator = std::function<double(std::uint16_t code)>;

/// rows [0, n) of the block; estimate_N is empty in open loop.
using BlockSink =
    std::function<void(const RigBlock& block, std::size_t n, std::span<const float> estimate_N)>;

/// What several sessions on several threads report to.
struct BenchProgress {
  std::atomic<std::uint64_t> samples{0};
  const std::atomic<bool>* cancelled = nullptr;
  bool is_cancelled() const { return cancelled != nullptr && cancelled->load(std::memory_order_relaxed); }
};

struct PlayedRecord {
  std::uint64_t samples = 0;
  SafetyReport safety;
  RigInfo rig;
};

/// How the loop is closed. Without an estimator it is open.
struct Closed {
  Estimator estimator;
  std::string controller = "force_integral";
  std::map<std::string, double> faults;  ///< RigRecordRequest::faults
};

class Bench {
 public:
  struct Setup {
    std::string specimen = "nominal";
    std::uint64_t seed = 1, session = 0;
    double rest_s = 7200.0;  ///< of the specimen before each record
    SafetyLimits safety{.force_max_N = 5.4};
  };
  Bench(Rig& rig, Setup setup, BenchProgress& progress)
      : rig_(rig), setup_(std::move(setup)), progress_(progress) {}

  /// Without an estimator in open loop, with one in force control (hil/rig/control_period.h). Errors: those of the
  /// rig; a rig that fails its self-check (open loop only: a closed loop may drive the wheel to its stop); a
  /// record stopped by the safety gate or cut short in open loop; cancelled.
  Result<PlayedRecord> play(const Stimulus& stimulus, const BlockSink& sink, const Closed& closed = {});

  /// Same with a profile by name.
  Result<PlayedRecord> play(const StimulusSpec& spec, const BlockSink& sink, const Closed& closed = {});

  RigInfo info() const { return rig_.info(); }
  const Setup& setup() const { return setup_; }
  std::uint64_t samples() const { return samples_; }
  double volts_per_code() const;

 private:
  Rig& rig_;
  Setup setup_;
  BenchProgress& progress_;
  std::uint64_t record_ = 0, samples_ = 0;
};

/// StimulusSpec of the profiles that the procedures use most.
StimulusSpec sine(double f_Hz, double A_N, double m_N, double duration_s);
StimulusSpec rest(double level_N, double duration_s);
StimulusSpec sum_of_sines(std::vector<double> f_Hz, std::vector<double> A_N, double m_N, double duration_s);

}  // namespace forcegate::characterize
