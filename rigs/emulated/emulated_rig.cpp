#include "rigs/emulated/emulated_rig.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/base/portable_math.h"
#include "hil/base/read_number.h"
#include "hil/base/text.h"

namespace forcegate::emulated {
namespace {

constexpr double kForceMax_N = 5.5;
constexpr double kUsualStop_N = 5.0;
constexpr double kHeadroom_N = 0.25;
constexpr double kTick_s = 0.01;
constexpr double kUsualLoss = 0.7;    // share y that 20 min of cycling leave
constexpr double kOnset = 1.0 / 3.0;  // of the record, for faults in mid-run
constexpr double kRippleTurns = 12.0;
constexpr double kStaleStretch_s = 0.1;
constexpr std::size_t kZeroReadings = 1000;
constexpr const char* kAtiCalibration = "FT-EMULATED-1";
constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

Result<void> check_range(const RigRecordRequest& request) {
  if (!(request.duration_s > 0.0 && request.duration_s < 1e7))
    return fail(ErrorCode::config, "a record of " + shortest(request.duration_s) + " s cannot be made");
  if (!(request.force_low_N >= 0.0 && request.force_low_N <= request.force_high_N &&
        request.force_high_N <= kForceMax_N))
    return fail(ErrorCode::config,
                "the emulated rig cannot apply " + shortest(request.force_low_N) + " to " +
                    shortest(request.force_high_N) + " N",
                {}, "its range is 0 to 5.5 N");
  return {};
}

}  // namespace

EmulatedRig::EmulatedRig(const EmulatedOptions& options, std::unique_ptr<SensorHook> hidden)
    : options_(options),
      step_s_(1.0 / options.rate_Hz),
      samples_per_tick_(static_cast<std::int64_t>(options.rate_Hz * kTick_s + 0.5)),
      hidden_(std::move(hidden)) {
  geometry_.spring_N_per_mm = spring_.stiffness_N_per_mm;
  geometry_.eccentricity_mm = wheel_.eccentricity_mm();
  geometry_.velocity_max_rad_per_s = VelocityMotor::Parameters{}.velocity_max_rad_per_s;
}

RigInfo EmulatedRig::info() const {
  RigInfo info;
  info.name = "emulated";
  info.id = options_.sensor == SensorType::fsr ? "emulated-fsr" : "emulated-flexiforce";
  info.version = std::string("1");
  info.rate_Hz = options_.rate_Hz;
  info.adc_bits = options_.adc_bits;
  info.v_range_V = 10.0;
  info.force_max_N = kForceMax_N;
  info.reference_resolution_N = AtiNano17::Parameters{}.resolution_N;
  info.reference_noise_N = AtiNano17::Parameters{}.noise_N;
  info.reference_u_rel = 0.005;
  info.geometry = geometry_;
  info.can_move = true;
  info.emulated = true;
  info.details["reference_calibration"] =
      faults_.reference_foreign_calibration ? "FT-EMULATED-2" : kAtiCalibration;
  info.details["reference_calibration_expected"] = kAtiCalibration;
  info.details["sensor"] =
      options_.sensor == SensorType::fsr ? "Interlink FSR (emulated)" : "Tekscan FlexiForce A201 (emulated)";
  info.details["nominal_gain_N_per_V"] = shortest(kNominalGain_N_per_V);
  info.details["nominal_offset_N"] = shortest(kNominalOffset_N);
  return info;
}

std::map<std::string, std::string> EmulatedRig::settings() const {
  const auto on_off = [](bool on) { return std::string(on ? "on" : "off"); };
  return {{"adc_bits", std::to_string(options_.adc_bits)}, {"hidden", sealed_sensor_hook(options_.hidden)},
          {"noise", on_off(options_.noise)}, {"rate_Hz", shortest(options_.rate_Hz)},
          {"sensor", options_.sensor == SensorType::fsr ? "fsr" : "flexiforce"}, {"session_spread", on_off(options_.session_spread)}};
}

Result<void> EmulatedRig::begin(const RigRecordRequest& request) {
  begun_ = false;
  FORCEGATE_TRY(const Specimen specimen, find_specimen(request.specimen));
  FORCEGATE_TRY(faults_, parse_faults(request.faults));
  FORCEGATE_CHECK_OK(check_range(request));
  record_seed_ = mix_seed(mix_seed(request.seed, "record/" + request.specimen),
                          std::to_string(request.session) + "/" + std::to_string(request.record));
  const double force_N = mount(request);
  begin_instruments(force_N);
  begin_sensor(specimen, request, force_N);
  begin_faults(force_N);
  index_ = 0;
  take_zero();
  end_ =
      static_cast<std::int64_t>(std::min(request.duration_s, faults_.truncated_s) * options_.rate_Hz + 0.5);
  reading_N_ = force_N;
  begun_ = true;
  return {};
}

// Sets the wheel so that the profile stays off its stops; returns the force at which the record begins.
double EmulatedRig::mount(const RigRecordRequest& request) {
  const double stop_N = std::min(kForceMax_N, std::max(kUsualStop_N, request.force_high_N + kHeadroom_N));
  wheel_.set_eccentricity_mm(0.5 * stop_N / spring_.stiffness_N_per_mm);
  geometry_.eccentricity_mm = wheel_.eccentricity_mm();
  geometry_.preload_mm = spring_.preload_mm;

  const double theta = wheel_.angle_rad(request.force_low_N / spring_.stiffness_N_per_mm);
  motor_.begin({}, step_s_, theta);
  mounted_ = spring_;
  mounted_.stiffness_N_per_mm *= faults_.spring_stiffness;
  mounted_.preload_mm += faults_.preload_wrong_mm;
  head_.begin(record_seed_, request.duration_s, faults_.head_motion);
  onset_s_ = kOnset * request.duration_s;
  wheel_rad_ = shaft_rad(theta);
  return mounted_.force_N(wheel_.travel_mm(wheel_rad_));
}

void EmulatedRig::begin_instruments(double force_N) {
  AtiNano17::Parameters ati;
  Converter::Parameters converter;
  converter.bits = options_.adc_bits;
  if (!options_.noise) ati.noise_N = converter.noise_V = 0.0;
  ati.overload_N = std::min(ati.overload_N, faults_.reference_saturated_N);
  ati_.begin(ati, step_s_, force_N);
  ati_.set_gain(faults_.reference_gain * faults_.reference_axis_share);
  converter_.begin(converter);
  ati_noise_ = WhiteNoise(record_seed_, "ati_noise");
  adc_noise_ = WhiteNoise(record_seed_, "adc_noise");
}

void EmulatedRig::begin_sensor(const Specimen& specimen, const RigRecordRequest& request, double force_N) {
  film_parameters_ = draw_session(options_.sensor, specimen, request.seed, request.session,
                                  options_.session_spread, request.record);
  film_parameters_.gain_N_per_V /= faults_.sensor_gain;
  film_.begin(film_parameters_, step_s_, force_N, kUsualLoss, request.rest_before_s, record_seed_);
  if (hidden_) hidden_->begin(step_s_, force_N);
}

void EmulatedRig::begin_faults(double force_N) {
  loss_ = Rng(record_seed_, "sample_loss");
  stale_ = Rng(record_seed_, "stale");
  sensor_stale_ = reference_stale_ = {};
  stale_code_ = last_code_ = 0;
  stale_reading_N_ = frozen_N_ = 0.0F;
  is_frozen_ = false;
  late_code_.assign(static_cast<std::size_t>(faults_.sensor_late_s * options_.rate_Hz), 0);
  late_reading_N_.assign(static_cast<std::size_t>(faults_.reference_late_s * options_.rate_Hz),
                         static_cast<float>(force_N));
}

Result<void> EmulatedRig::command_velocity(double rad_per_s) {
  if (!begun_) return fail(ErrorCode::internal, "the emulated rig got a command before a record began");
  if (!std::isfinite(rad_per_s))
    return fail(ErrorCode::device, "the motor refuses a velocity that is no number");
  motor_.command(rad_per_s);
  return {};
}

Result<std::size_t> EmulatedRig::run(std::size_t n, RigBlock& out, std::size_t at) {
  if (!begun_) return fail(ErrorCode::internal, "the emulated rig was run before a record began");
  const auto left = static_cast<std::size_t>(std::max<std::int64_t>(0, end_ - index_));
  n = std::min(n, left);
  for (std::size_t done = 0; done < n;) {
    const auto to_tick = static_cast<std::size_t>(samples_per_tick_ - index_ % samples_per_tick_);
    const std::size_t chunk = std::min({n - done, to_tick, kChunk});
    run_to_tick(chunk, out, at + done);
    if (index_ % samples_per_tick_ == 0) {
      film_.tick(kTick_s);
      if (hidden_) hidden_->tick(kTick_s);
    }
    done += chunk;
  }
  if (faults_.touches_rows()) spoil_rows(n, out, at);
  return n;
}

// One instrument after the other over at most kChunk samples: short loops that overlap in the processor.
void EmulatedRig::run_to_tick(std::size_t n, RigBlock& out, std::size_t at) {
  if (static_cast<double>(index_) * step_s_ >= faults_.motor_stalled_s) motor_.stall();
  double* const force = force_N_.data();
  double* const voltage = voltage_V_.data();
  float* const theta_rad = out.theta_rad.data() + at;
  std::uint16_t* const status = out.status.data() + at;
  double* const t_s = out.t_s.data() + at;
  const std::uint16_t fault = motor_.following_error() ? kRigMotorFault : 0;
  // Instruments step as locals: members would go through memory at every sample.
  VelocityMotor motor = motor_;
  for (std::size_t i = 0; i < n; ++i) {
    force[i] = motor.step();
    status[i] = motor.at_stop() ? static_cast<std::uint16_t>(fault | kRigTravelStop) : fault;
  }
  motor_ = motor;
  if (faults_.motor_ripple_rad != 0.0)
    for (std::size_t i = 0; i < n; ++i) force[i] = shaft_rad(force[i]);
  for (std::size_t i = 0; i < n; ++i) theta_rad[i] = static_cast<float>(force[i]);
  if (faults_.motor_backlash_rad > 0.0) {
    const double half = 0.5 * faults_.motor_backlash_rad;
    for (std::size_t i = 0; i < n; ++i)
      force[i] = wheel_rad_ = std::clamp(wheel_rad_, force[i] - half, force[i] + half);
  }
  const double now_s = static_cast<double>(index_) * step_s_;
  if (now_s >= onset_s_)
    mounted_.preload_mm = spring_.preload_mm + faults_.preload_wrong_mm - faults_.spring_slipped_mm;
  if (faults_.head_motion > 0.0)
    for (std::size_t i = 0; i < n; ++i)
      force[i] = mounted_.force_N(
          wheel_.travel_mm(force[i]) +
          head_.displacement_mm(static_cast<double>(index_ + static_cast<std::int64_t>(i)) * step_s_));
  else
    press(n, force);
  ati_.set_offset_N(faults_.reference_offset_N + faults_.reference_drift_N_per_min * now_s / 60.0);
  if (hidden_) hidden_->feel(n, force, film_N_.data());
  film_.run(n, hidden_ ? film_N_.data() : force, voltage);
  float* const reading = out.force_ref_N.data() + at;
  AtiNano17 ati = ati_;
  WhiteNoise ati_noise = ati_noise_;
  for (std::size_t i = 0; i < n; ++i) {
    reading[i] = static_cast<float>(ati.read(force[i], ati_noise.next()));
    if (ati.saturated()) status[i] |= kRigReferenceSaturated;
  }
  ati_ = ati;
  ati_noise_ = ati_noise;
  std::uint16_t* const adc = out.adc.data() + at;
  const Converter converter = converter_;
  const int last_code = converter.last_code();
  WhiteNoise adc_noise = adc_noise_;
  for (std::size_t i = 0; i < n; ++i) {
    const std::uint16_t code = converter.convert(voltage[i], adc_noise.next());
    adc[i] = code;
    if (code == 0 || code == last_code) status[i] |= kRigAdcRail;
  }
  adc_noise_ = adc_noise;
  const double step_s = step_s_;
  for (std::size_t i = 0; i < n; ++i)
    t_s[i] = static_cast<double>(index_ + static_cast<std::int64_t>(i)) * step_s;
  index_ += static_cast<std::int64_t>(n);
  reading_N_ = static_cast<double>(reading[n - 1]);
}

// Angle of the wheel to force of the spring.
void EmulatedRig::press(std::size_t n, double* angle_to_force) const {
  const EccentricWheel wheel = wheel_;
  const Spring spring = mounted_;
  for (std::size_t i = 0; i < n; ++i) angle_to_force[i] = spring.force_N(wheel.travel_mm(angle_to_force[i]));
}

double EmulatedRig::shaft_rad(double theta_rad) const {
  if (faults_.motor_ripple_rad == 0.0) return theta_rad;
  return theta_rad + faults_.motor_ripple_rad * portable::sin(kRippleTurns * theta_rad);
}

// The trolley is drawn back and the cell is read for a second.
void EmulatedRig::take_zero() {
  AtiNano17::Parameters ati;
  if (!options_.noise) ati.noise_N = 0.0;
  ati.overload_N = std::min(ati.overload_N, faults_.reference_saturated_N);
  AtiNano17 cell;
  cell.begin(ati, step_s_, 0.0);
  const double t_s = static_cast<double>(index_) * step_s_;
  cell.set_offset_N(faults_.reference_offset_N + faults_.reference_drift_N_per_min * t_s / 60.0);
  WhiteNoise noise(record_seed_, index_ == 0 ? "ati_zero_before" : "ati_zero_after");
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < kZeroReadings; ++i) {
    double reading = cell.read(0.0, noise.next());
    if (t_s >= faults_.reference_frozen_s) reading = static_cast<double>(frozen_N_);
    sum += reading;
    squares += reading * reading;
  }
  const double n = static_cast<double>(kZeroReadings);
  zero_ = {sum / n, std::sqrt(std::max(0.0, squares / n - sum * sum / (n * n))), kZeroReadings};
}

bool EmulatedRig::is_stale(Stale& stale, double share, std::int64_t index) {
  const std::int64_t stretch = index / static_cast<std::int64_t>(kStaleStretch_s * options_.rate_Hz);
  if (stretch != stale.stretch) stale = {stretch, stale_.uniform() < share};
  return stale.now;
}

void EmulatedRig::spoil_rows(std::size_t n, RigBlock& out, std::size_t at) {
  const std::int64_t first = index_ - static_cast<std::int64_t>(n);
  for (std::size_t i = at; i < at + n; ++i) {
    const std::int64_t index = first + static_cast<std::int64_t>(i - at);
    const double t_s = out.t_s[i];
    if (t_s >= faults_.sensor_unplugged_s) {
      out.adc[i] = 0;
      out.status[i] |= kRigAdcRail;
    }
    if (faults_.adc_stuck_bit >= 0) {
      const int bit = 1 << faults_.adc_stuck_bit;
      out.adc[i] = static_cast<std::uint16_t>((out.adc[i] | bit) & converter_.last_code());
    }
    if (!late_code_.empty()) {
      std::uint16_t& slot = late_code_[static_cast<std::size_t>(index) % late_code_.size()];
      if (index < static_cast<std::int64_t>(late_code_.size()))
        slot = out.adc[i];  // nothing is under way yet
      std::swap(slot, out.adc[i]);
    }
    if (faults_.sensor_stale > 0.0) {
      if (is_stale(sensor_stale_, faults_.sensor_stale, index))
        out.adc[i] = stale_code_;
      else
        stale_code_ = out.adc[i];
    }
    if (t_s >= faults_.reference_frozen_s) {
      if (!is_frozen_) frozen_N_ = out.force_ref_N[i];
      is_frozen_ = true;
      out.force_ref_N[i] = frozen_N_;
    }
    if (!late_reading_N_.empty())
      std::swap(late_reading_N_[static_cast<std::size_t>(index) % late_reading_N_.size()],
                out.force_ref_N[i]);
    if (faults_.reference_stale > 0.0) {
      if (is_stale(reference_stale_, faults_.reference_stale, index))
        out.force_ref_N[i] = stale_reading_N_;
      else
        stale_reading_N_ = out.force_ref_N[i];
    }
    reading_N_ = static_cast<double>(out.force_ref_N[i]);
    if (faults_.sample_loss > 0.0 && loss_.uniform() < faults_.sample_loss) {
      out.force_ref_N[i] = out.theta_rad[i] = kNaN;
      out.adc[i] = last_code_;
      out.status[i] |= kRigSampleLost;
    } else {
      last_code_ = out.adc[i];
    }
    out.t_s[i] = t_s * (1.0 + faults_.clock_skew) + (t_s >= onset_s_ ? faults_.clock_jump_s : 0.0);
  }
}

void EmulatedRig::park() noexcept {
  motor_.command(0.0);
  if (begun_ && index_ > 0) take_zero();
  begun_ = false;
}

namespace {

Result<double> number_option(const std::string& name, const std::string& text, double low, double high) {
  const std::optional<double> value = read_number(text);
  if (!value || *value < low || *value > high)
    return fail(ErrorCode::config, "rig option " + name + " = '" + printable_utf8(text) + "' is no number that the rig can have", "rig emulated",
                "it is from " + shortest(low) + " to " + shortest(high));
  return *value;
}

Result<bool> switch_option(const std::string& name, const std::string& text) {
  if (text == "on" || text == "true" || text == "1") return true;
  if (text == "off" || text == "false" || text == "0") return false;
  return fail(ErrorCode::config, "rig option " + name + " = '" + printable_utf8(text) + "' is neither on nor off", "rig emulated", "write " + name + "=on or " + name + "=off");
}

Result<std::unique_ptr<Rig>> make_emulated(const std::map<std::string, std::string>& texts) {
  static const std::vector<std::string> kKnown{"adc_bits", "hidden", "noise",
                                               "rate_Hz",  "sensor", "session_spread"};
  EmulatedOptions options;
  std::unique_ptr<SensorHook> hidden;
  for (const auto& [name, text] : texts) {
    if (name == "sensor") {
      if (text != "flexiforce" && text != "fsr")
        return fail(ErrorCode::config, "the emulated rig has no sensor '" + printable_utf8(text) + "'", "rig emulated",
                    "use flexiforce or fsr");
      options.sensor = text == "fsr" ? SensorType::fsr : SensorType::flexiforce;
    } else if (name == "hidden") {
      FORCEGATE_TRY(const std::string plain, unsealed_sensor_hook(text));
      FORCEGATE_TRY(hidden, make_sensor_hook(plain));
      FORCEGATE_TRY(options.hidden, resolved_sensor_hook(plain));
    } else if (name == "adc_bits") {
      FORCEGATE_TRY(const double bits, number_option(name, text, 8, 16));
      if (bits != std::floor(bits)) return fail(ErrorCode::config, "rig option adc_bits = " + shortest(bits) + " is no whole number", "rig emulated", "write 8 to 16");
      options.adc_bits = static_cast<int>(bits);
    } else if (name == "rate_Hz") {
      FORCEGATE_TRY(options.rate_Hz, number_option(name, text, 100, 10000));
      if (std::fmod(options.rate_Hz, 100.0) != 0.0)
        return fail(ErrorCode::config, "rig option rate_Hz must be a multiple of 100", "rig emulated", "for example rate_Hz=1000");
    } else if (name == "session_spread") {
      FORCEGATE_TRY(options.session_spread, switch_option(name, text));
    } else if (name == "noise") {
      FORCEGATE_TRY(options.noise, switch_option(name, text));
    } else {
      const std::string near = nearest_name(name, kKnown);
      return fail(ErrorCode::config, "the emulated rig has no option '" + printable_utf8(name) + "'", "rig emulated",
                  near.empty() ? "it has: " + join(kKnown, ", ") : "did you mean '" + near + "'?");
    }
  }
  return std::unique_ptr<Rig>(std::make_unique<EmulatedRig>(options, std::move(hidden)));
}

const Registration<RigKind> kRegistered{
    {"emulated",
     "The bench of Lebosse 2011 in virtual time. Options: sensor=flexiforce|fsr, adc_bits=8..16, rate_Hz, "
     "session_spread=on|off, noise=on|off, hidden=hysteresis|creep[:weak|medium|strong|SHARE]",
     make_emulated}};

}  // namespace
}  // namespace forcegate::emulated
