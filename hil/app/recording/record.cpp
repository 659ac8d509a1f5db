#include "hil/app/recording/record.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "hil/app/files/find_plan.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

namespace fs = std::filesystem;

/// How many of the profiles the campaign begins with; none where it is another one: other profiles, specimen, seed or rate.
std::size_t recorded_of(const fs::path& list, const std::vector<ProfileToRecord>& profiles, const RecordingBench& bench) {
  std::ifstream file(list, std::ios::binary);
  const auto json = nlohmann::json::parse(file, nullptr, false, true);
  if (!json.is_object() || !json.contains("records") || !json["records"].is_array() || json["records"].size() > profiles.size()) return 0;
  const std::vector<std::pair<const char*, nlohmann::json>> wanted = {{"seed", bench.seed}, {"session", bench.session}, {"rate_Hz", bench.rate_Hz}};
  for (const auto& [name, value] : wanted)
    if (!json.contains("recorded_with") || json["recorded_with"].value(name, nlohmann::json()) != value) return 0;
  const auto sensor = json.value("sensor", nlohmann::json());
  if (!sensor.is_string() || !sensor.get<std::string>().ends_with(", specimen " + bench.specimen)) return 0;
  for (std::size_t k = 0; k < json["records"].size(); ++k)
    if (json["records"][k].value("file", nlohmann::json()) != file_of_record(k + 1, profiles[k].name)) return 0;
  return json["records"].size();
}

}  // namespace

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
  const fs::path list = request.output / "campaign.json";
  const std::vector<ProfileToRecord> all = profiles;
  const std::size_t planned = all.size();
  RecordResult out;
  if (fs::exists(list, error)) {
    out.were_there = recorded_of(list, profiles, request.bench);
    if (out.were_there == 0)
      return fail(ErrorCode::usage, "there is another campaign already", request.output.string(), "choose another folder with -o");
    if (!request.go_on || out.were_there == planned)
      return fail(ErrorCode::usage, fmt::format("there is a campaign already, with {} of the {} records", out.were_there, planned), request.output.string(),
                  out.were_there == planned ? "choose another folder with -o" : "add --continue to record the others, or choose another folder with -o");
    profiles.erase(profiles.begin(), profiles.begin() + static_cast<std::ptrdiff_t>(out.were_there));
  }
  RecordingBench bench = request.bench;
  bench.safety = plan.safety;
  out.folder = request.output;
  auto files = record_profiles(bench, profiles, request.output, progress, cancelled);
  if (!files) {
    Error e = std::move(files).error();
    const std::size_t kept = recorded_of(list, all, request.bench);
    if (kept > 0 && e.code != ErrorCode::usage)
      e.hint += fmt::format("{}{} of {} records are kept in {}: the same command with --continue records the others", e.hint.empty() ? "" : "; ", kept, planned,
                            request.output.string());
    else if (e.hint.empty() && e.code == ErrorCode::cancelled)
      e.hint = "no record was complete, and nothing is kept";
    return Unexpected(std::move(e));
  }
  out.files = std::move(*files);
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
