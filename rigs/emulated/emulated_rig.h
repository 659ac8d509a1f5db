#pragma once
// The bench of Lebosse 2011 (II-B) in virtual time: motor -> eccentric wheel -> trolley and spring -> film
// and reference cell -> converter, one row per sample. Every random number comes from the record's seed; two
// records of one request have the same bits on any machine and in any thread.
//
// Geometry: the wheel reaches 5 N at the end of its half turn (more when the profile needs more, at most
// 5.5 N), no preload. A record starts at rest with the wheel at the angle of force_low_N.
// The column setpoint_N belongs to whoever commands the wheel: run() leaves it as it is.

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "hil/base/rng.h"
#include "hil/interface/rig.h"
#include "rigs/emulated/ati_nano17.h"
#include "rigs/emulated/converter.h"
#include "rigs/emulated/faults.h"
#include "rigs/emulated/film.h"
#include "rigs/emulated/head.h"
#include "rigs/emulated/motor.h"
#include "rigs/emulated/population.h"
#include "rigs/emulated/sensor_hook.h"
#include "rigs/emulated/spring.h"
#include "rigs/emulated/wheel.h"
#include "rigs/emulated/white_noise.h"

namespace forcegate::emulated {

struct EmulatedOptions {
  SensorType sensor = SensorType::flexiforce;
  int adc_bits = 16;
  double rate_Hz = 1000.0;     ///< a multiple of 100
  bool session_spread = true;  ///< false: nominal G and F0
  bool noise = true;
  std::string hidden = "none";  ///< what the sensor hides, as resolved_sensor_hook() says it; for settings() alone
};

class EmulatedRig final : public Rig {
 public:
  /// `hidden`: what the film of this rig has and the starting model lacks; null: nothing.
  explicit EmulatedRig(const EmulatedOptions& options, std::unique_ptr<SensorHook> hidden = nullptr);

  RigInfo info() const override;
  std::map<std::string, std::string> settings() const override;
  Result<void> begin(const RigRecordRequest& request) override;
  Result<void> command_velocity(double rad_per_s) override;
  Result<std::size_t> run(std::size_t n, RigBlock& out, std::size_t at) override;
  double theta_rad() const override { return shaft_rad(motor_.theta_rad()); }
  double force_ref_N() const override { return reading_N_; }
  ReferenceZero reference_zero() const override { return zero_; }
  void park() noexcept override;

  /// The truth, for tests and studies of the rig itself; the gate never sees it.
  const Film& film() const { return film_; }

 private:
  double mount(const RigRecordRequest& request);
  void begin_instruments(double force_N);
  void begin_sensor(const Specimen& specimen, const RigRecordRequest& request, double force_N);
  void begin_faults(double force_N);
  void run_to_tick(std::size_t n, RigBlock& out, std::size_t at);
  void spoil_rows(std::size_t n, RigBlock& out, std::size_t at);
  double shaft_rad(double theta_rad) const;
  void press(std::size_t n, double* angle_to_force) const;
  void take_zero();

  EmulatedOptions options_;
  double step_s_;
  std::int64_t samples_per_tick_;
  bool begun_ = false;
  Faults faults_;
  std::int64_t index_ = 0, end_ = 0;
  double reading_N_ = 0.0;
  float frozen_N_ = 0.0F;
  std::uint16_t last_code_ = 0;
  bool is_frozen_ = false;
  RigGeometry geometry_;
  VelocityMotor motor_;
  EccentricWheel wheel_;
  Spring spring_;   ///< as the geometry says
  Spring mounted_;  ///< as it is
  HeadMotion head_;
  AtiNano17 ati_;
  Converter converter_;
  Film film_;
  FilmParameters film_parameters_;
  WhiteNoise ati_noise_{0, ""}, adc_noise_{0, ""};
  Rng loss_{0}, stale_{0};
  double onset_s_ = 0.0, wheel_rad_ = 0.0;
  ReferenceZero zero_;
  std::uint64_t record_seed_ = 0;
  std::vector<std::uint16_t> late_code_;  ///< ring of the codes under way
  std::vector<float> late_reading_N_;
  struct Stale {
    std::int64_t stretch = -1;
    bool now = false;
  };
  /// Whether the 100-ms stretch that holds the sample is one in which a reading repeats.
  bool is_stale(Stale& stale, double share, std::int64_t index);
  Stale sensor_stale_, reference_stale_;
  std::uint16_t stale_code_ = 0;
  float stale_reading_N_ = 0.0F;
  static constexpr std::size_t kChunk = 100;
  std::array<double, kChunk> force_N_{}, film_N_{}, voltage_V_{};
  std::unique_ptr<SensorHook> hidden_;
};

}  // namespace forcegate::emulated
