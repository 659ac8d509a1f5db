#include "hil/app/recording/record.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>

#include "hil/app/files/find_plan.h"
#include "hil/app/recording/recorded_bench.h"
#include "hil/base/read_file.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

namespace fs = std::filesystem;

using Json = nlohmann::json;

/// What a folder holds of the campaign that is asked for.
struct Recorded {
  std::size_t records = 0;           ///< how many of the profiles with their files; 0 where it is another campaign
  std::vector<std::string> differs;  ///< what makes it another one: "seed 1 there, 2 asked"
  std::vector<std::size_t> missing = {};  ///< numbers of records that are listed, of which the file is gone
  std::vector<Error> damaged = {};        ///< of files that are there and do not hold their record
};

/// Error: the file is not the whole record that the list tells of.
Result<void> check_whole(const fs::path& csv, const Json& listed) {
  const std::string remedy = "rm " + file_quoted(csv.string()) + ", and --continue records it again";
  const auto text = read_file(csv);
  if (!text) return fail(ErrorCode::io, "a record of the campaign cannot be read: " + text.error().text, csv.string(), remedy);
  constexpr double kRounding = 2.0;
  const double rows = static_cast<double>(std::ranges::count(*text, '\n')) - 1.0, asked = listed.value("duration_s", 0.0) * listed.value("fs_Hz", 0.0);
  if (text->ends_with('\n') && rows >= asked - kRounding) return {};
  return fail(ErrorCode::parse, fmt::format("the file of a record is cut off: {:.0f} of its {:.0f} rows are there", std::max(0.0, rows), asked), csv.string(), remedy);
}

Result<Recorded> recorded_of(const fs::path& list, const std::vector<ProfileToRecord>& profiles, const RecordingBench& bench) {
  FORCEGATE_TRY(const std::string text, read_file(list));
  const auto json = Json::parse(text, nullptr, false, true);
  if (!json.is_object() || !json.contains("records") || !json["records"].is_array()) return Recorded{0, {"its campaign.json has no list of records"}};
  const std::optional<RecordedBench> there = recorded_bench(text);
  if (!there) return Recorded{0, {"forcegate record did not make it"}};
  Recorded out;
  FORCEGATE_TRY(out.differs, differences(*there, bench));
  const Json& records = json["records"];
  if (records.empty() || records.size() > profiles.size()) out.differs.push_back(there_and_asked("records", std::to_string(records.size()), std::to_string(profiles.size())));
  for (std::size_t k = 0; k < std::min(records.size(), profiles.size()); ++k) {
    const Json name = records[k].is_object() ? records[k].value("file", Json()) : Json();
    const std::string asked = file_of_record(k + 1, profiles[k].name);
    if (name == asked) continue;
    out.differs.push_back(there_and_asked(fmt::format("record {}", k + 1), name.is_string() ? printable_utf8(name.get<std::string>()) : "none", printable_utf8(asked)));
    break;  // one record more or less, and all behind it have another number
  }
  if (!out.differs.empty()) return out;
  std::error_code unknown;
  for (std::size_t k = 0; k < records.size(); ++k) {
    const fs::path csv = list.parent_path() / file_of_record(k + 1, profiles[k].name);
    if (!fs::exists(csv, unknown))
      out.missing.push_back(k + 1);
    else if (auto whole = check_whole(csv, records[k]); !whole)
      out.damaged.push_back(std::move(whole).error());
  }
  out.records = records.size() - out.missing.size();
  return out;
}

/// Files of ours that a killed run has half written: NAME.partPID. The folder is claimed, so no other run writes here; a number that lives is
/// that of a killed one whom nobody has buried yet, or of a process that has it now.
void remove_halves(const fs::path& folder) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string name = entry.path().filename().string();
    const std::size_t at = name.rfind(".part");
    if (at == std::string::npos || !(name.substr(0, at) == "campaign.json" || (name.starts_with("r") && name.substr(0, at).ends_with(".csv")))) continue;
    pid_t pid = 0;
    const char *first = name.data() + at + 5, *last = name.data() + name.size();
    if (const auto read = std::from_chars(first, last, pid); read.ptr != last || pid <= 1 || pid == ::getpid()) continue;
    fs::remove(entry.path(), ignored);
  }
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
  if (request.go_on && !fs::exists(list, error))
    return fail(ErrorCode::usage, "there is no campaign to go on with", request.output.string(), "check the name of the folder; without --continue a campaign begins there");
  FORCEGATE_TRY(const ClaimedFolder folder, ClaimedFolder::take(request.output));
  if (fs::exists(list, error)) {
    FORCEGATE_TRY(const Recorded there, recorded_of(list, profiles, request.bench));
    out.were_there = there.records;
    if (!there.differs.empty())
      return fail(ErrorCode::usage, "there is another campaign already: " + join(there.differs, "; "), request.output.string(),
                  "choose another folder with -o; only the same campaign goes on with --continue");
    if (request.go_on && !there.damaged.empty()) return Unexpected(there.damaged.front());
    if (!request.go_on || out.were_there == planned)
      return fail(ErrorCode::usage, fmt::format("there is a campaign already, with {} of the {} records", out.were_there, planned), request.output.string(),
                  out.were_there == planned ? "choose another folder with -o" : "add --continue to record the others, or choose another folder with -o");
    remove_halves(request.output);
    std::vector<ProfileToRecord> rest;
    for (std::size_t k = 0; k < profiles.size(); ++k) {
      const bool is_listed = k < there.records + there.missing.size();
      if (is_listed && std::ranges::find(there.missing, k + 1) == there.missing.end()) continue;
      rest.push_back(profiles[k]);
      if (is_listed) rest.back().record = k + 1;
    }
    profiles = std::move(rest);
  }
  RecordingBench bench = request.bench;
  bench.safety = plan.safety;
  out.folder = request.output;
  auto files = record_profiles(bench, profiles, folder, progress, cancelled);
  if (!files) {
    Error e = std::move(files).error();
    const auto found = recorded_of(list, all, request.bench);
    const std::size_t kept = found ? found->records : 0;
    if (kept > 0 && e.code != ErrorCode::usage)
      e.hint += fmt::format("{}{} of {} records are kept in {}: the same command with --continue records the others", e.hint.empty() ? "" : "; ", kept, planned,
                            request.output.string());
    else if (e.hint.empty() && e.code == ErrorCode::cancelled)
      e.hint = "no record was complete, and nothing is kept";
    return Unexpected(std::move(e));
  }
  out.files = std::move(*files);
  for (const RecordedFile& f : out.files) out.rig_minutes += f.duration_s / 60.0;
  if (!out.files.empty() && out.files.front().rate_Hz != request.bench.rate_Hz) {
    const double rig_Hz = out.files.front().rig_rate_Hz;
    out.notes.push_back(fmt::format("{} rows a second instead of {}: a row is the mean of a whole number of the rig's samples, of which there are {} a second (--rate {}, {:.6g}, {:.6g}, {:.6g} ...)",
                                    fmt::format("{:.6g}", out.files.front().rate_Hz), shortest(request.bench.rate_Hz), shortest(rig_Hz), shortest(rig_Hz), rig_Hz / 2, rig_Hz / 3, rig_Hz / 4));
  }
  return out;
}

std::string record_json(const RecordResult& r) {
  nlohmann::ordered_json files = nlohmann::ordered_json::array();
  for (const RecordedFile& f : r.files)
    files.push_back({{"name", f.name}, {"file", f.file}, {"duration_s", f.duration_s}, {"rows", f.rows}, {"fs_Hz", f.rate_Hz}});
  const nlohmann::ordered_json out = {
      {"format", 1}, {"folder", r.folder.string()}, {"rig_minutes", r.rig_minutes}, {"records", files}, {"notes", r.notes}};
  return out.dump(2) + "\n";
}

}  // namespace forcegate
