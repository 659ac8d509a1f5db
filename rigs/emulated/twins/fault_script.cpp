#include "rigs/emulated/twins/fault_script.h"

#include <algorithm>
#include <cmath>

#include "hil/base/read_number.h"
#include "hil/base/text.h"

namespace forcegate::emulated {

const std::vector<std::string>& fault_names() {
  static const std::vector<std::string> names{"delay",   "drop",       "drop_byte", "duplicate",   "corrupt",
                                              "garbage", "truncate",   "exception", "wrong_slave", "stall",
                                              "unplug",  "saturation", "frozen",    "reset"};
  return names;
}

std::vector<std::string> devices_with(WireFault kind) {
  if (kind == WireFault::exception || kind == WireFault::wrong_slave) return {"motor"};
  if (kind == WireFault::saturation) return {"reference", "board"};
  return {"motor", "reference", "board"};
}

Result<FaultEntry> FaultScript::read_entry(const ConfigNode& table) {
  FaultEntry e;
  ConfigReader in(table, "[[twins.fault]]", "docs/bench.md");
  std::string kind;
  std::int64_t count = 0;
  in.choice("device", e.device, {"motor", "reference", "board"}, ConfigReader::required);
  in.choice("kind", kind, fault_names(), ConfigReader::required);
  in.number("at_s", e.at_s, 0, 1e9);
  in.number("for_s", e.for_s, 0, 1e9);
  if (in.integer("count", count, 1, 1000000000) && table.find("for_s") != nullptr)
    in.complain(*table.find("count"), "for_s and count are given together", "a fault ends after a time or after a number of messages: leave one out");
  if (count > 0) e.count = static_cast<std::uint64_t>(count);
  in.number("amount", e.amount, 0, 1e6);
  const auto& names = fault_names();
  e.kind = static_cast<WireFault>(std::find(names.begin(), names.end(), kind) - names.begin());
  if (in.good()) {
    const std::vector<std::string> devices = devices_with(e.kind);
    if (std::find(devices.begin(), devices.end(), e.device) == devices.end())
      in.complain(table, "the device '" + e.device + "' has no fault '" + kind + "'", "it is one of: " + join(devices, ", "));
    if (e.kind == WireFault::garbage && e.amount > kGarbageMax)
      in.complain(*table.find("amount"), "more than " + shortest(kGarbageMax) + " bytes of garbage before a message", "give a smaller amount");
  }
  FORCEGATE_CHECK_OK(in.finish());
  if (const ConfigNode* at = table.find("at_s")) e.where = at->where;
  return e;
}

Result<FaultEntry> FaultScript::read_words(std::span<const std::string> words) {
  if (words.size() != 6) return fail(ErrorCode::usage, "a fault is told as DEVICE KIND AT_S FOR_S COUNT AMOUNT");
  const auto& names = fault_names();
  const auto kind = std::find(names.begin(), names.end(), words[1]);
  if (kind == names.end()) return fail(ErrorCode::usage, "there is no fault '" + words[1] + "': it is one of " + join(names, ", "));
  FaultEntry e;
  e.device = words[0];
  e.kind = static_cast<WireFault>(kind - names.begin());
  const std::vector<std::string> devices = devices_with(e.kind);
  if (std::find(devices.begin(), devices.end(), e.device) == devices.end())
    return fail(ErrorCode::usage, "the device '" + e.device + "' has no fault '" + words[1] + "'; of these one has: " + join(devices, ", "));
  double count = 0.0;
  const struct {
    const char* name;
    const std::string& word;
    double& out;
    double highest;
  } numbers[] = {{"AT_S", words[2], e.at_s, 1e9},
                 {"FOR_S", words[3], e.for_s, 1e9},
                 {"COUNT", words[4], count, 1e9},
                 {"AMOUNT", words[5], e.amount, e.kind == WireFault::garbage ? kGarbageMax : 1e6}};
  for (const auto& n : numbers) {
    const auto value = read_number(n.word);
    if (!value || *value < 0.0 || *value > n.highest)
      return fail(ErrorCode::usage, std::string(n.name) + " of a fault must be a number from 0 to " + shortest(n.highest) + ", not '" + n.word + "'");
    n.out = *value;
  }
  if (count != std::floor(count)) return fail(ErrorCode::usage, "COUNT of a fault must be a whole number, not '" + words[4] + "'");
  if (count > 0.0) e.count = static_cast<std::uint64_t>(count);
  return e;
}

void FaultScript::begin_record() {
  for (Live& live : entries_) live.used = 0;
}

bool FaultScript::covers(const Live& live, const std::string& device, WireFault kind, double t_s) {
  const FaultEntry& e = live.entry;
  return e.device == device && e.kind == kind && t_s >= e.at_s && t_s - e.at_s < e.for_s &&
         live.used < e.count;
}

bool FaultScript::hit(const std::string& device, WireFault kind, double t_s, double* amount) {
  for (Live& live : entries_) {
    if (!covers(live, device, kind, t_s)) continue;
    ++live.used;
    if (amount != nullptr) *amount = live.entry.amount;
    return true;
  }
  return false;
}

bool FaultScript::active(const std::string& device, WireFault kind, double t_s) const {
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const Live& live) { return covers(live, device, kind, t_s); });
}

}  // namespace forcegate::emulated
