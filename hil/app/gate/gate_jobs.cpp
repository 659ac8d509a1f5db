#include "hil/app/gate/gate_jobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "hil/app/files/find_plan.h"
#include "hil/app/gate/same_profile.h"
#include "hil/app/gate/wire_faults.h"
#include "hil/base/digest.h"
#include "hil/base/rng.h"
#include "hil/base/text.h"
#include "hil/gate/board_faults.h"
#include "hil/gate/calibrate.h"
#include "hil/interface/dut.h"

namespace forcegate {
namespace {

// Twice the same specimen is one piece of evidence, and u of the panel's mean would shrink all the same.
Result<void> select_panel(const GateRequest& request, Plan& plan) {
  if (request.panel.empty()) return {};
  std::set<std::string> seen;
  for (const std::string& specimen : request.panel)
    if (!seen.insert(specimen).second)
      return fail(ErrorCode::usage, fmt::format("specimen '{}' is named twice", printable_utf8(specimen)), "--specimen", "name every specimen once");
  plan.panel = request.panel;
  for (PlanCase& c : plan.cases) c.specimens.clear();
  return {};
}

// What the plan asks for beyond what is played: an acceptance of a part is none of the plan.
std::string left_out_of(const Plan& whole, const Plan& played) {
  std::size_t records = 0, of_records = 0;
  for (const PlanCase& c : played.cases) records += specimens_of(played, c).size();
  for (const PlanCase& c : whole.cases) of_records += specimens_of(whole, c).size();
  std::vector<std::string> missing, other;
  const auto names = [](const Plan& plan) {
    std::set<std::string> out;
    for (const PlanCase& c : plan.cases) out.insert(specimens_of(plan, c).begin(), specimens_of(plan, c).end());
    return out;
  };
  const std::set<std::string> asked = names(whole), given = names(played);
  std::ranges::set_difference(asked, given, std::back_inserter(missing));
  std::ranges::set_difference(given, asked, std::back_inserter(other));
  if (records == of_records && played.cases.size() == whole.cases.size() && missing.empty() && other.empty()) return {};
  std::string out = fmt::format("{} of {} cases and {} of {} records of the plan are played: what else it asks for was not judged", played.cases.size(),
                                whole.cases.size(), records, of_records);
  if (!missing.empty()) out += "; specimens left out: " + join(missing, ", ");
  if (!other.empty()) out += "; specimens that the plan does not name: " + join(other, ", ");
  return out;
}

Result<void> select_cases(const GateRequest& request, Plan& plan) {
  if (request.only_cases.empty()) return {};
  std::vector<std::string> names;
  for (const PlanCase& c : plan.cases) names.push_back(c.name);
  FORCEGATE_CHECK_OK(known_cases(request.only_cases, names, plan.path.string()));
  std::erase_if(plan.cases, [&](const PlanCase& c) {
    return std::find(request.only_cases.begin(), request.only_cases.end(), c.name) ==
           request.only_cases.end();
  });
  return {};
}

// Cases of a lane of their own are for images that run there. The one given on the command line is for all.
Result<void> select_lanes(const GateRequest& request, GateSetup& setup) {
  std::vector<std::string> left_out;
  std::erase_if(setup.plan.cases, [&](PlanCase& c) {
    if (c.lane.empty() || !request.lane.empty()) {
      c.lane = setup.lane;
      return false;
    }
    const LaneKind* lane = Registry<LaneKind>::instance().find(c.lane);
    if (lane != nullptr && lane->accepts(request.firmware)) return false;
    left_out.push_back(c.name + " (" + c.lane + ")");
    return true;
  });
  if (setup.plan.cases.empty())
    return fail(ErrorCode::usage, "no case of this plan is for this image", setup.plan.path.string(),
                "its cases want another lane: " + join(left_out, ", "));
  if (!left_out.empty())
    setup.notes.push_back("not played, the image is not built for the lane: " + join(left_out, ", "));
  return {};
}

// The profile of a recording is its own force channel.
Result<void> take_profile_of_recording(const GateRequest& request, bool any_profile, PlanCase& planned) {
  const auto path = request.rig_options.find("record");
  if (path == request.rig_options.end())
    return {};  // another rig that cannot move: the plan's profile stands
  StimulusSpec spec;
  spec.name = "replay";
  spec.texts["path"] = path->second;
  if (const auto map = request.rig_options.find("map"); map != request.rig_options.end()) spec.texts["map"] = map->second;
  auto made = make_stimulus(spec);
  if (!made) return fail(ErrorCode::usage, made.error().text, made.error().where, made.error().hint);
  const auto of_plan = make_stimulus(planned.stimulus);
  if (const std::string what = of_plan && !any_profile ? other_profile(**of_plan, **made) : std::string(); !what.empty())
    return fail(ErrorCode::usage, "this is no recording of the case '" + planned.name + "': " + what, path->second,
                "choose the case that was played with --case, or judge it as it is: --plan replay");
  planned.stimulus = std::move(spec);
  return {};
}

// A recording is one record of one specimen, and so one case of a plan.
Result<void> take_recording(const GateRequest& request, Plan& plan) {
  constexpr const char* kAnyProfile = "recorded";  // source of the case that takes a recording as it is
  if (request.panel.size() > 1)
    return fail(ErrorCode::usage, fmt::format("a recording is of one specimen, not of {}", request.panel.size()), "--specimen", "name the one that was pressed");
  if (request.level && (*request.level != CalibrationLevel::nominal || !request.calibration_file.empty()))
    return fail(ErrorCode::usage, "a recording cannot be calibrated: nothing is played", "--calibration", "give the calibration of the specimen with --cal FILE; its level is in there");
  std::erase_if(plan.cases, [](const PlanCase& c) { return c.loop == LoopMode::closed; });
  if (plan.cases.empty())
    return fail(ErrorCode::usage, "a recording cannot play a closed loop", plan.path.string(), "use a plan with an open-loop case, for example --plan replay");
  if (plan.cases.size() > 1) {
    std::vector<std::string> names;
    for (const PlanCase& c : plan.cases) names.push_back(c.name);
    return fail(ErrorCode::usage, fmt::format("a recording is one case, and this plan has {}", names.size()), plan.path.string(),
                "choose the one that was played with --case (" + join(names, ", ") + "), or judge it as it is: --plan replay");
  }
  plan.panel = {request.panel.empty() ? std::string("recorded") : request.panel.front()};
  plan.cases.front().specimens.clear();
  return take_profile_of_recording(request, plan.cases.front().source == kAnyProfile, plan.cases.front());
}

// What the command line says of the converter of a recording stands, for the rig and for the firmware.
void take_converter(CalibrationFile& calibration, GateRequest& request, GateSetup& setup) {
  const auto take = [&](const std::string& key, auto& stated, const std::string& value) {
    const auto [at, added] = request.rig_options.emplace(key, value);
    if (added) return;
    stated.reset();
    if (at->second != value)
      setup.notes.push_back(fmt::format("{} = {} as --rig-option says; the calibration states {}", key, printable_utf8(at->second), value));
  };
  if (calibration.adc_bits) take("adc_bits", calibration.adc_bits, std::to_string(*calibration.adc_bits));
  if (calibration.v_range_V) take("v_range_V", calibration.v_range_V, shortest(*calibration.v_range_V));
}

CaseJob common_job(const GateRequest& request, const GateSetup& setup, const std::string& specimen) {
  CaseJob job;
  job.rig = request.rig;
  job.rig_options = request.rig_options;
  job.specimen = specimen;
  job.seed = setup.plan.seed;
  job.session = 0;
  job.safety = setup.plan.safety;
  return job;
}

std::string session_suffix(std::uint64_t session) {
  return session == 0 ? std::string() : fmt::format("/session{}", session + 1);
}

// `transient` = n: only the first n attempts at a record have the faults.
std::map<std::string, double> faults_of_attempt(const std::map<std::string, double>& faults, int attempt) {
  const auto transient = faults.find("transient");
  if (transient != faults.end() && attempt > transient->second) return {};
  return faults;
}

}  // namespace

bool plays_on_one_bench(const GateRequest& request, const GateSetup& setup) {
  return request.rig == "bench" && (!setup.rig.emulated || request.rig_options.contains("attach"));
}

bool plays_only_once(const GateRequest& request, const GateSetup& setup) {
  if (plays_on_one_bench(request, setup)) return true;
  const auto given = request.rig_options.find("clock");
  const auto own = setup.rig.details.find("clock");
  const std::string clock = given != request.rig_options.end() ? given->second : own != setup.rig.details.end() ? own->second : "";
  return request.rig == "bench" && clock == "paced";
}

RunResult run_head(const GateRequest& request, const std::string& firmware_sha256, const std::string& lane) {
  RunResult head;
  head.tool_version = FORCEGATE_VERSION;
  head.command_line = request.command_line;
  head.started_at = request.started_at;
  head.firmware_path = request.firmware.string();
  head.firmware_sha256 = firmware_sha256;
  head.environment["compiler"] = "GCC " __VERSION__;
  head.environment["lane"] = lane;
  return head;
}

Result<void> known_cases(const std::vector<std::string>& wanted, const std::vector<std::string>& known,
                         const std::string& where) {
  for (const std::string& name : wanted)
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      const std::string near = nearest_name(name, known);
      return fail(ErrorCode::usage, "the plan has no case '" + printable_utf8(name) + "'", where,
                  near.empty() ? "it has: " + join(known, ", ") : "did you mean '" + near + "'?");
    }
  return {};
}

Result<std::string> image_sha256(const std::filesystem::path& image) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(image, ignored))
    return fail(ErrorCode::usage, "there is no firmware file", image.string(),
                "build the images first (./ci/build) or mend the path");
  return sha256_file(image);
}

Result<std::string> choose_lane(const GateRequest& request, const std::string& board_lane) {
  const auto& lanes = Registry<LaneKind>::instance();
  if (!board_lane.empty() && (request.lane.empty() || request.lane == board_lane)) return board_lane;
  if (!request.lane.empty()) {
    const LaneKind* lane = lanes.find(request.lane);
    if (lane == nullptr) {
      const std::string near = nearest_name(request.lane, lanes.names());
      return fail(
          ErrorCode::usage, "there is no lane named '" + printable_utf8(request.lane) + "'", {},
          near.empty() ? "choose one of: " + join(lanes.names(), ", ") : "did you mean '" + near + "'?");
    }
    if (!lane->accepts(request.firmware))
      return fail(ErrorCode::usage, "lane '" + request.lane + "' cannot run this image",
                  request.firmware.string(), lane->doc);
    return lane->name;
  }
  for (const LaneKind& lane : lanes.all())
    if (lane.accepts(request.firmware)) return lane.name;
  return fail(ErrorCode::usage, "this is no firmware image that any lane can run",
              request.firmware.string(),
              "give an ELF image built for one of the ports: " + join(lanes.names(), ", "));
}

Result<GateSetup> prepare_gate(GateRequest& request) {
  GateSetup setup;
  FORCEGATE_TRY(setup.firmware_sha256, image_sha256(request.firmware));
  std::optional<CalibrationFile> calibration;
  if (!request.calibration_file.empty()) {
    FORCEGATE_TRY(calibration, read_calibration_file(request.calibration_file));
    if (request.rig == "replay") take_converter(*calibration, request, setup);
  }
  FORCEGATE_TRY(const auto rig, make_rig(request.rig, request.rig_options));
  FORCEGATE_TRY(setup.lane, choose_lane(request, rig->board_lane()));
  FORCEGATE_TRY(const std::filesystem::path plan_path, find_plan(request.plan));
  FORCEGATE_TRY(setup.plan, read_plan(plan_path));
  setup.rig = rig->info();
  if (calibration) {
    FORCEGATE_TRY(setup.calibration, calibration_on(setup.rig, *calibration));
  }
  Plan& plan = setup.plan;
  if (request.seed) plan.seed = *request.seed;
  if (request.level) {
    plan.calibration.level = *request.level;
    if (*request.level == CalibrationLevel::identified && !plan.calibration.identification)
      return fail(ErrorCode::usage, "this plan cannot identify a specimen", plan.path.string(),
                  "it has no [calibration.identification]");
  }
  const Plan whole = plan;
  for (const PlanCase& c : plan.cases) setup.number_of_case.emplace(c.name, setup.number_of_case.size() + 1);
  FORCEGATE_CHECK_OK(select_panel(request, plan));
  if (!request.goldens.empty()) {
    plan.limits.goldens = std::filesystem::absolute(request.goldens).lexically_normal().string();
    for (PlanCase& c : plan.cases) c.checks |= kCheckGolden;
  }
  if (const auto said = setup.rig.details.find("notes"); said != setup.rig.details.end())
    setup.notes.push_back("of the recording: " + said->second);
  FORCEGATE_CHECK_OK(select_cases(request, plan));
  // Of a recording --specimen says which one was pressed.
  if (const std::string left_out = setup.rig.can_move || !request.only_cases.empty() ? left_out_of(whole, plan) : std::string(); !left_out.empty())
    setup.notes.push_back(left_out);
  FORCEGATE_CHECK_OK(select_lanes(request, setup));
  // a wrong option is told before anything is played
  if (const LaneKind* lane = Registry<LaneKind>::instance().find(setup.lane); lane != nullptr && !request.lane_options.empty())
    FORCEGATE_CHECK_OK(lane->make(request.lane_options));
  if (!request.limits_file.empty() || request.without_limits)
    for (PlanCase& c : plan.cases)
      if (c.loop == LoopMode::open) c.maxima_pct = c.minima_pct = std::nullopt;
  // A board that converts by itself cannot be given codes that no rig makes.
  if (setup.lane == rig->board_lane())
    for (PlanCase& c : plan.cases) c.prelude_s = 0.0;
  if (!setup.rig.can_move) FORCEGATE_CHECK_OK(take_recording(request, plan));
  for (const PlanCase& c : plan.cases)
    if (c.checks == 0)
      return fail(ErrorCode::config, "case '" + c.name + "' asks for no check: nothing would judge its forces", c.where.empty() ? plan.path.string() : c.where,
                  "add checks = [\"accuracy\"] (docs/plan.md), or leave the case out (--case)");
  for (const PlanCase& c : plan.cases)
    for (const std::string& specimen : specimens_of(plan, c))
      if (std::find(setup.specimens.begin(), setup.specimens.end(), specimen) == setup.specimens.end())
        setup.specimens.push_back(specimen);
  FORCEGATE_CHECK_OK(check_wire_faults(request, setup.plan, calibrates(request, setup)));
  if (auto known = check_board_faults(request.faults); !known)
    return fail(ErrorCode::usage, known.error().text, known.error().where, known.error().hint);
  // Unknown faults and specimens are mistakes of the request, not of the rig: the rig itself is asked.
  if (setup.rig.can_move)
    for (const std::string& specimen : setup.specimens) {
      RigRecordRequest probe;
      probe.specimen = specimen;
      probe.duration_s = 1.0;
      probe.force_high_N = 1.0;
      probe.faults = rig_faults(request.faults);
      auto begun = setup.rig.name == "emulated" ? rig->begin(probe) : Result<void>{};
      if (!begun) return fail(ErrorCode::usage, begun.error().text, begun.error().where, begun.error().hint);
    }
  else if (!rig_faults(request.faults).empty())
    return fail(ErrorCode::usage, "faults cannot be injected into a recording", "--fault", "leave it out, or use --rig emulated");
  return setup;
}

bool calibrates(const GateRequest& request, const GateSetup& setup) {
  return setup.rig.can_move && request.calibration_file.empty() &&
         setup.plan.calibration.level != CalibrationLevel::nominal;
}

CaseJob calibration_job(const GateRequest& request, const GateSetup& setup, const std::string& specimen,
                        std::uint64_t session, int attempt) {
  CaseJob job = common_job(request, setup, specimen);
  job.kind = CaseJob::Kind::calibration;
  job.id = "calibration/" + specimen + session_suffix(session);
  job.session = session;
  job.attempt = attempt;
  job.calibrate = setup.plan.calibration;
  return job;
}

CaseJob record_job(const GateRequest& request, const GateSetup& setup, std::size_t case_index,
                   const std::string& specimen, std::uint64_t session, int attempt,
                   const Calibration& calibration) {
  const PlanCase& planned = setup.plan.cases[case_index];
  const auto& specimens = specimens_of(setup.plan, planned);
  CaseJob job = common_job(request, setup, specimen);
  job.id = planned.name + "/" + specimen + session_suffix(session);
  job.lane = planned.lane;
  job.lane_options = request.lane_options;
  job.image = std::filesystem::absolute(request.firmware).string();
  job.planned = planned;
  // One record stands for its case; what cannot be played again is drawn in any case. Without a folder there is no report.
  const bool stands = session == 0 && specimen == specimens[specimens.size() / 2];
  job.curves = (stands && !request.output.empty()) || !setup.rig.emulated;
  job.session = session;
  job.attempt = attempt;
  job.record = setup.number_of_case.at(planned.name);
  job.nonce = static_cast<std::uint32_t>(
      mix_seed(job.seed, fmt::format("{}/{}/{}", setup.firmware_sha256, job.id, attempt)) & 0xFFFFFFFFu);
  job.faults = faults_of_attempt(request.faults, attempt);
  job.calibration = calibration;
  job.calibration_given = !calibrates(request, setup);
  return job;
}

double rig_time_s(const CaseJob& job) {
  const auto duration_s = [](const StimulusSpec& spec) {
    const auto made = make_stimulus(spec);
    return made ? (*made)->duration_s() : 0.0;
  };
  if (job.kind == CaseJob::Kind::record) return duration_s(job.planned.stimulus);
  double t_s = job.calibrate.sweep_s * job.calibrate.sweeps;
  if (job.calibrate.level == CalibrationLevel::identified)
    t_s += duration_s(job.calibrate.identification->stimulus);
  return t_s;
}

}  // namespace forcegate
