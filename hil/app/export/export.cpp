#include "hil/app/export/export.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hil/app/export/calibration_map.h"
#include "hil/app/export/recorded_rate.h"
#include "hil/app/export/replayed_far_off.h"
#include "hil/app/files/find_plan.h"
#include "hil/app/files/write_file.h"
#include "hil/app/model/never_fitted.h"
#include "hil/base/digest.h"
#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/diagnose/laws/no_input.h"

namespace forcegate {
namespace {

// A strength belongs to the temperature from which it was fitted: another one makes another model of it.
Result<void> set_reference(Model& model, double given_C) {
  constexpr double kSame_degC = 1e-3;
  if (std::isnan(given_C)) return {};
  if (std::isfinite(model.frame.temperature_C) && std::fabs(model.frame.temperature_C - given_C) > kSame_degC)
    return fail(ErrorCode::usage, fmt::format("the effects of {} are zero at {:.4g} degC, not at {:.4g}", model.name, model.frame.temperature_C, given_C),
                "--reference-temperature", "leave it out: the model says it");
  if (!std::isfinite(model.frame.temperature_C)) model.frame.temperature_C = given_C;
  return {};
}

constexpr double kWorse = 1.02;

std::vector<std::string> fit_notes(const ExportResult& r) {
  std::vector<std::string> out;
  const std::size_t worse = static_cast<std::size_t>(std::ranges::count_if(r.fit->records, [](const auto& item) { return item.model_V > kWorse * item.law_V; }));
  if (!r.compensator.effects.empty() && worse > 0)
    out.push_back(fmt::format("{} of {} records {} worse with the effects than with the law alone", worse, r.fit->records.size(), worse == 1 ? "is" : "are"));
  out.insert(out.end(), r.fit->notes.begin(), r.fit->notes.end());
  return out;
}

// The reason why it is too slow a rate rather than the model, where a faster one undoes it.
Result<SelfCheck> check_itself(const Model& model, const Compensator& made, const CompensatorOptions& at) {
  Result<SelfCheck> out = self_check(model, made, at.rate_Hz);
  const bool has_states = std::ranges::any_of(model.user_effects, [](const UserEffect& effect) { return !effect.states.empty(); });
  if (out || out.error().code != ErrorCode::config || !has_states) return out;
  constexpr double kFastest_Hz = 20'000.0;
  CompensatorOptions faster = at;
  for (const double times : {2.0, 5.0, 10.0}) {
    faster.rate_Hz = times * at.rate_Hz;
    if (faster.rate_Hz > kFastest_Hz) break;
    const auto again = make_compensator(model, faster);
    if (!again || !self_check(model, *again, faster.rate_Hz)) continue;
    out.error().hint = fmt::format("a state of its equations moves within a few of the {:g} samples a second: --rate {:g} undoes it, and the firmware must sample as fast",
                                   at.rate_Hz, faster.rate_Hz);
    break;
  }
  return out;
}

// Nobody tells a firmware what the film felt before it was switched on.
std::string begins_anew(const Model& model) {
  const std::vector<std::string> effects = model.effect_names();
  if (std::ranges::find(effects, "hysteresis") == effects.end()) return {};
  return "the loop begins anew at power-up, as of a film that was unloaded: until the load has been through its range once, the force may be off by as much as the loop is wide";
}

std::vector<std::string> notes_of(const ExportResult& r) {
  std::vector<std::string> out;
  if (!r.self.made) out.push_back("not held against the model's own inverse: " + r.self.why_not);
  if (std::string note = note_of_rate(r.rate_Hz, r.recorded_Hz); !note.empty()) out.push_back(std::move(note));
  out.insert(out.end(), r.notes.begin(), r.notes.end());
  return out;
}

std::string fit_text(const ExportResult& r, bool notes) {
  const PrintedUnit unit = printed_unit(r.input_unit);
  const bool bare = r.compensator.effects.empty();
  const auto left_out = [&](double V) { return plain_number(unit.factor * V); };
  std::string out = "one law for all records, as a firmware has it: error of records left out " + left_out(r.fit->law_left_out_V) +
                    (bare ? " " + unit.name : fmt::format(" -> {} {} with the effects", left_out(r.fit->left_out_V), unit.name)) + "\n";
  for (const auto& item : r.fit->records)
    out += fmt::format("    {:<28} {:>8.1f}{} {}\n", item.record, unit.factor * item.law_V, bare ? "" : fmt::format(" -> {:.1f}", unit.factor * item.model_V), unit.name);
  if (notes)
    for (const std::string& note : fit_notes(r)) out += "note: " + note + "\n";
  return out;
}

}  // namespace

std::string nothing_gained(const ExportResult& r) { return r.check && !r.compensator.effects.empty() ? gains_nothing(*r.check) : std::string(); }

namespace {

std::string check_text(const ExportResult& r, bool notes) {
  const CompensatorCheck& check = *r.check;
  const auto lsb = [&](double size_N, const std::string& before) { return check.lsb_N > 0.0 ? before + plain_number(size_N / check.lsb_N) + " LSB" : std::string(); };
  const bool bare = r.compensator.effects.empty();
  const auto errors = [&](double law_N, double header_N) {
    return bare ? fmt::format("{:>8.1f}", 1e3 * law_N) : fmt::format("{:>8.1f} -> {:.1f}", 1e3 * law_N, 1e3 * header_N);
  };
  std::string out = fmt::format("built with {} and replayed:\n  largest difference from the model's own inverse {:.2g} N{}\n",
                                check.compiler, check.largest_N, lsb(check.largest_N, " = "));
  out += fmt::format("  recorded {} against recorded force{}, RMS in mN ({}):\n    {}\n", r.input.empty() ? "voltages" : "outputs",
                     check.lsb_N > 0.0 ? " and the largest difference from the model's own inverse" : "",
                     bare ? "the law alone" : "the law alone -> with this header",
                     check.by_model ? "with gain and offset of the model, by which the firmware calibrates"
                                    : "with the best straight line over them, as the plan's calibration finds it on the bench");
  for (const ReplayedRecord& item : check.records)
    out += fmt::format(
        "    {:<28} {:>5.0f} s {}{}{}\n", item.record, item.seconds,
        check.by_model ? errors(item.raw_plain_rms_N, item.raw_compensated_rms_N) : errors(item.plain_rms_N, item.compensated_rms_N),
        lsb(item.largest_N, ", difference "),
        (item.left_out_s >= 0.1 ? fmt::format(", {:.3g} s without samples not judged", item.left_out_s) : "") +
            (item.cut_s >= 0.1 ? fmt::format(", the {} s behind not replayed", plain_number(item.cut_s)) : ""));
  const std::string raw = errors(check.raw_plain_rms_N, check.raw_compensated_rms_N), line = errors(check.plain_rms_N, check.compensated_rms_N);
  out += fmt::format("    {:<28} {:>7} {}\n", "all records", "", check.by_model ? raw : line);
  out += fmt::format("    {:<36} {}\n", check.by_model ? "with the best straight line instead" : "gain and offset of the model instead", check.by_model ? line : raw);
  if (notes && !check.assumed.empty()) out += "note: " + check.assumed + "\n";
  for (const std::string& objection : objections(check)) out += "warning: " + objection + "\n";
  if (const std::string nothing = nothing_gained(r); !nothing.empty()) out += "warning: " + nothing + "\n";
  if (!check.far_off.empty()) out += "warning: " + check.far_off + "\n";
  return out;
}

}  // namespace

Result<ExportResult> export_model(const ExportRequest& request) {
  FORCEGATE_TRY(Model model, load_model(request.model));
  ExportResult out;
  out.rate_Hz = request.rate_Hz;
  CompensatorOptions options;
  options.rate_Hz = request.rate_Hz;
  options.reference_temperature_C = request.reference_temperature_C;
  if (request.fit) {
    FORCEGATE_TRY(Campaign records, load_campaign(*request.fit));
    FORCEGATE_CHECK_OK(diagnose::check_shows_a_law(records));
    out.recorded_Hz = recorded_rate_Hz(records);
    const auto undone = [&](Model m) {
      const auto made = make_compensator(m, options);
      return made && set_reference(m, request.reference_temperature_C) && self_check(m, *made, request.rate_Hz);
    };
    FORCEGATE_TRY(out.fit, diagnose::fit_one_law(std::move(records), model, undone, request.fit->threads));
    model = out.fit->model;
  }
  const std::string fitted = write_model(model);
  FORCEGATE_CHECK_OK(set_reference(model, request.reference_temperature_C));
  if (request.plan != "none") {
    FORCEGATE_TRY(const std::filesystem::path path, find_plan(request.plan));
    FORCEGATE_TRY(const Plan plan, read_plan(path));
    FORCEGATE_TRY(options.calibration, calibration_map(model, plan));
    if (options.calibration.known)
      options.calibration.protocol = "plan " + plan.name + ": " + options.calibration.protocol;
  }
  options.provenance.push_back(
      fmt::format("Model {}, SHA-256 {}.", model.name, sha256_hex(write_model(model)).substr(0, 16)));
  for (const HistoryStep& step : model.history) {
    const PrintedUnit unit = printed_unit(step.unit);
    options.provenance.push_back(fmt::format("{} on campaign {}: {} error {:.3g} -> {:.3g} {}.",
                                             step.one_law ? "One law for all records" : step.effect.empty() ? "Refitted" : step.effect + " added", step.campaign,
                                             step.one_law ? "left-out" : "held-out",
                                             unit.factor * step.error_before, unit.factor * step.error_after, unit.name));
  }
  options.provenance.push_back(fmt::format("G {} N/{}, F0 {} N, b x {}, c/a x {}.",
                                           with_uncertainty(model.law.gain_N_per_V, model.se_gain), model.output_unit,
                                           with_uncertainty(model.law.offset_N, model.se_offset),
                                           with_uncertainty(model.law.b_scale, model.se_b_scale),
                                           with_uncertainty(model.law.q_scale, model.se_q_scale)));
  for (const ModelEffect& e : model.effects)
    for (const ModelParameter& p : e.strength)
      if (p.value != 0.0)
        options.provenance.push_back(fmt::format("{} {} = {}{}.", e.effect, p.name,
                                                 with_uncertainty(p.value, p.se),
                                                 p.unit == "1" ? "" : " " + p.unit));
  out.input_unit = model.output_unit;
  out.input = input_in_words(model);
  out.notes = undone_as_written_notes(model);
  for (const std::string& name : never_fitted_equations(model)) options.provenance.push_back(name + ": as written, never fitted.");
  for (const std::string& name : never_fitted_effects(model)) options.provenance.push_back(name + ": as written, never fitted.");
  if (const std::string text = begins_anew(model); !text.empty()) {
    out.notes.push_back(text);
    options.provenance.push_back(text + ".");
  }
  if (model.law.decays && model.law.loading_share > 0.0)
    out.notes.push_back(fmt::format("the decay goes with the loading done (loading_share = {}): the shrink that the firmware hands over has to count it, and the reference firmware counts the time alone",
                                    shortest(model.law.loading_share)));
  FORCEGATE_TRY(out.compensator, make_compensator(model, options));
  FORCEGATE_TRY(out.self, check_itself(model, out.compensator, options));
  out.calibration = options.calibration;
  if (request.check) {
    FORCEGATE_TRY(const Campaign campaign, load_campaign(*request.check));
    if (!(out.recorded_Hz > 0.0)) out.recorded_Hz = recorded_rate_Hz(campaign);
    FORCEGATE_TRY(out.check, check_compensator(model, out.compensator, request.rate_Hz, campaign));
    out.check->by_model = !options.calibration.known;
    if (out.fit) out.check->far_off = replayed_far_off(*out.fit, *out.check, model.law.gain_N_per_V);
  }
  // Together, when both stand: a model without its header would look like an answer.
  if (out.fit && !request.fitted.empty()) FORCEGATE_CHECK_OK(write_file_atomically(request.fitted, fitted));
  if (!request.header.empty()) {
    FORCEGATE_CHECK_OK(write_file_atomically(request.header, out.compensator.header));
    out.header = request.header;
  }
  return out;
}

std::string export_text(const ExportResult& r, bool notes) {
  const Compensator& c = r.compensator;
  std::string out;
  if (r.fit) out += fit_text(r, notes);
  if (!r.header.empty())
    out += fmt::format("{}: compensator {}, {} bytes of C11\n", r.header.string(), c.id, c.header.size());
  for (const std::string& effect : c.effects) out += "  undoes " + effect + "\n";
  if (!r.input.empty()) out += "  its input U is " + r.input + ": no voltage\n";
  if (c.effects.empty())
    out += "  the law alone: the reference firmware computes its inverse without this header\n";
  out += fmt::format(
      "  runs at {:g} Hz: at most {} floating-point operations a sample, {} bytes of state, noise at rest x {:.2f}\n",
      r.rate_Hz, c.operations, c.state_bytes, c.noise_gain);
  if (r.calibration.known)
    out += fmt::format(
        "  takes back what the calibration makes of it ({}): gain x {:.4f}, offset {:+.4f} N\n",
        r.calibration.protocol, 1.0 / r.calibration.alpha, -r.calibration.beta_N / r.calibration.alpha);
  if (r.self.made)
    out += fmt::format("  held against the model's own inverse from {:.2g} to {:.2g} N: at most {:.2g} N apart\n", r.self.low_N,
                       r.self.high_N, r.self.largest_N);
  if (notes)
    for (const std::string& note : notes_of(r)) out += "note: " + note + "\n";
  if (r.check) out += check_text(r, notes);
  return out;
}

std::string export_json(const ExportResult& r) {
  nlohmann::ordered_json out = {{"format", 1},
                                {"header", r.header.string()},
                                {"id", r.compensator.id},
                                {"input_unit", r.input_unit},
                                {"rate_Hz", r.rate_Hz},
                                {"recorded_rate_Hz", r.recorded_Hz > 0.0 ? nlohmann::ordered_json(r.recorded_Hz) : nlohmann::ordered_json()},
                                {"effects", r.compensator.effects},
                                {"operations", r.compensator.operations},
                                {"state_bytes", r.compensator.state_bytes},
                                {"noise_gain", r.compensator.noise_gain},
                                {"needs_temperature", r.compensator.needs_temperature},
                                {"notes", notes_of(r)}};
  if (r.self.made) out["self_check"] = {{"low_N", r.self.low_N}, {"high_N", r.self.high_N}, {"largest_N", r.self.largest_N}, {"at_N", r.self.at_N}};
  if (r.fit) {
    nlohmann::ordered_json records = nlohmann::ordered_json::array();
    for (const auto& item : r.fit->records) records.push_back({{"record", item.record}, {"law_V", item.law_V}, {"model_V", item.model_V}});
    out["fit"] = {{"law_left_out_V", r.fit->law_left_out_V}, {"left_out_V", r.fit->left_out_V}, {"records", records}, {"notes", fit_notes(r)}};
  }
  if (r.calibration.known)
    out["calibration"] = {{"protocol", r.calibration.protocol},
                          {"alpha", r.calibration.alpha},
                          {"beta_N", r.calibration.beta_N},
                          {"b", r.calibration.b},
                          {"q", r.calibration.q},
                          {"residual_pct", r.calibration.residual_pct}};
  if (r.check) {
    nlohmann::ordered_json records = nlohmann::ordered_json::array();
    for (const ReplayedRecord& item : r.check->records)
      records.push_back({{"record", item.record},
                         {"seconds", item.seconds},
                         {"left_out_s", item.left_out_s},
                         {"cut_s", item.cut_s},
                         {"largest_N", item.largest_N},
                         {"plain_rms_N", item.plain_rms_N},
                         {"compensated_rms_N", item.compensated_rms_N},
                         {"raw_plain_rms_N", item.raw_plain_rms_N},
                         {"raw_compensated_rms_N", item.raw_compensated_rms_N},
                         {"own_plain_rms_N", item.own_plain_rms_N},
                         {"own_compensated_rms_N", item.own_compensated_rms_N}});
    out["check"] = {{"compiler", r.check->compiler},
                    {"largest_N", r.check->largest_N},
                    {"lsb_N", r.check->lsb_N},
                    {"assumed", r.check->assumed},
                    {"plain_rms_N", r.check->plain_rms_N},
                    {"compensated_rms_N", r.check->compensated_rms_N},
                    {"raw_plain_rms_N", r.check->raw_plain_rms_N},
                    {"raw_compensated_rms_N", r.check->raw_compensated_rms_N},
                    {"calibrated_by", r.check->by_model ? "model" : "plan"},
                    {"line", {{"gain", r.check->line_gain}, {"zero_N", r.check->line_zero_N}}},
                    {"objections", objections(*r.check)},
                    {"gains_nothing", nothing_gained(r)},
                    {"far_off", r.check->far_off},
                    {"records", records}};
  }
  return out.dump(2) + "\n";
}

}  // namespace forcegate
