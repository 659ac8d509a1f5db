// From a study to what others use: the model file of the diagnosis and the calibration file of the gate.

#include <fmt/format.h>

#include <cmath>

#include "hil/app/characterize/characterize.h"
#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/model/model.h"

namespace forcegate {
namespace {

using characterize::SensorStudy;
using characterize::SessionSheet;
using characterize::Spread;

// What one more specimen may differ by: both levels of spread together.
double spread_of(const Spread& s) {
  const double between = std::isfinite(s.sd_specimens) ? s.sd_specimens : 0.0,
               within = std::isfinite(s.sd_sessions) ? s.sd_sessions : 0.0;
  return std::sqrt(between * between + within * within);
}

// Recordings are of a sensor that nothing says the shipped model is of: what they did not measure is not told as if it were known.
void take_no_more_than_recorded(const SensorStudy& study, Model& model) {
  const auto measured = [&](std::string_view key) {
    const Spread* s = study.find(key);
    return s != nullptr && std::isfinite(s->mean);
  };
  const bool named = study.sensor == "flexiforce" || study.sensor == "fsr";
  if (!named) model.sensor.clear();
  model.se_gain = model.se_offset = model.se_b_scale = model.se_q_scale = 0.0;
  const bool cycled = measured("recording.frequency");
  model.law.decays = model.law.decays && (measured("identified.b") || (named && !cycled));
}

void take(const SensorStudy& study, std::string_view key, double& value, double& se) {
  const Spread* s = study.find(key);
  if (s == nullptr || !std::isfinite(s->mean)) return;
  value = s->mean;
  if (const double u = spread_of(*s); u > 0.0 && !study.of_recordings) se = u;  // recordings of who knows what differ by more than one sensor does
}

}  // namespace

Result<std::string> model_of_study(const SensorStudy& study) {
  const bool fsr = study.sensor == "fsr";
  FORCEGATE_TRY(Model model, library_model(fsr ? "fsr" : "flexiforce"));
  model.name = study.sensor + "-characterized";
  if (study.of_recordings) take_no_more_than_recorded(study, model);
  std::size_t specimens = 0;
  if (const Spread* g = study.find("static.gain")) specimens = g->specimens;
  const std::size_t sheets = study.sheets.size();
  model.source = "forcegate characterize, " + (study.of_recordings ? counted(sheets, "recording")
                                                                   : counted(specimens, "specimen") + ", " + counted(sheets, "session"));
  if (fsr) model.source += "; static law and one lag are ours, the paper gives no model of the FSR";
  take(study, "static.gain", model.law.gain_N_per_V, model.se_gain);
  take(study, "static.offset", model.law.offset_N, model.se_offset);
  if (!fsr) {
    take(study, "identified.b", model.law.b_scale, model.se_b_scale);
    take(study, "identified.q", model.law.q_scale, model.se_q_scale);
  }
  if (const Spread* lag = study.find("step.lag"); fsr && lag != nullptr)
    for (ModelEffect& e : model.effects)
      for (ModelParameter& p : e.shape)
        if (e.effect == "lag" && p.name == "tau_s") {
          p.value = 1e-3 * lag->mean;
          p.se = 1e-3 * spread_of(*lag);
        }
  return write_model(model);
}

std::string calibration_text(const SessionSheet& sheet) {
  const Calibration& c = sheet.calibration;
  std::string out = fmt::format(
      "# {}, session {}: forcegate gate FIRMWARE --cal THIS\nformat = 1\ngain_N_per_V = {}\noffset_N = {}\n",
      printable_utf8(sheet.specimen), sheet.session, shortest(c.gain_N_per_V), shortest(c.offset_N));
  if (c.level == CalibrationLevel::identified)
    out += fmt::format("b_scale = {}\nq_scale = {}\n", shortest(c.b_scale), shortest(c.q_scale));
  if (!sheet.assumed_converter.empty()) out += "# assumed, since nothing states the converter: " + sheet.assumed_converter + "\n";
  return out + fmt::format("adc_bits = {}\nv_range_V = {}\nlevel = \"{}\"\n", c.adc_bits,
                           shortest(c.v_range_V), to_string(c.level));
}

}  // namespace forcegate
