#include "hil/app/characterize/characterize.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "hil/app/characterize/weight_study.h"
#include "hil/base/plain_number.h"
#include "hil/base/units.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/force_row.h"
#include "hil/cli/verbs/rig_choice.h"
#include "hil/report/capacitance/weight_json.h"
#include "hil/report/characterization/paper_claims.h"
#include "hil/report/characterization/paper_tables.h"
#include "hil/report/characterization/study_json.h"

namespace forcegate {
namespace {

std::vector<std::string> sensors() { return {"flexiforce", "fsr"}; }

std::string procedures() {
  constexpr std::size_t kWidth = 100;
  const std::string indent(23, ' ');
  std::string out = "Procedures a plan can list, and the keys of what they measure, which a limit can be set on:\n";
  for (const auto& p : Registry<characterize::ProcedureKind>::instance().all()) {
    out += fmt::format("  {:<20} {}\n", p.name, p.doc);
    std::vector<std::string> keys;
    for (const std::string& sensor : sensors())
      for (std::string& key : p.keys({}, sensor))
        if (std::ranges::find(keys, key) == keys.end()) keys.push_back(std::move(key));
    std::string line;
    for (const std::string& key : keys) {
      if (!line.empty() && indent.size() + line.size() + key.size() + 2 > kWidth) out += indent + std::exchange(line, "") + ",\n";
      line += (line.empty() ? "" : ", ") + key;
    }
    if (!line.empty()) out += indent + line + "\n";
  }
  return out;
}

std::string bench_time(double seconds) {
  return seconds < 7200.0 ? fmt::format("{:.1f} min of bench time", seconds / 60.0)
                          : fmt::format("{:.1f} h of bench time", seconds / 3600.0);
}

void print_study(const Console& console, const characterize::SensorStudy& study, std::string& out) {
  const std::string sheets = counted(study.sheets.size(), study.of_recordings ? "recording" : "session");
  out += console.paint(Paint::strong, study.sensor) + fmt::format(": {}, {}\n", sheets, bench_time(study.rig_time_s));
  for (const auto& s : study.spreads)
    if (s.n > 0)
      out += fmt::format("  {:<66} {:>10} {:<6} sd {:>8}\n", s.title, short_number(s.mean), unit_in_text(s.unit),
                         short_number(s.specimens > 1 ? s.sd_specimens : s.sd_sessions, 2));
  for (const auto& sheet : study.sheets)
    for (const std::string& note : sheet.notes)
      if (!console.quiet()) out += "  " + console.paint(Paint::warn, "note: ") + sheet.specimen + ": " + note + "\n";
  const auto told = [&](const characterize::SessionSheet& sheet, const std::string& name) {
    if (sheet.failure) out += "  " + console.paint(Paint::fail, fmt::format("{} failed: {}", name, sheet.failure->text)) + "\n";
  };
  for (const auto& sheet : study.sheets) told(sheet, fmt::format("{} session {}", sheet.specimen, sheet.session));
  told(study.exemplar, fmt::format("the exemplar {}", study.exemplar.specimen));
}

// What takes the most of what was written. A calibration is that of one session, and the emulated rig's next one has another gain and zero.
std::string what_next(const CharacterizeRequest& request, const Characterization& made) {
  std::filesystem::path calibration, model;
  for (const std::filesystem::path& file : made.files) {
    const std::string name = file.filename().string();
    if (name.starts_with("calibration-") && calibration.empty()) calibration = file;
    if (name.ends_with("-identified.toml")) calibration = file;
    if (name == made.studies.front().sensor + ".toml") model = file;
  }
  if (!request.recordings.empty() && !model.empty() && !request.rig_options.contains("map"))
    return "forcegate compare " + file_quoted(request.recordings.front().string()) + " --model " + file_quoted(model.string());
  if (request.rig == "emulated" && model.empty()) return {};
  if (request.rig == "emulated") {
    const std::filesystem::path campaign = request.output / "campaign";
    std::error_code unknown;
    if (std::filesystem::exists(campaign / "campaign.json", unknown)) return "forcegate compare " + file_quoted(campaign.string()) + " --model " + file_quoted(model.string());
    std::string options = made.studies.front().sensor == "fsr" ? " --rig-option sensor=fsr" : "";
    for (const auto& [name, value] : request.rig_options)
      if (name != "sensor") options += " --rig-option " + shell_quoted(name + "=" + value);
    return fmt::format("forcegate record --specimen {} --seed {}{} -o {}", shell_quoted(made.plan.specimens.front()), made.plan.seed, options, file_quoted(campaign.string()));
  }
  return calibration.empty() ? "" : "forcegate gate FIRMWARE --cal " + file_quoted(calibration.string());
}

Result<int> run_weights(const Invocation& in, const CharacterizeRequest& request) {
  Console& console = in.console();
  const auto made = weight_study_request(request, console.progress_callback(), &in.interrupt_flag());
  console.end_progress();
  if (!made) return Unexpected(made.error());
  const characterize::WeightSummary& s = made->summary;
  std::string text =
      fmt::format("{} packs of eight sensors: the network of conductance and capacitance reduces the error by {:.1f} %{}paper: 64 %)\n",
                  made->study.sets.size(), s.per_mean_pct,
                  std::isfinite(s.per_sd_sets_pct) && made->study.sets.size() > 1
                      ? fmt::format(" +- {:.1f} (standard deviation from pack to pack; ", s.per_sd_sets_pct)
                      : " (");
  for (std::size_t m = 0; m < characterize::kForceModels; ++m)
    text += fmt::format("  {:<24} MSE {:.3f} N^2, 5 to 95 % {:.3f} to {:.3f}\n",
                        characterize::kForceModelNames[m], s.mse_mean[m], s.mse_q05[m], s.mse_q95[m]);
  bool inside = true;
  for (const characterize::WeightClaim& c : claims_of(made->study, s)) {
    if (!c.has_window || c.inside) continue;
    inside = false;
    text += console.paint(Paint::warn,
                          fmt::format("  outside its window: {}: {} ({})", c.subject, c.ours, c.window)) +
            "\n";
  }
  text += fmt::format("{:.0f} h of bench time, {:.0f} million samples", made->study.bench_time_s / 3600.0,
                      1e-6 * static_cast<double>(made->study.samples));
  if (inside) text += "; every figure that has a window lies in it";
  console.print(text);
  console.print_json(weight_json(made->study, s, false, made->files));
  if (!request.output.empty()) console.look_at((request.output / "sheet-capacitance.html").string());
  return kExitSuccess;
}

Result<int> run(const Invocation& in) {
  CharacterizeRequest request;
  FORCEGATE_TRY(RigChoice rig, rig_choice(in));
  request.plan = in.given("record") && !in.given("plan") ? "" : in.text("plan");
  request.rig = std::move(rig.rig);
  request.rig_options = std::move(rig.options);
  if (in.given("sensor")) request.sensors = in.texts("sensor");
  for (const std::string& file : in.texts("record")) request.recordings.emplace_back(file);
  if (request.rig == "replay" && request.recordings.empty())
    return fail(ErrorCode::usage, "the replay rig needs recordings", "--rig replay",
                "add --record FILE, once for each");
  request.specimens = in.texts("specimen");
  if (in.given("sessions")) {
    FORCEGATE_TRY(const std::int64_t sessions, in.integer("sessions", 1, 1000));
    request.sessions = static_cast<int>(sessions);
  }
  if (in.given("seed")) {
    FORCEGATE_TRY(request.seed, in.seed("seed"));
  }
  FORCEGATE_TRY(const std::int64_t threads, in.integer("threads", 0, 1024));
  request.threads = static_cast<unsigned>(threads);
  request.output = in.text("output");
  request.overwrite = in.flag("force");
  request.paper = in.text("paper");
  request.golden = in.text("golden");
  request.command_line = in.command_line_without("threads");  // the pages do not depend on it, as the answer does not
  FORCEGATE_TRY(const bool weights, is_weight_study(request));
  if (weights) return run_weights(in, request);

  Console& console = in.console();
  const auto begin = std::chrono::steady_clock::now();
  const auto made = characterize_request(request, console.progress_callback(), &in.interrupt_flag());
  console.end_progress();
  if (!made) return Unexpected(made.error());
  const double wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  std::string text;
  for (const auto& study : made->studies) print_study(console, study, text);
  bool kept = true;
  for (const auto& r : check_limits(made->studies, made->plan)) {
    kept = kept && r.kept;
    const std::string asked = (std::isfinite(r.limit.minimum) ? "at least " + short_number(r.limit.minimum) : "") +
                              (std::isfinite(r.limit.minimum) && std::isfinite(r.limit.maximum) ? ", " : "") +
                              (std::isfinite(r.limit.maximum) ? "at most " + short_number(r.limit.maximum) : "") + " - " + r.limit.source;
    if (r.sessions > 0)
      text += fmt::format("{} {} {}: worst {} {} ({}), {}; {} of {} {} outside\n", console.paint(r.kept ? Paint::pass : Paint::fail, r.kept ? "kept " : "BROKEN"), r.sensor, r.title,
                          short_number(r.worst), r.unit, r.specimen, asked, r.outside, r.sessions, request.recordings.empty() ? "sessions" : "recordings");
    else
      text += fmt::format("{} {} by any of the {}: {}\n", console.paint(Paint::fail, "not measured"), r.limit.key, request.recordings.empty() ? "sessions" : "recordings", asked);
  }
  std::size_t outside = 0;
  for (const PaperClaim& c : compare_with_paper(made->studies))
    if (!c.inside()) {
      ++outside;
      text +=
          console.paint(Paint::warn, fmt::format("  outside its window: {} {}: {} {} (the paper: {})",
                                                 c.place, c.subject, short_number(c.ours), c.unit, c.paper)) +
          "\n";
    }
  const double samples_per_s = static_cast<double>(made->samples) / wall_s;
  text += fmt::format("{} of bench time in {:.1f} s, {} samples a second",
                      made->rig_time_s < 7200.0 ? fmt::format("{:.1f} min", made->rig_time_s / 60.0)
                                                : fmt::format("{:.0f} h", made->rig_time_s / 3600.0),
                      wall_s,
                      samples_per_s < 1e6 ? fmt::format("{:.0f}", samples_per_s)
                                          : fmt::format("{:.1f} million", 1e-6 * samples_per_s));
  const Error* failure = made->first_failure();
  if (failure == nullptr && request.recordings.empty() && outside == 0 && made->plan.limits.empty())
    text += "; every figure that has a window lies in it";
  console.print(text);
  console.print_json(study_json(made->studies, made->plan, false, made->files));
  if (!request.output.empty()) console.look_at((request.output / ("sheet-" + made->studies.front().sensor + ".html")).string());
  if (const std::string next = what_next(request, *made); !next.empty()) console.next(next);
  // A limit that a failed session did not meet is no word on the sensor.
  if (failure != nullptr) return exit_code_of(failure->code);
  return kept ? kExitSuccess : kExitReject;
}

const Registration<Command> kRow{Command{
    .name = "characterize",
    .group = "Diagnosis",
    .summary = "measure a sensor by the procedures of the paper",
    .description =
        "Plays the procedures of Lebosse et al. 2011 on a rig and writes the sensor's data sheet (HTML and "
        "JSON), a model file that compare, diagnose and fit take, and "
        "calibration files for gate --cal. A plan says which procedures, how many specimens and sessions.\n\n"
        "On the emulated rig the whole study of the paper, 30 specimens in 3 sessions with both sensors, is "
        "some 3200 hours of bench time and takes 20 minutes of one processor. --paper writes "
        "the page that sets every figure of the paper beside ours (docs/paper.md).\n\n"
        "A plan can set limits ([[limit]]) that every session must keep; a broken one gives exit code 1. A "
        "session in which the rig failed gives 4 (5 after a safety stop), whatever the others say. The "
        "plan tms does so for robotised TMS.\n\n"
        "The plan capacitance plays Paredes-Madrid et al. 2010 instead, on a bench of dead weights: "
        "resistance and capacitance of packs of eight sensors, frequency sweeps, force models "
        "of one and of two variables (docs/paper-capacitance.md).\n\n"
        "A recording can stand for the rig: cyclic ones give the decay, slow ones the static law. With --plan it must keep that plan's limits, a key "
        "that no recording measures being one that is not kept.",
    .options = joined(
        {{{.name = "plan",
           .value_name = "PLAN",
           .doc = "Plan file, or the name of one in ci/plans.",
           .fallback = "characterize",
           .names = Names::input}},
         rig_rows(),
         {{.name = "sensor",
           .value_name = "SENSOR",
           .doc = "Only this sensor; default: both.",
           .choices = sensors,
           .repeatable = true},
          {.name = "record",
           .value_name = "FILE",
           .doc = "Recording to characterise (rig replay): columns t_s, U_V, F_ref_N.",
           .repeatable = true,
           .names = Names::input},
          {.name = "specimen",
           .value_name = "NAME",
           .doc = "Specimens instead of the plan's: q50, seed:17, or the bench's id.",
           .repeatable = true},
          {.name = "sessions", .value_name = "N", .doc = "Sessions of each specimen instead of the plan's."},
          {.name = "seed", .value_name = "N", .doc = "Seed instead of the plan's."},
          {.name = "output",
           .value_name = "DIR",
           .doc = "Folder for data sheets, JSON, model and calibration files.",
           .fallback = "build/characterize",
           .letter = 'o',
           .names = Names::folder},
          {.name = "paper", .value_name = "DIR", .doc = "Folder for paper.md and pictures/paper.", .names = Names::folder},
          {.name = "golden", .value_name = "DIR", .doc = "Folder for golden traces of the exemplar.", .names = Names::folder},
          {.name = "threads",
           .value_name = "N",
           .doc = "0: one per processor. The answer does not depend on it.",
           .fallback = "0"},
          force_row()}}),
    .examples = {{"forcegate characterize --specimen q50 --sessions 1 -o q50",
                  "One sensor: data sheet, model, calibration (seconds):"},
                 {"forcegate characterize --paper docs", "The whole study and docs/paper.md (minutes):"},
                 {"forcegate characterize --plan tms",
                  "1.5 N on a moving head for 20 min, with the paper's bounds:"},
                 {"forcegate characterize --plan capacitance",
                  "Conductance and capacitance together (a minute or two):"},
                 {"forcegate characterize --record sine.csv --record ramp.csv -o mine",
                  "What my own recordings say:"}},
    .details = procedures,
    .exit_codes = {kExitSuccess, kExitReject, kExitUsage, kExitRigFault, kExitSafetyStop, kExitInterrupted},
    .reject_text = "A sensor broke a limit of the plan; the output names the limit and the worst specimen.",
    .run = run,
}};

}  // namespace
}  // namespace forcegate
