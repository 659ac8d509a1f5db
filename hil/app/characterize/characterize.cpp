#include "hil/app/characterize/characterize.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

#include "golden/compare/lebosse_oracle.h"
#include "hil/app/characterize/recordings.h"
#include "hil/app/files/claimed_folder.h"
#include "hil/app/files/find_plan.h"
#include "hil/app/files/named_once.h"
#include "hil/app/files/own_file.h"
#include "hil/app/files/write_file.h"
#include "hil/base/text.h"
#include "hil/interface/dut.h"
#include "hil/report/characterization/data_sheet.h"
#include "hil/report/characterization/golden_traces.h"
#include "hil/report/characterization/paper_page.h"
#include "hil/report/characterization/study_json.h"

namespace forcegate {
namespace {

namespace fs = std::filesystem;
using characterize::SensorStudy;
using characterize::SessionSheet;

constexpr std::size_t kMostCalibrationFiles = 60;

std::string file_name_of(std::string specimen) {
  for (char& c : specimen)
    if (std::string_view("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-").find(c) ==
        std::string_view::npos)
      c = '-';
  return specimen;
}

class Writer {
 public:
  Writer(std::vector<fs::path>& files, bool overwrite) : files_(files), overwrite_(overwrite) {}
  /// `mark`: of an own file; "" replaces any.
  Result<void> write(const fs::path& path, std::string_view text, std::string_view mark = {}) {
    if (!overwrite_) FORCEGATE_CHECK_OK(check_own_file(path, mark));
    FORCEGATE_CHECK_OK(write_file_atomically(path, text));
    files_.push_back(path);
    return {};
  }

 private:
  std::vector<fs::path>& files_;
  bool overwrite_;
};

constexpr std::string_view kMarkOfStudy = "\"kind\": \"characterization\"";

// Before hours of play: what is written in any case.
Result<void> check_output(const CharacterizeRequest& request) {
  if (request.output.empty() || request.overwrite) return {};
  FORCEGATE_CHECK_OK(check_own_file(request.output / "study.json", kMarkOfStudy));
  std::vector<std::string> sensors = request.sensors;
  if (!request.recordings.empty() && sensors.size() != 1) sensors = {"recording"};
  for (const std::string& sensor : sensors) {
    FORCEGATE_CHECK_OK(check_own_file(request.output / ("sheet-" + sensor + ".html"), kMarkOfPage));
    FORCEGATE_CHECK_OK(check_own_file(request.output / ("sheet-" + sensor + ".json"), kMarkOfStudy));
    FORCEGATE_CHECK_OK(check_own_file(request.output / (sensor + ".toml"), kMarkOfModel));
  }
  return {};
}

Result<void> write_output(const CharacterizeRequest& request, const Characterization& made, Writer& writer) {
  if (request.output.empty()) return {};
  FORCEGATE_CHECK_OK(writer.write(request.output / "study.json", study_json(made.studies, made.plan), kMarkOfStudy));
  for (const SensorStudy& study : made.studies) {
    FORCEGATE_CHECK_OK(writer.write(request.output / ("sheet-" + study.sensor + ".html"),
                                    data_sheet_html(study, made.plan, request.command_line), kMarkOfPage));
    FORCEGATE_CHECK_OK(writer.write(request.output / ("sheet-" + study.sensor + ".json"),
                                    study_json({study}, made.plan, false), kMarkOfStudy));
    if (study.find("static.gain") != nullptr) {
      FORCEGATE_TRY(const std::string model, model_of_study(study));
      FORCEGATE_CHECK_OK(writer.write(request.output / (study.sensor + ".toml"), model, kMarkOfModel));
    }
    if (study.sheets.size() > kMostCalibrationFiles) continue;
    std::map<std::string, int> used;  // names that differ by letters alone which no file name has here
    for (const SessionSheet& sheet : study.sheets) {
      if (sheet.failure || sheet.find("static.gain") == nullptr) continue;
      std::string name = fmt::format("calibration-{}-{}-s{}", study.sensor, file_name_of(sheet.specimen), sheet.session);
      if (const int before = used[name]++; before > 0) name += fmt::format("-{}", before + 1);
      FORCEGATE_CHECK_OK(writer.write(request.output / (name + ".toml"), calibration_text(sheet), kMarkOfCalibration));
    }
    if (const auto both = sheet_of_both(study)) FORCEGATE_CHECK_OK(writer.write(request.output / ("calibration-" + study.sensor + "-identified.toml"), calibration_text(*both), kMarkOfCalibration));
  }
  return {};
}

Result<void> write_paper(const CharacterizeRequest& request, const Characterization& made, Writer& writer) {
  if (!request.paper.empty()) {
    const auto pictures = figures_of_the_paper(made.studies);
    for (const PaperPicture& p : pictures)
      FORCEGATE_CHECK_OK(writer.write(request.paper / "pictures" / "paper" / p.file,
                                      p.figure.svg(figures::Figure::Target::standalone)));
    FORCEGATE_CHECK_OK(writer.write(
        request.paper / "paper.md",
        paper_markdown(made.studies, made.plan, pictures, request.command_line, "pictures/paper")));
  }
  if (!request.golden.empty())
    for (const SensorStudy& study : made.studies)
      for (const GoldenTrace& trace : golden_traces(study, made.plan))
        FORCEGATE_CHECK_OK(writer.write(request.golden / (trace.name + ".csv"), golden_text(trace)));
  return {};
}

// Before hours of play: the emulated rig is asked for every specimen, which moves nothing.
Result<void> check_specimens(Rig& rig, const std::vector<std::string>& specimens) {
  for (const std::string& specimen : specimens) {
    RigRecordRequest probe;
    probe.specimen = specimen;
    probe.duration_s = 1.0;
    probe.force_high_N = 1.0;
    if (const auto begun = rig.begin(probe); !begun) return fail(ErrorCode::usage, begun.error().text, begun.error().where, begun.error().hint);
  }
  return {};
}

// A recording has the specimen, the session and the draw that it has, and only a session on a rig gives golden traces.
Result<void> check_beside_recordings(const CharacterizeRequest& request) {
  for (const auto& [given, option] : {std::pair<bool, const char*>{!request.specimens.empty(), "--specimen"},
                                      {request.sessions.has_value(), "--sessions"},
                                      {request.seed.has_value(), "--seed"},
                                      {!request.golden.empty(), "--golden"}})
    if (given)
      return fail(ErrorCode::usage, "this option is for a rig that plays, and recordings are characterised as they are", option,
                  fmt::format("leave {} out, or --record", option));
  return {};
}

Result<void> study_of_recordings(const CharacterizeRequest& request, characterize::BenchProgress& state, Characterization& out) {
  FORCEGATE_CHECK_OK(check_beside_recordings(request));
  if (!request.plan.empty()) {
    FORCEGATE_TRY(const fs::path path, find_plan(request.plan));
    FORCEGATE_TRY(characterize::StudyPlan plan, characterize::read_study_plan(path));
    out.plan.limits = std::move(plan.limits);
  }
  FORCEGATE_TRY(SensorStudy study, study_recordings(request, out.plan, state));
  out.studies.push_back(std::move(study));
  return {};
}

Result<void> study_rig(const CharacterizeRequest& request,
                       const std::function<void(double, std::string_view)>& progress,
                       characterize::BenchProgress& state, Characterization& out) {
  FORCEGATE_TRY(const fs::path path, find_plan(request.plan));
  FORCEGATE_TRY(out.plan, characterize::read_study_plan(path));
  if (request.seed) out.plan.seed = *request.seed;
  if (request.sessions) out.plan.sessions = *request.sessions;
  if (!request.specimens.empty()) {
    FORCEGATE_CHECK_OK(check_named_once(request.specimens));
    out.plan.specimens = request.specimens;
    out.plan.identification.assign(
        request.specimens.begin(),
        request.specimens.begin() + static_cast<std::ptrdiff_t>((request.specimens.size() + 1) / 2));
  }
  characterize::StudyRequest study;
  study.plan = out.plan;
  for (const std::string& sensor : request.sensors)
    if (!(sensor == "fsr" ? out.plan.fsr : out.plan.flexiforce).empty()) study.sensors.push_back(sensor);
  if (study.sensors.empty())
    return fail(ErrorCode::usage, "the plan has no procedure for this sensor", path.string());
  FORCEGATE_CHECK_OK(characterize::check_limit_keys(out.plan, study.sensors));
  study.make_rig = [&](const std::string& sensor) {
    auto options = request.rig_options;
    if (request.rig == "emulated") options["sensor"] = sensor;
    return make_rig(request.rig, options);
  };
  FORCEGATE_TRY(const auto probe, study.make_rig(study.sensors.front()));
  if (!probe->info().can_move)
    return fail(ErrorCode::usage, "rig '" + request.rig + "' cannot move a wheel", {},
                "give recordings: --rig replay --record FILE");
  if (!probe->info().emulated) {
    study.threads = 1;  // there is one bench
    study.plan.exemplar.clear();
  } else {
    study.threads = request.threads;
    // who names a specimen wants that one's pictures, and pays for no other
    study.first_is_exemplar = !request.specimens.empty();
    FORCEGATE_CHECK_OK(check_specimens(*probe, out.plan.specimens));
  }
  study.compensation = oracle_compensation;
  study.progress = progress;
  FORCEGATE_TRY(out.studies, characterize::run_study(study, state));
  return {};
}

}  // namespace

characterize::Compensation oracle_compensation(const Calibration& calibration) {
  struct State {
    LebosseOracle oracle;
    std::uint8_t flags = 0;
  };
  const auto state = std::make_shared<State>(State{LebosseOracle(calibration)});
  return {[state](std::uint16_t code) {
            const LebosseOracle::Output out = state->oracle.step(code);
            state->flags = out.flags;
            return out.force_N;
          },
          [state] { return (state->flags & kDutLearning) != 0; }};
}

const Error* Characterization::first_failure() const {
  for (const SensorStudy& s : studies)
    for (const SessionSheet& sheet : s.sheets)
      if (sheet.failure) return &*sheet.failure;
  for (const SensorStudy& s : studies)
    if (s.exemplar.failure) return &*s.exemplar.failure;
  return nullptr;
}

Result<Characterization> characterize_request(const CharacterizeRequest& request,
                                              const std::function<void(double, std::string_view)>& progress,
                                              const std::atomic<bool>* cancelled) {
  if (request.sensors.empty()) return fail(ErrorCode::usage, "no sensor is named");
  FORCEGATE_TRY(const ClaimedFolder folder, ClaimedFolder::take(request.output));
  FORCEGATE_CHECK_OK(check_output(request));
  Characterization out;
  characterize::BenchProgress state;
  state.cancelled = cancelled;
  if (!request.recordings.empty()) {
    FORCEGATE_CHECK_OK(study_of_recordings(request, state, out));
  } else {
    FORCEGATE_CHECK_OK(study_rig(request, progress, state, out));
  }
  bool sound = false;
  for (const SensorStudy& s : out.studies) {
    out.rig_time_s += s.rig_time_s;
    out.samples += s.samples;
    for (const SessionSheet& sheet : s.sheets) sound = sound || !sheet.failure;
  }
  if (const Error* first = out.first_failure(); !sound && first != nullptr) return Unexpected(*first);
  Writer writer(out.files, request.overwrite);
  FORCEGATE_CHECK_OK(write_output(request, out, writer));
  FORCEGATE_CHECK_OK(write_paper(request, out, writer));
  return out;
}

}  // namespace forcegate
