#include "hil/app/gate/accepted_build.h"

#include <fmt/format.h>

#include <algorithm>
#include <variant>

#include "hil/app/gate/bundle.h"
#include "hil/app/gate/same_conditions.h"
#include "hil/base/digest.h"
#include "hil/base/rng.h"
#include "hil/base/text.h"
#include "hil/gate/judge.h"
#include "hil/interface/dut.h"
#include "hil/report/result_json.h"

namespace forcegate {
namespace {

bool some_lane_runs(const std::filesystem::path& image) {
  for (const LaneKind& lane : Registry<LaneKind>::instance().all())
    if (lane.accepts(image)) return true;
  return false;
}

Result<AcceptedBuild> open_stored(const std::filesystem::path& path, const GateRequest& request, const GateSetup* setup, const RunResult& head) {
  AcceptedBuild build;
  build.path = path.string();
  build.stored = true;
  auto run = read_result(path);
  if (!run)
    return fail(
        ErrorCode::usage,
        "the accepted build is neither an image that a lane can run nor a stored run: " + run.error().text,
        path.string(), "give an ELF image, or the result.json of its run");
  build.run = std::move(*run);
  build.sha256 = build.run.firmware_sha256;
  FORCEGATE_CHECK_OK(check_same_conditions(build.run, head, request, setup, path));
  // A bundle that this version does not read leaves the values.
  auto bundle = read_bundle(path.parent_path());
  auto* const material = bundle ? std::get_if<RunMaterial>(&bundle->material) : nullptr;
  if (material == nullptr || setup == nullptr) return build;
  for (PlayedRecord& one : material->records) {
    const auto number = setup->number_of_case.find(one.job.planned.name);
    if (setup->rig.name == "emulated" && number != setup->number_of_case.end() && number->second != one.job.record)
      return fail(ErrorCode::usage, "the stored run drew the noise of " + one.job.id + " by another number, as a version did that counted the cases of --case alone",
                  path.string(), "play it again, or give the image itself");
    if (!one.superseded) build.records[one.record.id] = std::move(one.record);
  }
  return build;
}

// The emulated rig measures the same calibration again: another one, of a file, makes other records of the same build.
NoPartner other_calibration(const std::string& record, const Calibration& ours, const Calibration& theirs) {
  const std::string what = calibration_difference(theirs, ours);
  if (what.empty()) return {};
  return {Verdict::not_run, Blame::user, fmt::format("the accepted build's record of {} has another calibration: {}", record, what)};
}

}  // namespace

Result<AcceptedBuild> open_accepted(const GateRequest& request, const GateSetup* setup, const RunResult& head) {
  std::filesystem::path path = request.accepted;
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) path /= "result.json";
  if (!std::filesystem::is_regular_file(path, ignored))
    return fail(ErrorCode::usage, "there is no accepted build", path.string(),
                "--accepted takes an image, a run's folder or its result.json");
  if (!some_lane_runs(path)) return open_stored(path, request, setup, head);
  AcceptedBuild build;
  build.path = std::filesystem::absolute(path).string();
  FORCEGATE_TRY(build.sha256, sha256_file(path));
  return build;
}

std::string accepted_note(const AcceptedBuild& build) {
  std::string out = "accepted build: " + build.path + " (sha256 " + build.sha256.substr(0, 12) + ")";
  const Decision& own = build.run.decision;
  if (build.stored && own.kind != DecisionKind::accept)
    out += ", which its own gate did not accept: " + std::string(to_string(own.kind)) + (own.reason.empty() ? "" : ", " + own.reason) +
           ". To be no worse than it is no merit";
  return out;
}

CaseJob accepted_job(const CaseJob& job, const AcceptedBuild& build) {
  CaseJob twin = job;
  twin.image = build.path;
  twin.keep_path.clear();
  twin.curves = false;
  twin.nonce =
      static_cast<std::uint32_t>(mix_seed(job.seed, build.sha256 + "/accepted/" + job.id) & 0xFFFFFFFFu);
  twin.lane = accepted_lane(job.lane, build);
  return twin;
}

std::string accepted_lane(const std::string& own, const AcceptedBuild& build) {
  const auto& lanes = Registry<LaneKind>::instance();
  if (const LaneKind* lane = lanes.find(own); lane != nullptr && lane->accepts(build.path)) return own;
  for (const LaneKind& lane : lanes.all())
    if (lane.accepts(build.path)) return lane.name;
  return own;
}

std::vector<JudgedCheck> compare_with_accepted(const Plan& plan, const DerivedLimits& limits, const AcceptedBuild& build, bool rig_repeats,
                                               std::span<const ComparedRecord> pairs) {
  std::vector<ErrorIncrease> all;
  for (const ComparedRecord& pair : pairs) {
    std::vector<ErrorIncrease> some;
    const std::string& id = pair.candidate->id;
    const auto calibration_of = [&](const Calibration& theirs) {
      return build.stored && build.run.rig.name == "emulated" ? other_calibration(id, pair.candidate->calibration, theirs) : NoPartner{};
    };
    const auto at = build.records.find(id);
    const CaseRecord* const accepted = build.stored ? at != build.records.end() ? &at->second : nullptr : pair.accepted;
    if (accepted != nullptr) {
      const JudgedCase judged = judge_case(plan, *pair.planned, *accepted, limits);  // its rig is asked as the candidate's is
      std::vector<Check> checks;
      for (const JudgedCheck& j : judged.checks) checks.push_back(j.check);
      NoPartner partner = no_partner(id, checks, build.stored);
      if (partner.verdict == Verdict::pass) partner = calibration_of(accepted->calibration);
      some = error_increases(plan, *pair.planned, *pair.candidate, *accepted, partner);
    } else if (!build.stored) {
      some = error_increases(plan, *pair.planned, *pair.candidate, CaseRecord{});
    } else {
      const auto theirs = std::find_if(build.run.cases.begin(), build.run.cases.end(), [&](const CaseResult& c) { return c.id == id; });
      const bool there = theirs != build.run.cases.end();
      if (!there && id.find("/session") != std::string::npos) continue;
      const NoPartner partner = there && theirs->samples > 0 ? calibration_of(theirs->calibration) : NoPartner{};
      some = partner.verdict == Verdict::pass ? error_increases(*pair.planned, id, *pair.judged, there ? *theirs : CaseResult{}, rig_repeats)
                                              : error_increases(plan, *pair.planned, *pair.candidate, CaseRecord{}, partner);
    }
    for (ErrorIncrease& e : some) all.push_back(std::move(e));
  }
  return judge_no_worse(plan, all, rig_repeats);
}

}  // namespace forcegate
