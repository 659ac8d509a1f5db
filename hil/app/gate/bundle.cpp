#include "hil/app/gate/bundle.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "hil/app/files/write_file.h"
#include "hil/app/gate/sensor_records.h"
#include "hil/base/digest.h"
#include "hil/base/read_file.h"
#include "hil/base/text.h"
#include "hil/gate/case_json.h"
#include "hil/report/result_json.h"

namespace forcegate {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

Result<BundleFile> describe(const fs::path& folder, const std::string& name) {
  std::error_code error;
  const auto bytes = fs::file_size(folder / name, error);
  if (error) return fail(ErrorCode::parse, "a file of the bundle is missing", (folder / name).string());
  FORCEGATE_TRY(std::string hash, sha256_file(folder / name));
  return BundleFile{name, bytes, std::move(hash)};
}

std::string id_of(const std::vector<BundleFile>& files) {
  std::string list;
  for (const BundleFile& f : files) list += f.sha256 + "  " + f.name + "\n";
  return sha256_hex(list);
}

// What is not judged; its checks are those against the accepted build, with their values but without a verdict, which is "not run" and
// nobody's. Where the accepted build gave nothing to compare with the verdict is final, and somebody's.
RunResult with_compared(RunResult head, const std::vector<JudgedCheck>& compared) {
  head.checks.clear();
  for (const JudgedCheck& j : compared) head.checks.push_back(j.check);
  head.decision = {};
  return head;
}

std::vector<JudgedCheck> take_compared(RunResult& head) {
  std::vector<JudgedCheck> compared;
  for (Check& check : head.checks) {
    const bool judgeable = check.verdict == Verdict::not_run && check.blame == Blame::none;
    compared.push_back({.check = std::move(check), .judgeable = judgeable});
  }
  head.checks.clear();
  return compared;
}

std::string manifest_text(const std::string& id, const std::string& version,
                          const std::string& result_sha256, const std::vector<BundleFile>& files) {
  Json list = Json::array();
  for (const BundleFile& f : files)
    list.push_back({{"name", f.name}, {"bytes", f.bytes}, {"sha256", f.sha256}});
  return Json{{"format", kBundleFormat}, {"id", id}, {"tool_version", version}, {"result_sha256", result_sha256}, {"files", list}}.dump(1) +
         "\n";
}

Result<void> read_records(const fs::path& path, RunMaterial& material) {
  FORCEGATE_TRY(const std::string text, read_file(path));
  for (const std::string& line : split(text, '\n')) {
    if (line.empty()) continue;
    const auto both = nlohmann::json::parse(line, nullptr, false);
    if (!both.is_object() || !both.contains("job") || !both.contains("record"))
      return fail(ErrorCode::parse, "a line is no record", path.string());
    PlayedRecord& one = material.records.emplace_back();
    one.case_index = both.value("case", std::size_t{0});
    one.specimen_index = both.value("specimen", std::size_t{0});
    one.superseded = both.value("superseded", false);
    const Plan& plan = material.plan;
    if (one.case_index >= plan.cases.size() ||
        one.specimen_index >= specimens_of(plan, plan.cases[one.case_index]).size())
      return fail(ErrorCode::parse, "a record belongs to no case of the plan", path.string());
    FORCEGATE_TRY(one.job, job_from_json(both["job"].dump()));
    FORCEGATE_TRY(one.record, record_from_json(both["record"].dump()));
  }
  return {};
}

bool complete(const RunMaterial& m) {
  for (std::size_t k = 0; k < m.plan.cases.size(); ++k)
    for (std::size_t i = 0; i < specimens_of(m.plan, m.plan.cases[k]).size(); ++i)
      if (std::none_of(m.records.begin(), m.records.end(), [&](const PlayedRecord& one) {
            return one.case_index == k && one.specimen_index == i && !one.superseded;
          }))
        return false;
  return true;
}

// The files of a bundle as they are written; the list of them comes last.
class BundleWriter {
 public:
  explicit BundleWriter(const fs::path& folder) : folder_(folder) {
    std::error_code ignored;
    fs::create_directories(folder / "bundle", ignored);
  }

  Result<void> add(const std::string& name, const std::string& bytes) {
    names_.push_back("bundle/" + name);
    return write_file_atomically(folder_ / names_.back(), bytes);
  }
  Result<void> copy(const std::string& name, const fs::path& from) {
    FORCEGATE_TRY(const std::string bytes, read_file(from));
    return add(name, bytes);
  }
  void list(const std::string& name) { names_.push_back(name); }

  // What every kind of run has.
  Result<void> add_common(const BundleSource& source, const RunResult& head, Json run) {
    if (source.plan == source.plan_as_asked) run["plan_file"] = source.plan_as_asked;
    FORCEGATE_CHECK_OK(copy("plan.toml", source.plan));
    if (!source.waivers.empty()) FORCEGATE_CHECK_OK(copy("waivers.toml", source.waivers));
    for (const GoldenRecord& golden : source.evidence.goldens)
      FORCEGATE_CHECK_OK(
          add("goldens/" + golden_file_name(golden.case_name, golden.specimen), to_text(golden)));
    FORCEGATE_CHECK_OK(add("head.json", to_json(head)));
    FORCEGATE_CHECK_OK(add("run.json", run.dump(1) + "\n"));
    return copy("firmware", source.firmware);
  }

  Result<void> seal(const std::string& tool_version, const RunResult& result) {
    std::sort(names_.begin(), names_.end());
    std::vector<BundleFile> files;
    for (const std::string& name : names_) {
      FORCEGATE_TRY(files.emplace_back(), describe(folder_, name));
    }
    return write_file_atomically(folder_ / "bundle.json", manifest_text(id_of(files), tool_version, sha256_hex(to_json(result)), files));
  }

 private:
  fs::path folder_;
  std::vector<std::string> names_;
};

// A run that was killed has left the one before it aside, which its name does not lead to.
std::string or_aside(const fs::path& folder, const std::string& hint) {
  const fs::path aside = run_put_aside(folder);
  return aside.empty() ? hint : "an older run of that name lies in " + file_quoted(aside.string()) + " since a later one was killed; mv gives it its name again";
}

// Every listed file is there and as it was written.
Result<Bundle> read_manifest(const fs::path& folder) {
  const std::string where = (folder / "bundle.json").string();
  std::error_code ignored;
  if (!fs::exists(folder, ignored)) return fail(ErrorCode::usage, "there is no such folder", folder.string(), or_aside(folder, "check the name: it is the folder that forcegate gate -o wrote"));
  if (!fs::exists(folder / "bundle.json", ignored))
    return fail(ErrorCode::usage, "this is no bundle", folder.string(),
                "give the folder that forcegate gate -o wrote: it holds bundle.json");
  FORCEGATE_TRY(const std::string text, read_file(folder / "bundle.json"));
  const auto manifest = nlohmann::json::parse(text, nullptr, false);
  if (!manifest.is_object() || !manifest.contains("files") || !manifest["files"].is_array())
    return fail(ErrorCode::parse, "the list of the bundle cannot be read", where);
  if (manifest.value("format", 0) != kBundleFormat)
    return fail(ErrorCode::parse,
                fmt::format("the bundle has format {}, this program reads {}", manifest.value("format", 0),
                            kBundleFormat),
                where);
  Bundle bundle;
  bundle.id = manifest.value("id", "");
  bundle.tool_version = manifest.value("tool_version", "");
  for (const auto& file : manifest["files"]) {
    BundleFile listed{file.value("name", ""), file.value("bytes", std::uint64_t{0}),
                      file.value("sha256", "")};
    if (listed.name.empty() || listed.name.find("..") != std::string::npos || listed.name.front() == '/')
      return fail(ErrorCode::parse, "the list names a file outside of the bundle", where);
    FORCEGATE_TRY(const BundleFile found, describe(folder, listed.name));
    if (found.sha256 != listed.sha256)
      return fail(ErrorCode::parse, "a file of the bundle was changed", (folder / listed.name).string(),
                  "take the bundle as the run wrote it; --limits judges under other limits");
    bundle.files.push_back(std::move(listed));
  }
  FORCEGATE_CHECK_OK(check_result_unchanged(folder));
  if (id_of(bundle.files) != bundle.id)
    return fail(ErrorCode::parse, "the list of the bundle was changed", where,
                "take the bundle as the run wrote it");
  return bundle;
}

Result<RunMaterial> read_material(const fs::path& inner, const nlohmann::json& run) {
  RunMaterial m;
  std::error_code ignored;
  FORCEGATE_TRY(const std::string plan, read_file(inner / "plan.json"));
  FORCEGATE_TRY(m.plan, plan_from_json(plan));
  if (fs::exists(inner / "limits.toml", ignored)) {
    FORCEGATE_TRY(m.limits, read_limits(inner / "limits.toml"));
  }
  FORCEGATE_TRY(m.head, read_result(inner / "head.json"));
  m.compared = take_compared(m.head);
  const std::string level = run.value("level", "nominal");
  m.level = level == "identified" ? CalibrationLevel::identified
            : level == "static"   ? CalibrationLevel::statical
                                  : CalibrationLevel::nominal;
  m.cancelled = run.value("cancelled", false);
  FORCEGATE_CHECK_OK(read_records(inner / "records.jsonl", m));
  if (!complete(m))
    return fail(ErrorCode::parse, "the bundle lacks records that its plan asks for", inner.string());
  return m;
}

Result<characterize::WeightMaterial> read_weight_material(const fs::path& inner, const nlohmann::json& run) {
  characterize::WeightMaterial m;
  FORCEGATE_TRY(m.plan, characterize::read_weight_gate_plan(inner / "plan.toml", inner / "study.toml"));
  m.plan.goldens = run.value("goldens", "");
  m.sensors = run.value("sensors", std::size_t{0});
  m.with_accepted = run.value("accepted", false);
  m.cancelled = run.value("cancelled", false);
  FORCEGATE_TRY(m.head, read_result(inner / "head.json"));
  FORCEGATE_TRY(const std::string text, read_file(inner / "records.jsonl"));
  FORCEGATE_TRY(m.records, sensor_records_from(text, m.plan, (inner / "records.jsonl").string()));
  if (m.records.size() != m.head.cases.size())
    return fail(ErrorCode::parse, "the bundle has another number of records than of cases", inner.string());
  return m;
}

}  // namespace

Result<void> check_result_unchanged(const fs::path& folder) {
  std::error_code ignored;
  const fs::path list = folder / "bundle.json", result = folder / "result.json";
  if (!fs::exists(list, ignored) || !fs::exists(result, ignored)) return {};
  FORCEGATE_TRY(const std::string text, read_file(list));
  const auto manifest = nlohmann::json::parse(text, nullptr, false);
  const std::string listed = manifest.is_object() && manifest.contains("result_sha256") && manifest["result_sha256"].is_string()
                                 ? manifest["result_sha256"].get<std::string>()
                                 : "";
  if (listed.empty()) return {};
  FORCEGATE_TRY(const std::string found, sha256_file(result));
  if (found == listed) return {};
  return fail(ErrorCode::parse, "the result was changed after the run", result.string(),
              "take the folder as the run wrote it, or gate the build again");
}

Result<RunResult> read_run(const fs::path& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return fail(ErrorCode::io, "there is no such file or folder", path.string(), or_aside(path, "check the name"));
  const bool folder = fs::is_directory(path, ignored);
  FORCEGATE_CHECK_OK(check_result_unchanged(folder ? path : path.parent_path()));
  return read_result(folder ? path / "result.json" : path);
}

Result<void> write_bundle(const fs::path& folder, const BundleSource& source, const RunMaterial& material, const RunResult& result) {
  BundleWriter out(folder);
  FORCEGATE_CHECK_OK(out.add("plan.json", to_json(material.plan)));
  if (!material.limits.plan.empty()) FORCEGATE_CHECK_OK(out.copy("limits.toml", source.limits));
  RunResult head = with_compared(material.head, material.compared);
  head.cases.clear();
  FORCEGATE_CHECK_OK(out.add_common(source, head,
                                    {{"level", std::string(to_string(material.level))},
                                     {"cancelled", material.cancelled},
                                     {"today", source.evidence.today}}));
  std::string records;
  for (const PlayedRecord& one : material.records) {
    CaseJob job = one.job;
    if (!job.keep_path.empty()) job.keep_path = (fs::path("traces") / fs::path(job.keep_path).filename()).string();  // the run's folder is renamed when it is whole
    records += fmt::format("{{\"case\":{},\"specimen\":{},\"superseded\":{},\"job\":{},\"record\":{}}}\n",
                           one.case_index, one.specimen_index, one.superseded, to_json(job),
                           to_json(one.record));
  }
  FORCEGATE_CHECK_OK(out.add("records.jsonl", records));
  std::error_code ignored;
  for (const PlayedRecord& one : material.records)
    if (const std::string& name = one.record.trace_file; !name.empty() && fs::exists(folder / name, ignored))
      out.list(name);
  return out.seal(material.head.tool_version, result);
}

Result<void> write_bundle(const fs::path& folder, const BundleSource& source,
                          const characterize::WeightMaterial& material, const RunResult& result) {
  BundleWriter out(folder);
  FORCEGATE_CHECK_OK(out.copy("study.toml", material.plan.study.path));
  FORCEGATE_CHECK_OK(out.add_common(source, material.head,
                                    {{"kind", characterize::kWeightGateKind},
                                     {"sensors", material.sensors},
                                     {"goldens", material.plan.goldens},
                                     {"accepted", material.with_accepted},
                                     {"cancelled", material.cancelled},
                                     {"today", source.evidence.today}}));
  FORCEGATE_CHECK_OK(out.add("records.jsonl", to_text(material.records)));
  return out.seal(material.head.tool_version, result);
}

Result<Bundle> read_bundle(const fs::path& folder) {
  FORCEGATE_TRY(Bundle bundle, read_manifest(folder));
  const fs::path inner = folder / "bundle";
  FORCEGATE_TRY(const std::string run_text, read_file(inner / "run.json"));
  const auto run = nlohmann::json::parse(run_text, nullptr, false);
  if (!run.is_object()) return fail(ErrorCode::parse, "run.json cannot be read", folder.string());
  const std::string kind = run.value("kind", "");
  if (kind == characterize::kWeightGateKind) {
    FORCEGATE_TRY(bundle.material, read_weight_material(inner, run));
  } else if (kind.empty()) {
    FORCEGATE_TRY(bundle.material, read_material(inner, run));
  } else {
    return fail(ErrorCode::parse,
                "the bundle is of a kind that this program does not know: " + printable_utf8(kind),
                folder.string());
  }
  FORCEGATE_TRY(bundle.evidence.goldens, read_goldens(inner / "goldens"));
  bundle.evidence.today = run.value("today", "");
  bundle.plan_file = run.value("plan_file", "");
  std::error_code ignored;
  if (fs::exists(inner / "waivers.toml", ignored)) {
    FORCEGATE_TRY(bundle.evidence.waivers, read_waivers(inner / "waivers.toml"));
  }
  return bundle;
}

}  // namespace forcegate
