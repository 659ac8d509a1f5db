#include "hil/trace/divider.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "hil/base/read_number.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

std::optional<double> ohms(std::string_view text) {
  double factor = 1.0;
  if (!text.empty() && (text.back() == 'k' || text.back() == 'M')) {
    factor = text.back() == 'k' ? 1e3 : 1e6;
    text.remove_suffix(1);
  }
  const std::optional<double> value = read_number(text);
  return value ? std::optional(factor * *value) : std::nullopt;
}

}  // namespace

Result<Divider> parse_divider(std::string_view word) {
  const std::vector<std::string> parts = split(word, ':');
  const auto refused = [&](const std::string& what) {
    return fail(ErrorCode::usage, what, "--divider " + printable_utf8(std::string(word)),
                "write OHMS:SUPPLY, for instance 10k:5, and :below where the sensor is between output and ground");
  };
  if (parts.size() < 2 || parts.size() > 3) return refused("a divider is a resistor and a supply");
  const std::optional<double> R_ohm = ohms(parts[0]), supply = ohms(parts[1]);
  if (!R_ohm || !(*R_ohm > 0.0)) return refused("\"" + printable_utf8(parts[0]) + "\" is no resistance above 0, in ohm");
  if (!supply || !(*supply > 0.0)) return refused("\"" + printable_utf8(parts[1]) + "\" is no supply above 0, in the unit of the output");
  if (parts.size() == 3 && parts[2] != "above" && parts[2] != "below") return refused("\"" + printable_utf8(parts[2]) + "\" is neither above nor below");
  return Divider{*R_ohm, *supply, parts.size() == 3 && parts[2] == "below"};
}

Result<void> read_divider(Campaign& campaign, const Divider& divider) {
  constexpr double kMostBeyond = 0.1;
  std::size_t lost = 0;
  std::string unit;
  for (Record& record : campaign.records) {
    Channel* U = record.trace.find("U");
    if (U == nullptr) continue;
    if (U->quantity != "voltage" && U->quantity != "code")
      return fail(ErrorCode::config,
                  "a divider has an output in volts or counts, and this one is in " + (U->unit.empty() ? "no known unit" : U->unit),
                  record.place(), "leave --divider out");
    unit = U->unit;
    std::size_t beyond = 0, samples = 0;
    for (double& u : U->value) {
      if (!std::isfinite(u)) continue;
      ++samples;
      const double above = divider.supply - u;
      const double over = divider.sensor_below ? above : u, under = divider.sensor_below ? u : above;
      const bool is_beyond = over < 0.0 || under < 0.0;
      beyond += is_beyond;
      lost += under <= 0.0;
      // noise about no output is a reading: without it the mean of an unloaded sensor would be too high
      u = under <= 0.0 ? kMissing : over / (divider.R_ohm * under);
    }
    if (static_cast<double>(beyond) > kMostBeyond * static_cast<double>(samples))
      return fail(ErrorCode::parse,
                  fmt::format("{} of {} samples of the output lie beyond 0 and the supply of the divider, {} {}", beyond, samples,
                              shortest(divider.supply), unit),
                  record.place(), "give the supply in the unit of the output: volts, or counts (1024 for 10 bits)");
    U->unit = "S";
    U->quantity = "conductance";
    U->raw.clear();
  }
  campaign.bench.forget_converter();  // its range and steps are of volts
  campaign.notes.push_back(fmt::format("the output is read as the conductance of a sensor {} {} ohm at {} {}, siemens{}",
                                       divider.sensor_below ? "below" : "above", shortest(divider.R_ohm), shortest(divider.supply), unit,
                                       lost > 0 ? fmt::format("; {} samples at an end of the supply are missing", lost) : ""));
  return {};
}

}  // namespace forcegate
