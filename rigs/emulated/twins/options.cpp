#include <algorithm>
#include <array>

#include "hil/base/text.h"
#include "rigs/emulated/twins/host.h"

namespace forcegate::emulated {

Result<TwinOptions> read_twin_options(const ConfigNode& bench) {
  constexpr const char* kGuide = "docs/bench.md";
  TwinOptions o;
  const ConfigNode* twins = bench.find("twins");
  if (twins == nullptr || twins->kind != ConfigNode::Kind::table)
    return fail(ErrorCode::config, "the bench file has no [twins]", bench.where,
                "only a bench of twins can be emulated; rigs/twin.toml is one");
  ConfigReader in(*twins, "[twins]", kGuide);
  std::string sensor = "flexiforce", clock = "virtual";
  std::int64_t adc_bits = 16;
  in.choice("sensor", sensor, {"flexiforce", "fsr"});
  in.choice("clock", clock, {"virtual", "paced"});
  in.integer("adc_bits", adc_bits, 8, 16);
  in.boolean("session_spread", o.plant.session_spread);
  in.boolean("noise", o.plant.noise);
  in.number("ati_counts_per_N", o.reference.counts_per_N, 1, 1e6);
  if (const ConfigNode* faults = in.array("fault"))
    for (const ConfigNode& f : faults->items) {
      FORCEGATE_TRY(FaultEntry entry, FaultScript::read_entry(f));
      o.faults.push_back(std::move(entry));
    }
  FORCEGATE_CHECK_OK(in.finish());
  o.plant.sensor = sensor == "fsr" ? SensorType::fsr : SensorType::flexiforce;
  o.plant.adc_bits = static_cast<int>(adc_bits);

  // Of the instruments' tables only what names a wire; the rest is the adapters' business.
  const auto text = [](const ConfigNode* table, const char* key, std::string& out) {
    if (table == nullptr) return;
    if (const ConfigNode* n = table->find(key); n != nullptr && n->kind == ConfigNode::Kind::text)
      out = n->text;
  };
  const auto integer = [](const ConfigNode* table, const char* key, int& out) {
    if (table == nullptr) return;
    if (const ConfigNode* n = table->find(key); n != nullptr && n->kind == ConfigNode::Kind::integer)
      out = static_cast<int>(n->integer);
  };
  const ConfigNode* motor = bench.find("motor");
  const ConfigNode* link = motor != nullptr ? motor->find("link") : nullptr;
  std::string kind = "rtu";
  text(link, "kind", kind);
  text(motor, "port", o.motor_port);
  text(link, "port", o.motor_port);
  integer(link, "slave", o.slave);
  integer(link, "tcp_port", o.tcp_port);
  o.tcp = kind == "tcp";
  int baud = 38400;
  text(bench.find("reference"), "port", o.reference_port);
  integer(bench.find("reference"), "baud", baud);
  o.reference.baud = static_cast<unsigned>(baud);
  text(bench.find("reference"), "adapter", o.reference.adapter);
  // a program of its own speaks to the twin of the ATI controller
  constexpr std::array kReferences{"ati_serial", "ati_digital", "ati_netft", "process"};
  if (std::ranges::find(kReferences, o.reference.adapter) == kReferences.end())
    return fail(ErrorCode::config, "there is no twin of a reference '" + printable_utf8(o.reference.adapter) + "'", bench.find("reference")->find("adapter")->where,
                "write one in rigs/emulated/twins and choose it in host.cpp there, or leave [twins] out");
  text(bench.find("reference"), "serial", o.reference.serial);
  integer(bench.find("reference"), "udp_port", o.reference.udp_port);
  integer(bench.find("reference"), "http_port", o.reference.http_port);
  integer(bench.find("reference"), "slave", o.reference.slave);
  if (const ConfigNode* reference = bench.find("reference"))
    if (const ConfigNode* n = reference->find("rate_Hz"); n != nullptr && n->number > 0.0)
      o.reference.rate_Hz = std::min(n->number, o.plant.rate_Hz);  // the plant has no values between its rows
  text(bench.find("board"), "port", o.board_port);
  std::string board_adapter;
  text(bench.find("board"), "adapter", board_adapter);
  o.board_reports = board_adapter == "hid_board";
  for (const std::string& port : {o.motor_port, o.reference_port, o.board_port})
    if (port.empty() || port.find('/') != std::string::npos)
      return fail(ErrorCode::config, "the port '" + port + "' of a twin must be a plain name", bench.where);
  return o;
}

}  // namespace forcegate::emulated
