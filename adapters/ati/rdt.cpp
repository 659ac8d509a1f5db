#include "adapters/ati/rdt.h"

#include <algorithm>
#include <optional>

#include "hil/base/read_number.h"
#include "hil/base/text.h"

namespace forcegate::ati {
namespace {

std::uint32_t word_at(std::span<const std::uint8_t> b, std::size_t at) {
  return static_cast<std::uint32_t>(b[at]) << 24 | static_cast<std::uint32_t>(b[at + 1]) << 16 |
         static_cast<std::uint32_t>(b[at + 2]) << 8 | b[at + 3];
}

// Text of the one element <name>; nullopt when there is none or several.
std::optional<std::string> only_element(std::string_view xml, const std::string& name) {
  const std::string open = "<" + name + ">", close = "</" + name + ">";
  const std::size_t from = xml.find(open);
  if (from == std::string_view::npos || xml.find(open, from + 1) != std::string_view::npos)
    return std::nullopt;
  const std::size_t to = xml.find(close, from);
  if (to == std::string_view::npos) return std::nullopt;
  return std::string(trim(xml.substr(from + open.size(), to - from - open.size())));
}

double positive(const std::optional<std::string>& text) {
  return text ? std::max(0.0, read_number(*text).value_or(0.0)) : 0.0;
}

}  // namespace

std::array<std::uint8_t, 8> encode_rdt(RdtCommand command, std::uint32_t samples) {
  const auto c = static_cast<std::uint16_t>(command);
  return {0x12,
          0x34,
          static_cast<std::uint8_t>(c >> 8),
          static_cast<std::uint8_t>(c),
          static_cast<std::uint8_t>(samples >> 24),
          static_cast<std::uint8_t>(samples >> 16),
          static_cast<std::uint8_t>(samples >> 8),
          static_cast<std::uint8_t>(samples)};
}

bool decode_rdt(std::span<const std::uint8_t> datagram, std::vector<RdtRecord>& out) {
  if (datagram.empty() || datagram.size() % kRdtRecordSize != 0) return false;
  for (std::size_t at = 0; at < datagram.size(); at += kRdtRecordSize) {
    RdtRecord r;
    r.rdt_sequence = word_at(datagram, at);
    r.ft_sequence = word_at(datagram, at + 4);
    r.status = word_at(datagram, at + 8);
    for (std::size_t axis = 0; axis < 6; ++axis)
      r.counts[axis] = static_cast<std::int32_t>(word_at(datagram, at + 12 + 4 * axis));
    out.push_back(r);
  }
  return true;
}

RdtHealth rdt_health(std::uint32_t status) {
  if (status == 0 || status == 0x80010000U) return RdtHealth::good;
  return (status & (1U << 17)) != 0 ? RdtHealth::saturated : RdtHealth::fault;
}

Result<NetFtConfig> parse_netft_page(std::string_view xml) {
  NetFtConfig config;
  const auto wrong = [](const char* what) {
    return fail(ErrorCode::device, std::string("netftapi2.xml does not tell ") + what, {},
                "open the page in a browser; the box must be a Net F/T with a calibration");
  };
  const auto product = only_element(xml, "prodname");
  if (!product || product->empty()) return wrong("the product (prodname)");
  config.product = printable_utf8(*product);
  config.counts_per_force = positive(only_element(xml, "cfgcpf"));
  if (config.counts_per_force <= 0.0) return wrong("the counts per force (cfgcpf)");
  const auto unit = only_element(xml, "scfgfu");
  static constexpr std::pair<std::string_view, double> kUnits[] = {{"N", 1.0},
                                                                   {"kN", 1000.0},
                                                                   {"lbf", 4.4482216152605},
                                                                   {"lb", 4.4482216152605},
                                                                   {"klbf", 4448.2216152605},
                                                                   {"kgf", 9.80665},
                                                                   {"kg", 9.80665},
                                                                   {"gf", 9.80665e-3},
                                                                   {"g", 9.80665e-3}};
  for (const auto& [name, newtons] : kUnits)
    if (unit && *unit == name) config.newtons_per_unit = newtons;
  if (config.newtons_per_unit <= 0.0) return wrong("a known unit of force (scfgfu)");
  config.rate_Hz = positive(only_element(xml, "comrdtrate"));
  return config;
}

}  // namespace forcegate::ati
