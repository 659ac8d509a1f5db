#include "hil/gate/calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <memory>
#include <vector>

#include "hil/base/text.h"
#include "hil/gate/blame.h"
#include "hil/gate/board_faults.h"
#include "hil/gate/case_result.h"
#include "hil/gate/play_profile.h"
#include "hil/gate/runner.h"
#include "hil/gate/statistics.h"
#include "hil/rig/config.h"
#include "hil/rig/self_check.h"
#include "hil/trace/decay_fit.h"
#include "hil/trace/extrema.h"
#include "hil/trace/static_line.h"

namespace forcegate {
namespace {

constexpr double kMeanOver_s = 0.05;
constexpr double kSureOfRate = 0.5;  // standard uncertainty of b over b: what is less sure tells no decay

// Triangle between two forces, one sweep up and down in sweep_s: quasi-static, so that the film is not
// worked.
class CalibrationSweep final : public Stimulus {
 public:
  explicit CalibrationSweep(const PlanCalibration& c) : c_(c) {}
  double force_N(double t_s) const override {
    const double phase = t_s / c_.sweep_s - std::floor(t_s / c_.sweep_s);
    const double up = phase < 0.5 ? 2.0 * phase : 2.0 - 2.0 * phase;
    return c_.sweep_low_N + (c_.sweep_high_N - c_.sweep_low_N) * up;
  }
  double duration_s() const override { return c_.sweep_s * c_.sweeps; }
  StimulusFacts facts() const override {
    StimulusFacts f;
    f.mean_N = 0.5 * (c_.sweep_low_N + c_.sweep_high_N);
    f.amplitude_N = 0.5 * (c_.sweep_high_N - c_.sweep_low_N);
    f.minimum_N = c_.sweep_low_N;
    f.maximum_N = c_.sweep_high_N;
    return f;
  }

 private:
  const PlanCalibration& c_;
};

class CalibrationRun {
 public:
  CalibrationRun(const CaseJob& job, Rig& rig, const std::atomic<bool>* cancelled)
      : job_(job), rig_(rig), cancelled_(cancelled) {}

  CaseRecord run() {
    out_.id = job_.id;
    out_.index = job_.index;
    out_.rig = rig_.info();
    out_.calibration = nominal_calibration(out_.rig);
    const CalibrationLevel level = job_.calibrate.level;
    if (level != CalibrationLevel::nominal && !sweep()) return std::move(out_);
    if (level == CalibrationLevel::identified && !identify()) return std::move(out_);
    return std::move(out_);
  }

 private:
  bool failed(CaseFailure::Stage stage, Error error, Blame blame = Blame::none) {
    out_.failure = CaseFailure{stage, std::move(error), blame};
    return false;
  }

  bool play(const Stimulus& stimulus, std::uint64_t record, const ProfileSink& sink) {
    RigRecordRequest request;
    request.specimen = job_.specimen;
    request.seed = job_.seed;
    request.session = job_.session;
    request.record = record + kRecordsPerAttempt * static_cast<std::uint64_t>(job_.attempt - 1);
    request.rest_before_s = job_.calibrate.rest_s;
    request.faults = rig_faults(job_.faults);
    PlayedProfile played;
    auto done = play_profile(rig_, stimulus, request, job_.safety, sink, cancelled_, played);
    out_.observed = played.observed;
    out_.safety = played.safety;
    out_.samples += played.samples;
    out_.expected_samples += played.expected_samples;
    if (!played.rig.name.empty()) out_.rig = played.rig;
    if (done) return true;
    Error error = std::move(done.error());
    const bool ours = error.where.empty();  // the rig says which device
    const CaseFailure::Stage stage =
        ours && error.code == ErrorCode::internal ? CaseFailure::Stage::harness
        : ours && error.code == ErrorCode::cancelled ? CaseFailure::Stage::setup
                                                     : CaseFailure::Stage::rig;
    if (ours) error.where = job_.id;
    Blame blame = ours && error.code == ErrorCode::timeout ? Blame::link : Blame::none;  // cut short, as of a record
    if (error.code == ErrorCode::device && played.samples > 0 && device_of(error.where).empty()) {
      const auto checks = self_check(played.rig, played.observed);
      if (const Check* bad = first_unsound(checks)) blame = bad->blame;
    }
    return failed(stage, std::move(error), blame);
  }

  bool sweep() {
    const CalibrationSweep stimulus(job_.calibrate);
    StaticLine line;
    const double volts = out_.rig.v_range_V / static_cast<double>((1u << out_.rig.adc_bits) - 1u);
    PairMeans means(std::max<std::size_t>(1, static_cast<std::size_t>(kMeanOver_s * out_.rig.rate_Hz)));
    const bool played = play(stimulus, 1000001, [&](const RigBlock& b, std::size_t rows) {
      for (std::size_t i = 0; i < rows; ++i) largest_code_ = std::max<unsigned>(largest_code_, b.adc[i]);
      for (std::size_t i = 0; i < rows; ++i)
        if (means.push(volts * b.adc[i], b.force_ref_N[i]) && std::isfinite(means.force_N()))
          line.push(means.sensor_V(), means.force_N());
    });
    if (!played) return false;
    if (!(line.n() > 20.0) || !line.answers(1e-4))
      return failed(CaseFailure::Stage::rig,
                    {ErrorCode::device, "the sensor did not answer the calibration sweep", job_.id,
                     "is the sensor mounted and plugged in?"},
                    Blame::sensor);
    Calibration& c = out_.calibration;
    c.gain_N_per_V = line.gain_N_per_V();
    c.offset_N = line.offset_N();
    c.level = CalibrationLevel::statical;
    c.id = job_.specimen.substr(0, 14) + "/s";
    const double residual = line.residual_N(), vuu = line.variance_V2();
    // Hysteresis and curvature repeat in every branch: each branch of each sweep counts as four items.
    const double independent = 8.0 * job_.calibrate.sweeps;
    const double u_gain = residual / std::sqrt(independent * vuu);
    out_.u_gain_rel = u_gain / c.gain_N_per_V;
    out_.u_offset_N = residual * std::sqrt((1.0 + line.mean_V() * line.mean_V() / vuu) / independent);
    out_.calibration_rmse_N = residual;
    out_.calibration_text =
        fmt::format("{}: G {} N/V, F0 {} N from {} sweeps, residual {:.3f} N", job_.specimen,
                    with_uncertainty(c.gain_N_per_V, u_gain), with_uncertainty(c.offset_N, out_.u_offset_N),
                    job_.calibrate.sweeps, residual);
    note_width(line.gain_N_per_V());
    if (const std::string beyond = beyond_what_images_take(c); !beyond.empty())
      return failed(CaseFailure::Stage::rig,
                    {ErrorCode::device, "the calibration sweep gives " + beyond, job_.id,
                     "look at the sensor, its amplifier and the converter's v_range_V"},
                    Blame::sensor);
    return true;
  }

  // A converter of fewer bits than are declared never reaches the upper codes, and its gain comes out twice as large for each.
  void note_width(double gain_N_per_V) {
    const double nominal = nominal_calibration(out_.rig).gain_N_per_V;
    const int missing = static_cast<int>(std::lround(std::log2(gain_N_per_V / nominal)));
    if (missing < 2 || missing >= out_.rig.adc_bits || largest_code_ >> (out_.rig.adc_bits - missing) != 0) return;
    out_.calibration_text += fmt::format("; G is {:.3g} times the nominal one and no code is above {}, as of a converter of {} bits where adc_bits = {}",
                                         gain_N_per_V / nominal, largest_code_, out_.rig.adc_bits - missing, out_.rig.adc_bits);
  }

  // Turning points of the output and of the reference where the force of a profile turns.
  struct Envelope {
    std::vector<double> t_s, maxima_V, minima_V, maxima_N, minima_N;  ///< t_s: of the maxima, from where the excitation begins
  };

  bool identify() {
    auto made = make_stimulus(job_.calibrate.identification->stimulus);
    if (!made) return failed(CaseFailure::Stage::setup, made.error());
    const StimulusFacts facts = (*made)->facts();
    Envelope envelope;
    if (!play_for_envelope(**made, envelope)) return false;
    const double u_min_V = moments(envelope.minima_V).mean;
    const auto fit = fit_decay(envelope.t_s, envelope.maxima_V, u_min_V);
    if (!fit)
      return failed(
          CaseFailure::Stage::rig,
          {ErrorCode::device, "the dynamic record does not determine b and c/a: " + fit.error().text, job_.id,
           "take a longer record or a greater amplitude"});
    const double amplitude_N = 0.5 * (moments(envelope.maxima_N).mean - moments(envelope.minima_N).mean);
    const DecayScales scales = scales_of(*fit, facts.lowest_frequency_Hz, amplitude_N);
    return take_decay(*fit, scales, to_decay_fit(*fit, u_min_V, envelope.t_s.back()));
  }

  bool play_for_envelope(const Stimulus& stimulus, Envelope& out) {
    const StimulusFacts facts = stimulus.facts();
    ExtremaPairer::Options options;
    options.prominence = std::max(0.05, 0.25 * facts.amplitude_N);
    options.followers = 2;
    options.half_width = static_cast<int>(std::lround(0.005 * out_.rig.rate_Hz));
    ExtremaPairer pairer(options);
    std::vector<float> volts;
    const double per_code = out_.rig.v_range_V / static_cast<double>((1u << out_.rig.adc_bits) - 1u);
    const bool played = play(stimulus, 1000002, [&](const RigBlock& b, std::size_t rows) {
      volts.resize(b.size());
      for (std::size_t i = 0; i < rows; ++i) volts[i] = static_cast<float>(per_code * b.adc[i]);
      const float* followers[2] = {volts.data(), b.force_ref_N.data()};
      pairer.push({b.t_s.data(), rows}, {b.setpoint_N.data(), rows}, {followers, 2});
    });
    if (!played) return false;
    pairer.finish();
    for (const PairedExtremum& p : pairer.pairs()) {
      if (p.t_s < facts.excitation_start_s) continue;
      if (p.turn == Turn::maximum) {
        out.t_s.push_back(p.t_s - facts.excitation_start_s);
        out.maxima_V.push_back(p.value[0]);
        out.maxima_N.push_back(p.value[1]);
      } else {
        out.minima_V.push_back(p.value[0]);
        out.minima_N.push_back(p.value[1]);
      }
    }
    return true;
  }

  bool take_decay(const DecayParameters& fit, const DecayScales& scales, const DecayFit& decay) {
    Calibration& c = out_.calibration;
    c.b_scale = scales.b;
    c.q_scale = scales.q;
    if (!(c.b_scale > 0.0 && c.q_scale > 0.0) || !std::isfinite(c.b_scale * c.q_scale))
      return failed(CaseFailure::Stage::rig,
                    {ErrorCode::device,
                     fmt::format("the fitted decay is not one: a {:.3f} V, b {:.5f} 1/s, c {:.3f} V",
                                 fit.a_V, fit.b_per_s, fit.c_V),
                     job_.id,
                     {}});
    const std::string beyond = beyond_what_images_take(c), b_per_s = with_uncertainty(fit.b_per_s, fit.u_b_per_s);
    if (!beyond.empty() || fit.u_b_per_s > kSureOfRate * fit.b_per_s)
      return failed(CaseFailure::Stage::rig,
                    {ErrorCode::device,
                     fmt::format("the dynamic record does not tell b and c/a of this sensor: b {} 1/s, c/a {:.3g} x eq. (5), {:.1f} % of the swing lost{}",
                                 b_per_s, c.q_scale, decay.loss_pct, beyond.empty() ? "" : "; " + beyond),
                     job_.id, "identify it over a longer record or a greater amplitude; a sensor that does not decay is judged with --calibration static"},
                    Blame::sensor);
    c.level = CalibrationLevel::identified;
    c.id = job_.specimen.substr(0, 14) + "/i";
    out_.decay = decay;
    out_.calibration_text += fmt::format(
        "; b {} 1/s = {:.3f} x eq. (5), c/a = {:.3f} x eq. (5), {:.1f} % of the swing lost", b_per_s, c.b_scale, c.q_scale, decay.loss_pct);
    return true;
  }

  const CaseJob& job_;
  Rig& rig_;
  const std::atomic<bool>* cancelled_;
  CaseRecord out_;
  unsigned largest_code_ = 0;
};

}  // namespace

Calibration nominal_calibration(const RigInfo& info) {
  Calibration c;
  c.adc_bits = info.adc_bits;
  c.v_range_V = info.v_range_V;
  const auto declared = [&](const char* name, double& value) {
    const auto at = info.details.find(name);
    if (at == info.details.end()) return;
    double read = 0.0;
    const auto [end, error] = std::from_chars(at->second.data(), at->second.data() + at->second.size(), read);
    if (error == std::errc{} && std::isfinite(read)) value = read;
  };
  declared("nominal_gain_N_per_V", c.gain_N_per_V);
  declared("nominal_offset_N", c.offset_N);
  return c;
}

std::string beyond_what_images_take(const Calibration& c) {
  constexpr CalibrationBounds kTaken = kCalibrationBounds;
  const auto beyond = [](const char* name, double value, double low, double high, const char* unit) {
    return value >= low && value <= high ? std::string() : fmt::format("{} = {:.4g}{} (images take {} to {})", name, value, unit, low, high);
  };
  for (std::string what : {beyond("G", c.gain_N_per_V, kTaken.gain_min_N_per_V, kTaken.gain_max_N_per_V, " N/V"),
                           beyond("F0", c.offset_N, -kTaken.offset_N, kTaken.offset_N, " N"),
                           beyond("b over eq. (5)", c.b_scale, kTaken.scale_min, kTaken.scale_max, ""),
                           beyond("c/a over eq. (5)", c.q_scale, kTaken.scale_min, kTaken.scale_max, "")})
    if (!what.empty()) return what;
  return {};
}

CaseRecord run_calibration(const CaseJob& job, Rig& rig, const std::atomic<bool>* cancelled) {
  return CalibrationRun(job, rig, cancelled).run();
}

Result<CalibrationFile> read_calibration_file(const std::filesystem::path& path) {
  FORCEGATE_TRY(const ConfigNode root, read_config(path));
  CalibrationFile file;
  file.path = path;
  Calibration& c = file.calibration;
  ConfigReader r(root, "the calibration", "docs/gate.md");
  std::string level = "static", id = path.stem().string().substr(0, 16);
  std::int64_t bits = c.adc_bits, format = 1;
  double range_V = c.v_range_V;
  r.integer("format", format, 1, 1);
  constexpr CalibrationBounds kTaken = kCalibrationBounds;  // beyond, the image would refuse it and be charged with that
  r.number("gain_N_per_V", c.gain_N_per_V, kTaken.gain_min_N_per_V, kTaken.gain_max_N_per_V, ConfigReader::required);
  r.number("offset_N", c.offset_N, -kTaken.offset_N, kTaken.offset_N, ConfigReader::required);
  if (r.integer("adc_bits", bits, 8, 16)) file.adc_bits = static_cast<int>(bits);
  if (r.number("v_range_V", range_V, 0.1, 100.0)) file.v_range_V = range_V;
  const bool b = r.number("b_scale", c.b_scale, kTaken.scale_min, kTaken.scale_max);
  const bool q = r.number("q_scale", c.q_scale, kTaken.scale_min, kTaken.scale_max);
  if (b && q) level = "identified";
  r.choice("level", level, {"nominal", "static", "identified"});
  r.text("id", id);
  FORCEGATE_CHECK_OK(r.finish());
  c.level = level == "nominal"  ? CalibrationLevel::nominal
            : level == "static" ? CalibrationLevel::statical
                                : CalibrationLevel::identified;
  c.id = id.substr(0, 16);
  return file;
}

Result<Calibration> calibration_on(const RigInfo& info, const CalibrationFile& file) {
  const auto differs = [&](const std::string& key, const std::string& stated, const std::string& has, bool can_be_chosen) {
    std::string cure = "give the calibration of this rig";
    if (info.name == "bench") cure = "mend " + key + " of [board] in the bench file, or of the calibration";
    if (can_be_chosen) cure += ", or the rig that converter (--rig-option " + key + "=" + stated + ")";
    return fail(ErrorCode::config, "the calibration is of a converter with " + key + " = " + stated + ", that of the rig " + info.name + " has " + key + " = " + has,
                file.path.string(), "one of the two is wrong: " + cure);
  };
  if (file.adc_bits && *file.adc_bits != info.adc_bits)
    return differs("adc_bits", std::to_string(*file.adc_bits), std::to_string(info.adc_bits), info.name == "emulated");
  if (file.v_range_V && std::fabs(*file.v_range_V - info.v_range_V) > 1e-6 * info.v_range_V)
    return differs("v_range_V", shortest(*file.v_range_V), shortest(info.v_range_V), false);
  Calibration c = file.calibration;
  c.adc_bits = info.adc_bits;
  c.v_range_V = info.v_range_V;
  return c;
}

}  // namespace forcegate
