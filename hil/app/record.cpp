#include "hil/app/record.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "hil/app/gate.h"
#include "hil/base/text.h"

namespace forcegate {

Result<RecordResult> record(const RecordRequest& request, const RecordingProgress& progress,
                            const std::atomic<bool>* cancelled) {
  FORCEGATE_TRY(const std::filesystem::path path, find_plan(request.plan));
  FORCEGATE_TRY(const Plan plan, read_plan(path));
  std::vector<std::string> names;
  for (const PlanCase& c : plan.cases) names.push_back(c.name);
  for (const std::string& wanted : request.only_cases)
    if (std::find(names.begin(), names.end(), wanted) == names.end()) {
      const std::string near = nearest_name(wanted, names);
      return fail(ErrorCode::usage, "the plan has no case '" + printable_utf8(wanted) + "'", path.string(),
                  near.empty() ? "it has: " + join(names, ", ") : "did you mean '" + near + "'?");
    }
  std::vector<ProfileToRecord> profiles;
  for (const PlanCase& c : plan.cases) {
    if (!request.only_cases.empty() &&
        std::find(request.only_cases.begin(), request.only_cases.end(), c.name) == request.only_cases.end())
      continue;
    if (c.loop == LoopMode::closed)
      return fail(ErrorCode::usage, "a closed loop needs a firmware, and a recording has none", c.where,
                  "leave the case out with --case");
    profiles.push_back({c.name, c.stimulus, c.rest_before_s});
  }
  std::error_code error;
  if (std::filesystem::exists(request.output / "campaign.json", error))
    return fail(ErrorCode::usage, "there is a campaign already", request.output.string(),
                "choose another folder with -o");
  RecordingBench bench = request.bench;
  bench.safety = plan.safety;
  RecordResult out;
  out.folder = request.output;
  FORCEGATE_TRY(out.files, record_profiles(bench, profiles, request.output, progress, cancelled));
  for (const RecordedFile& f : out.files) out.rig_minutes += f.duration_s / 60.0;
  return out;
}

std::string record_json(const RecordResult& r) {
  nlohmann::ordered_json files = nlohmann::ordered_json::array();
  for (const RecordedFile& f : r.files)
    files.push_back({{"name", f.name}, {"file", f.file}, {"duration_s", f.duration_s}, {"rows", f.rows}});
  const nlohmann::ordered_json out = {
      {"format", 1}, {"folder", r.folder.string()}, {"rig_minutes", r.rig_minutes}, {"records", files}};
  return out.dump(2) + "\n";
}

}  // namespace forcegate
