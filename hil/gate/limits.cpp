#include "hil/gate/limits.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "hil/base/text.h"
#include "hil/gate/statistics.h"
#include "hil/rig/config.h"

namespace forcegate {
namespace {

constexpr std::uint64_t kFewestForP99 = 299;  // 0.99^299 < 0.05
constexpr std::int64_t kFormat = 2;

// Files that an earlier version made have four decimals in each of the three numbers.
bool follows(const DerivedLimit& limit) {
  const auto of_four = [](double x) { return std::fabs(1e4 * x - std::round(1e4 * x)) < 1e-6; };
  const bool rounded = of_four(limit.value) && of_four(limit.p99_upper) && of_four(limit.sd);
  const double expected = limit.p99_upper + 2.0 * limit.sd;
  return std::fabs(limit.value - expected) <= (rounded ? 2.01e-4 : 1e-9 * (limit.value + expected));
}

}  // namespace

bool DerivedLimits::of_rig(const RigInfo& info) const {
  const std::string version = info.name + "/" + info.version;
  return rig.empty() || rig == version || rig == version + " " + info.id;
}

Limit DerivedLimits::find(const std::string& case_name, const std::string& check_id) const {
  const auto at = by_case_and_check.find({case_name, check_id});
  if (at == by_case_and_check.end()) return {};
  return {Limit::Kind::upper, at->second.value,
          fmt::format("derived: {} + 2 sd of n = {}, {}, rig {}",
                      at->second.n < kFewestForP99 ? "largest" : "p99 at 95 % confidence", at->second.n, date, rig)};
}

DerivedLimit derive_limit(const std::vector<double>& values, double sd, std::string unit) {
  DerivedLimit limit;
  limit.p99_upper = quantile_bound_95(values, 0.99).value;
  limit.sd = sd;
  limit.value = limit.p99_upper + 2.0 * sd;
  limit.unit = std::move(unit);
  limit.n = values.size();
  return limit;
}

Result<DerivedLimits> read_limits(const std::filesystem::path& path) {
  FORCEGATE_TRY(const ConfigNode root, read_config(path));
  DerivedLimits limits;
  ConfigReader r(root, "the limits file", "docs/gate.md");
  std::int64_t format = 0;
  r.integer("format", format, 1, kFormat, ConfigReader::required);
  r.text("plan", limits.plan, ConfigReader::required);
  r.text("firmware_sha256", limits.firmware_sha256, ConfigReader::required);
  r.text("rig", limits.rig, ConfigReader::required);
  r.text("date", limits.date, ConfigReader::required);
  const ConfigNode* list = r.array("limit", ConfigReader::required);
  FORCEGATE_CHECK_OK(r.finish());
  if (format < kFormat)
    return fail(ErrorCode::config, "limits of format 1 hold a point estimate of p99 and are no longer judged by", path.string(),
                "take \"derived\" out of the plan, make the file anew with forcegate limits, and put it back");
  for (const ConfigNode& item : list->items) {
    if (item.kind != ConfigNode::Kind::table)
      return fail(ErrorCode::config, "a limit must be a table", item.where, "write [[limit]]");
    ConfigReader l(item, "a limit", "docs/gate.md");
    std::string case_name, check;
    DerivedLimit limit;
    std::int64_t n = 0;
    l.text("case", case_name, ConfigReader::required);
    l.text("check", check, ConfigReader::required);
    l.number("p99_upper", limit.p99_upper, 0.0, 1e9, ConfigReader::required);
    l.number("sd", limit.sd, 0.0, 1e9, ConfigReader::required);
    l.number("value", limit.value, 0.0, 1e9, ConfigReader::required);
    l.text("unit", limit.unit, ConfigReader::required);
    l.integer("n", n, 1, 1000000000, ConfigReader::required);
    FORCEGATE_CHECK_OK(l.finish());
    limit.n = static_cast<std::uint64_t>(n);
    if (!follows(limit))
      return fail(ErrorCode::config, fmt::format("the limit for {} of {} is not the derived one: value = {}, and p99_upper + 2 sd = {}", printable_utf8(check),
                                                 printable_utf8(case_name), shortest(limit.value), shortest(limit.p99_upper + 2.0 * limit.sd)),
                  item.where, "make the file anew with forcegate limits; a limit of your own goes into the plan (maxima_pct, minima_pct, limit_source)");
    if (!limits.by_case_and_check.try_emplace({case_name, check}, limit).second)
      return fail(ErrorCode::config, fmt::format("two limits for {} of {}", check, case_name), item.where);
  }
  return limits;
}

std::string write_limits(const DerivedLimits& limits) {
  std::string out = fmt::format(
      "# Derived limits. Made by `forcegate limits`; do not edit by hand.\n"
      "format = {}\nplan = \"{}\"\nfirmware_sha256 = \"{}\"\nrig = \"{}\"\ndate = \"{}\"\n",
      kFormat, limits.plan, limits.firmware_sha256, limits.rig, limits.date);
  for (const auto& [key, limit] : limits.by_case_and_check)
    out += fmt::format(
        "\n[[limit]]\ncase = \"{}\"\ncheck = \"{}\"\np99_upper = {}\nsd = {}\nvalue = {}\nunit = "
        "\"{}\"\nn = {}\n",
        key.first, key.second, shortest(limit.p99_upper), shortest(limit.sd), shortest(limit.value), limit.unit, limit.n);
  return out;
}

std::string limits_json(const DerivedLimits& limits) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const auto& [key, limit] : limits.by_case_and_check)
    rows.push_back({{"case", key.first},
                    {"check", key.second},
                    {"p99_upper", limit.p99_upper},
                    {"sd", limit.sd},
                    {"value", limit.value},
                    {"unit", limit.unit},
                    {"n", limit.n}});
  return nlohmann::ordered_json{
      {"format", kFormat}, {"plan", limits.plan}, {"firmware_sha256", limits.firmware_sha256},
      {"rig", limits.rig}, {"date", limits.date}, {"limits", rows}}
      .dump(2);
}

}  // namespace forcegate
