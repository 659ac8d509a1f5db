#include "hil/app/bundle.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "hil/app/golden.h"
#include "hil/app/write_file.h"
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

RunResult head_of(const RunMaterial& material) {
  RunResult head = material.head;
  head.cases.clear();
  head.checks.clear();
  for (const JudgedCheck& j : material.compared) head.checks.push_back(j.check);
  head.decision = {};
  return head;
}

std::string manifest_text(const std::string& id, const std::string& version, const std::vector<BundleFile>& files) {
  Json list = Json::array();
  for (const BundleFile& f : files) list.push_back({{"name", f.name}, {"bytes", f.bytes}, {"sha256", f.sha256}});
  return Json{{"format", kBundleFormat}, {"id", id}, {"tool_version", version}, {"files", list}}.dump(1) + "\n";
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

}  // namespace

Result<void> write_bundle(const fs::path& folder, const BundleSource& source, const RunMaterial& material) {
  const fs::path inner = folder / "bundle";
  std::error_code error;
  fs::create_directories(inner, error);
  std::vector<std::string> names{"bundle/plan.json", "bundle/plan.toml", "bundle/head.json", "bundle/run.json",
                                 "bundle/records.jsonl", "bundle/firmware"};
  FORCEGATE_CHECK_OK(write_file_atomically(inner / "plan.json", to_json(material.plan)));
  FORCEGATE_TRY(const std::string plan_text, read_file(source.plan));
  FORCEGATE_CHECK_OK(write_file_atomically(inner / "plan.toml", plan_text));
  if (!material.limits.plan.empty()) {
    FORCEGATE_TRY(const std::string limits, read_file(source.limits));
    FORCEGATE_CHECK_OK(write_file_atomically(inner / "limits.toml", limits));
    names.emplace_back("bundle/limits.toml");
  }
  if (!source.waivers.empty()) {
    FORCEGATE_TRY(const std::string waivers, read_file(source.waivers));
    FORCEGATE_CHECK_OK(write_file_atomically(inner / "waivers.toml", waivers));
    names.emplace_back("bundle/waivers.toml");
  }
  for (const GoldenRecord& golden : source.goldens) {
    names.push_back("bundle/goldens/" + golden_file_name(golden.case_name, golden.specimen));
    FORCEGATE_CHECK_OK(write_file_atomically(folder / names.back(), to_text(golden)));
  }
  FORCEGATE_CHECK_OK(write_file_atomically(inner / "head.json", to_json(head_of(material))));
  const Json run{{"level", std::string(to_string(material.level))}, {"cancelled", material.cancelled},
                 {"today", source.today}};
  FORCEGATE_CHECK_OK(write_file_atomically(inner / "run.json", run.dump(1) + "\n"));
  std::string records;
  for (const PlayedRecord& one : material.records)
    records += fmt::format("{{\"case\":{},\"specimen\":{},\"superseded\":{},\"job\":{},\"record\":{}}}\n",
                           one.case_index, one.specimen_index, one.superseded, to_json(one.job), to_json(one.record));
  FORCEGATE_CHECK_OK(write_file_atomically(inner / "records.jsonl", records));
  FORCEGATE_TRY(const std::string image, read_file(source.firmware));
  FORCEGATE_CHECK_OK(write_file_atomically(inner / "firmware", image));
  for (const PlayedRecord& one : material.records)
    if (const std::string& name = one.record.trace_file; !name.empty() && fs::exists(folder / name, error))
      names.push_back(name);
  std::sort(names.begin(), names.end());
  std::vector<BundleFile> files;
  for (const std::string& name : names) {
    FORCEGATE_TRY(files.emplace_back(), describe(folder, name));
  }
  return write_file_atomically(folder / "bundle.json",
                               manifest_text(id_of(files), material.head.tool_version, files));
}

Result<Bundle> read_bundle(const fs::path& folder) {
  const std::string where = (folder / "bundle.json").string();
  std::error_code ignored;
  if (!fs::exists(folder / "bundle.json", ignored))
    return fail(ErrorCode::usage, "this is no bundle", folder.string(),
                "give the folder that forcegate gate -o wrote: it holds bundle.json");
  FORCEGATE_TRY(const std::string text, read_file(folder / "bundle.json"));
  const auto manifest = nlohmann::json::parse(text, nullptr, false);
  if (!manifest.is_object() || !manifest.contains("files") || !manifest["files"].is_array())
    return fail(ErrorCode::parse, "the list of the bundle cannot be read", where);
  if (manifest.value("format", 0) != kBundleFormat)
    return fail(ErrorCode::parse, fmt::format("the bundle has format {}, this program reads {}",
                                              manifest.value("format", 0), kBundleFormat),
                where);
  Bundle bundle;
  bundle.id = manifest.value("id", "");
  bundle.tool_version = manifest.value("tool_version", "");
  for (const auto& file : manifest["files"]) {
    BundleFile listed{file.value("name", ""), file.value("bytes", std::uint64_t{0}), file.value("sha256", "")};
    if (listed.name.empty() || listed.name.find("..") != std::string::npos || listed.name.front() == '/')
      return fail(ErrorCode::parse, "the list names a file outside of the bundle", where);
    FORCEGATE_TRY(const BundleFile found, describe(folder, listed.name));
    if (found.sha256 != listed.sha256)
      return fail(ErrorCode::parse, "a file of the bundle was changed", (folder / listed.name).string(),
                  "take the bundle as the run wrote it; --limits judges under other limits");
    bundle.files.push_back(std::move(listed));
  }
  if (id_of(bundle.files) != bundle.id)
    return fail(ErrorCode::parse, "the list of the bundle was changed", where, "take the bundle as the run wrote it");
  RunMaterial& m = bundle.material;
  FORCEGATE_TRY(const std::string plan, read_file(folder / "bundle" / "plan.json"));
  FORCEGATE_TRY(m.plan, plan_from_json(plan));
  if (fs::exists(folder / "bundle" / "limits.toml", ignored)) {
    FORCEGATE_TRY(m.limits, read_limits(folder / "bundle" / "limits.toml"));
  }
  FORCEGATE_TRY(bundle.goldens, read_goldens(folder / "bundle" / "goldens"));
  FORCEGATE_TRY(m.head, read_result(folder / "bundle" / "head.json"));
  for (Check& check : m.head.checks) m.compared.push_back({.check = std::move(check), .judgeable = false});
  m.head.checks.clear();
  FORCEGATE_TRY(const std::string run_text, read_file(folder / "bundle" / "run.json"));
  const auto run = nlohmann::json::parse(run_text, nullptr, false);
  if (!run.is_object()) return fail(ErrorCode::parse, "run.json cannot be read", folder.string());
  const std::string level = run.value("level", "nominal");
  m.level = level == "identified" ? CalibrationLevel::identified
            : level == "static"   ? CalibrationLevel::statical
                                  : CalibrationLevel::nominal;
  m.cancelled = run.value("cancelled", false);
  bundle.today = run.value("today", "");
  if (fs::exists(folder / "bundle" / "waivers.toml", ignored)) {
    FORCEGATE_TRY(bundle.waivers, read_waivers(folder / "bundle" / "waivers.toml"));
  }
  FORCEGATE_CHECK_OK(read_records(folder / "bundle" / "records.jsonl", m));
  if (!complete(m))
    return fail(ErrorCode::parse, "the bundle lacks records that its plan asks for", folder.string());
  return bundle;
}

}  // namespace forcegate
