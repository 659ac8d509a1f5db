#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "adapters/link/image.h"
#include "hil/app/files/find_plan.h"
#include "hil/app/files/named_once.h"
#include "hil/app/gate/gate_jobs.h"
#include "hil/app/gate/same_profile.h"
#include "hil/app/gate/wire_faults.h"
#include "hil/base/text.h"
#include "hil/gate/board_faults.h"
#include "hil/gate/calibrate.h"
#include "hil/interface/dut.h"
#include "hil/rig/bench_file.h"

namespace forcegate {
namespace {

// Twice the same specimen is one piece of evidence, and u of the panel's mean would shrink all the same.
Result<void> select_panel(const GateRequest& request, Plan& plan) {
  if (request.panel.empty()) return {};
  FORCEGATE_CHECK_OK(check_named_once(request.panel));
  plan.panel = request.panel;
  for (PlanCase& c : plan.cases) c.specimens.clear();
  return {};
}

// What the plan asks for beyond what is played: an acceptance of a part is none of the plan.
std::string left_out_of(const Plan& whole, const Plan& played) {
  const auto records_of = [](const Plan& plan) {
    std::set<std::pair<std::string, std::string>> out;
    for (const PlanCase& c : plan.cases)
      for (const std::string& specimen : specimens_of(plan, c)) out.emplace(c.name, specimen);
    return out;
  };
  const auto of_plan = records_of(whole), of_run = records_of(played);
  const auto records = static_cast<std::size_t>(std::ranges::count_if(of_run, [&](const auto& one) { return of_plan.contains(one); }));
  std::vector<std::string> missing, other;
  const auto names = [](const Plan& plan) {
    std::set<std::string> out;
    for (const PlanCase& c : plan.cases) out.insert(specimens_of(plan, c).begin(), specimens_of(plan, c).end());
    return out;
  };
  const std::set<std::string> asked = names(whole), given = names(played);
  std::ranges::set_difference(asked, given, std::back_inserter(missing));
  std::ranges::set_difference(given, asked, std::back_inserter(other));
  if (of_run == of_plan) return {};
  std::string out = fmt::format("{} of {} cases and {} of {} records of the plan are played", played.cases.size(), whole.cases.size(), records, of_plan.size());
  if (records < of_plan.size()) out += ": what else it asks for was not judged";
  if (of_run.size() > records) out += fmt::format("; records beside it: {}", of_run.size() - records);
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
    return fail(ErrorCode::usage, "a recording cannot be calibrated: nothing is played", "--calibration",
                "give the calibration of the specimen with --cal FILE; its level is in there");
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

Result<void> choose_level(const GateRequest& request, Plan& plan, bool can_move) {
  if (!request.level) return {};
  if (can_move && !request.calibration_file.empty())
    return fail(ErrorCode::usage, "a calibration is given (--cal), and how far to calibrate would say nothing: its level is in its file", "--calibration",
                "leave out --calibration, or leave out --cal and the specimens are calibrated that far");
  plan.calibration.level = *request.level;
  if (*request.level == CalibrationLevel::identified && !plan.calibration.identification)
    return fail(ErrorCode::usage, "this plan cannot identify a specimen", plan.path.string(),
                "it has no [calibration.identification]");
  return {};
}

// Cases and panel that the request chooses, and what of the plan is not played.
Result<void> select_from_plan(const GateRequest& request, GateSetup& setup) {
  const Plan whole = setup.plan;
  for (const PlanCase& c : whole.cases) setup.number_of_case.emplace(c.name, setup.number_of_case.size() + 1);
  FORCEGATE_CHECK_OK(select_panel(request, setup.plan));
  if (!request.goldens.empty()) {
    setup.plan.limits.goldens = std::filesystem::absolute(request.goldens).lexically_normal().string();
    for (PlanCase& c : setup.plan.cases) c.checks |= kCheckGolden;
  }
  if (const auto said = setup.rig.details.find("notes"); said != setup.rig.details.end())
    setup.notes.push_back("of the recording: " + said->second);
  FORCEGATE_CHECK_OK(select_cases(request, setup.plan));
  // Of a recording --specimen says which one was pressed.
  const bool chooses = setup.rig.can_move || !request.only_cases.empty();
  if (const std::string left_out = chooses ? left_out_of(whole, setup.plan) : std::string(); !left_out.empty())
    setup.notes.push_back(left_out);
  return select_lanes(request, setup);
}

// What the file of a bench or a recording does not tell counts as exact, and a decision near a limit then says more than is known.
void note_unstated_reference(GateSetup& setup) {
  const bool judged = std::ranges::any_of(setup.plan.cases, [](const PlanCase& c) { return (c.checks & (kCheckAccuracy | kCheckPromise)) != 0; });
  if (!judged || setup.rig.reference_u_rel > 0.0 || setup.plan.uncertainty.reference_rel > 0.0) return;
  setup.notes.push_back(std::string("the uncertainty of the ATI's calibration counts as 0: ") + (setup.rig.can_move ? "neither the bench's file nor the plan states it" : "a recording does not state it, nor does the plan") +
                        "; declare it: reference_rel in [uncertainty] of a plan (--plan), relative, k = 1, for example 0.005" +
                        (setup.rig.can_move ? ", or u_rel of the bench's reference" : ""));
}

// Its date is not looked after, so nothing would refuse it when it is out of date.
void note_undated_reference(GateSetup& setup) {
  if (const auto said = setup.rig.details.find(kReferenceCalibrationRemark); said != setup.rig.details.end())
    setup.notes.push_back(said->second + "; see reference = { id, expires } under [calibration] of the bench's file");
}

// A wrong option is told before anything is played.
Result<void> check_lane_options(const GateRequest& request, const std::string& name) {
  const LaneKind* lane = Registry<LaneKind>::instance().find(name);
  if (lane != nullptr && !request.lane_options.empty()) FORCEGATE_CHECK_OK(lane->make(request.lane_options));
  return {};
}

void drop_replaced_limits(const GateRequest& request, Plan& plan) {
  if (request.limits_file.empty() && !request.without_limits) return;
  for (PlanCase& c : plan.cases)
    if (c.loop == LoopMode::open) c.maxima_pct = c.minima_pct = std::nullopt;
}

Result<void> every_case_has_checks(const Plan& plan) {
  for (const PlanCase& c : plan.cases)
    if (c.checks == 0)
      return fail(ErrorCode::config, "case '" + c.name + "' asks for no check: nothing would judge its forces",
                  c.where.empty() ? plan.path.string() : c.where,
                  "add checks = [\"accuracy\"] (docs/plan.md), or leave the case out (--case)");
  return {};
}

std::vector<std::string> all_specimens(const Plan& plan) {
  std::vector<std::string> out;
  for (const PlanCase& c : plan.cases)
    for (const std::string& specimen : specimens_of(plan, c))
      if (std::find(out.begin(), out.end(), specimen) == out.end()) out.push_back(specimen);
  return out;
}

// Told of another sensor's gain a good build is wrong by as much, and nothing but luck keeps that apart from a bad one.
Result<void> check_one_specimen(const GateRequest& request, const GateSetup& setup) {
  if (!setup.rig.can_move || request.calibration_file.empty() || setup.specimens.size() < 2) return {};
  return fail(ErrorCode::usage, fmt::format("a calibration is of one specimen, and {} would be judged by it: {}", setup.specimens.size(), join(setup.specimens, ", ")),
              request.calibration_file.string(),
              "name the one that it was measured on with --specimen; without --cal each is calibrated before it is judged");
}

// Unknown faults and specimens are mistakes of the request, not of the rig: the rig itself is asked.
Result<void> check_faults_and_specimens(const GateRequest& request, const GateSetup& setup, Rig& rig) {
  FORCEGATE_CHECK_OK(check_wire_faults(request, setup.plan, calibrates(request, setup)));
  if (auto known = check_board_faults(request.faults); !known)
    return fail(ErrorCode::usage, known.error().text, known.error().where, known.error().hint);
  if (!setup.rig.can_move) {
    if (rig_faults(request.faults).empty()) return {};
    return fail(ErrorCode::usage, "faults cannot be injected into a recording", "--fault", "leave it out, or use --rig emulated");
  }
  for (const std::string& specimen : setup.specimens) {
    RigRecordRequest probe;
    probe.specimen = specimen;
    probe.duration_s = 1.0;
    probe.force_high_N = 1.0;
    probe.faults = rig_faults(request.faults);
    auto begun = setup.rig.name == "emulated" ? rig.begin(probe) : Result<void>{};
    if (!begun) return fail(ErrorCode::usage, begun.error().text, begun.error().where, begun.error().hint);
  }
  return {};
}

}  // namespace

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
  // before specimens are calibrated for it
  if (const auto image = link::inspect_image(request.firmware)) FORCEGATE_CHECK_OK(link::check_whole(*image, request.firmware.string()));
  FORCEGATE_TRY(const std::filesystem::path plan_path, find_plan(request.plan));
  FORCEGATE_TRY(setup.plan, read_plan(plan_path));
  setup.rig = rig->info();
  if (calibration) {
    FORCEGATE_TRY(setup.calibration, calibration_on(setup.rig, *calibration));
  }
  Plan& plan = setup.plan;
  if (request.seed) plan.seed = *request.seed;
  FORCEGATE_CHECK_OK(choose_level(request, plan, setup.rig.can_move));
  FORCEGATE_CHECK_OK(select_from_plan(request, setup));
  FORCEGATE_CHECK_OK(check_lane_options(request, setup.lane));
  drop_replaced_limits(request, plan);
  // A board that converts by itself cannot be given codes that no rig makes.
  if (setup.lane == rig->board_lane())
    for (PlanCase& c : plan.cases) c.prelude_s = 0.0;
  if (!setup.rig.can_move) FORCEGATE_CHECK_OK(take_recording(request, plan));
  FORCEGATE_CHECK_OK(every_case_has_checks(plan));
  note_unstated_reference(setup);
  note_undated_reference(setup);
  setup.specimens = all_specimens(plan);
  FORCEGATE_CHECK_OK(check_one_specimen(request, setup));
  FORCEGATE_CHECK_OK(check_faults_and_specimens(request, setup, *rig));
  return setup;
}

}  // namespace forcegate
