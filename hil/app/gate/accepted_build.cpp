#include "hil/app/gate/accepted_build.h"

#include <algorithm>
#include <variant>

#include "hil/app/gate/bundle.h"
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

Result<AcceptedBuild> open_stored(const std::filesystem::path& path, const RunResult& head) {
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
  const auto differs = [&](const char* what, const std::string& theirs,
                           const std::string& ours) -> Result<void> {
    if (theirs == ours) return {};
    return fail(ErrorCode::usage,
                std::string("the stored run has another ") + what + ": " + printable_utf8(theirs),
                path.string(), "compare runs of one plan, seed and rig, or give the image itself");
  };
  FORCEGATE_CHECK_OK(differs("plan", build.run.plan_sha256, head.plan_sha256));
  FORCEGATE_CHECK_OK(differs("seed", std::to_string(build.run.seed), std::to_string(head.seed)));
  FORCEGATE_CHECK_OK(differs("rig", build.run.rig.name + "/" + build.run.rig.version,
                             head.rig.name + "/" + head.rig.version));
  // A bundle that this version does not read leaves the values.
  if (auto bundle = read_bundle(path.parent_path()))
    if (auto* const material = std::get_if<RunMaterial>(&bundle->material))
      for (PlayedRecord& one : material->records)
        if (!one.superseded) build.records[one.record.id] = std::move(one.record);
  return build;
}

}  // namespace

Result<AcceptedBuild> open_accepted(const GateRequest& request, const RunResult& head) {
  std::filesystem::path path = request.accepted;
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) path /= "result.json";
  if (!std::filesystem::is_regular_file(path, ignored))
    return fail(ErrorCode::usage, "there is no accepted build", path.string(),
                "--accepted takes an image, a run's folder or its result.json");
  if (!some_lane_runs(path)) return open_stored(path, head);
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
    const auto at = build.records.find(id);
    const CaseRecord* const accepted = build.stored ? at != build.records.end() ? &at->second : nullptr : pair.accepted;
    if (accepted != nullptr) {
      const JudgedCase judged = judge_case(plan, *pair.planned, *accepted, limits);  // its rig is asked as the candidate's is
      std::vector<Check> checks;
      for (const JudgedCheck& j : judged.checks) checks.push_back(j.check);
      some = error_increases(plan, *pair.planned, *pair.candidate, *accepted, no_partner(id, checks, build.stored));
    } else if (!build.stored) {
      some = error_increases(plan, *pair.planned, *pair.candidate, CaseRecord{});
    } else {
      const auto theirs = std::find_if(build.run.cases.begin(), build.run.cases.end(), [&](const CaseResult& c) { return c.id == id; });
      const bool there = theirs != build.run.cases.end();
      if (!there && id.find("/session") != std::string::npos) continue;
      some = error_increases(*pair.planned, id, *pair.judged, there ? *theirs : CaseResult{}, rig_repeats);
    }
    for (ErrorIncrease& e : some) all.push_back(std::move(e));
  }
  return judge_no_worse(plan, all, rig_repeats);
}

}  // namespace forcegate
