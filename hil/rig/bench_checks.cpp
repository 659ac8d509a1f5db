// What is wrong with the devices of a bench file before any of them is opened.

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "hil/base/text.h"
#include "hil/interface/device.h"
#include "hil/rig/bench_file.h"

namespace forcegate {
namespace {

// A limit that the reference cannot see stops nothing; figures as large as the forces themselves would let any reference pass.
Result<void> check_reference_figures(const BenchFile& b) {
  constexpr double kLargest = 0.1;
  const ConfigNode& reference = b.table("reference");
  const double limit_N = b.limits.force_max_N;
  if (const ConfigNode* range = reference.find("force_max_N"); range != nullptr && limit_N > range->number)
    return fail(ErrorCode::config,
                fmt::format("force_max_N = {} in [limits], and the reference measures no more than {} N (force_max_N of [reference]): a larger force would stop nothing",
                            shortest(limit_N), shortest(range->number)),
                b.root.find("limits")->find("force_max_N")->where,
                "lower it to " + shortest(range->number) + " N or less (what sensor and reference stand), or correct the range of the reference");
  if (b.reference_resolution_N > kLargest * limit_N)
    return fail(ErrorCode::config,
                fmt::format("'resolution_N' in [reference] = {} is more than a tenth of force_max_N in [limits], {} N: such a reference judges no force",
                            shortest(b.reference_resolution_N), shortest(limit_N)),
                reference.find("resolution_N")->where, "write its smallest step, in N, or use a reference of a smaller range");
  if (b.reference_u_rel < 0.0 || b.reference_u_rel > kLargest)
    return fail(ErrorCode::config, fmt::format("'u_rel' in [reference] = {} is out of range: that is {} % of the force", shortest(b.reference_u_rel), shortest(100.0 * b.reference_u_rel)),
                reference.find("u_rel")->where, "give a number from 0 to 0.1, relative and with k = 1: 0.005 for half a percent");
  return {};
}

// The second to open it would be told that nobody answers. Programs of one's own may share a port between them.
Result<void> each_port_once(const BenchFile& b) {
  const ConfigNode* ports = b.root.find("ports");
  std::vector<std::pair<std::string, const char*>> taken;
  for (const char* device : {"motor", "reference", "board"}) {
    const ConfigNode& table = b.table(device);
    const ConfigNode* link = table.find("link");
    const ConfigNode* port = link != nullptr ? link->find("port") : table.find("port");
    if (port == nullptr || port->kind != ConfigNode::Kind::text) continue;
    const ConfigNode* named = ports != nullptr ? ports->find(port->text) : nullptr;
    const std::string path = named != nullptr ? named->text : port->text;
    const auto program = [&](const char* of) { return b.table(of).find("adapter")->text == "process"; };
    for (const auto& [other, first] : taken)
      if (other == path && !(program(device) && program(first)))
        return fail(ErrorCode::config, fmt::format("[{}] and [{}] name one port, '{}': only one of them can open it", first, device, printable_utf8(path)),
                    named != nullptr ? named->where : port->where, "give each instrument the port it is connected to; forcegate bench scan lists them");
    taken.emplace_back(path, device);
  }
  return {};
}

}  // namespace

Result<void> check_devices(const BenchFile& b) {
  // An adapter only reads its table here; the world is used when it is opened.
  struct Nowhere final : BenchWorld {
    Unexpected no() const {
      return fail(ErrorCode::internal, "no instrument is opened while a bench file is checked");
    }
    Result<std::string> serial_path(const std::string&) override { return no(); }
    Result<std::unique_ptr<Transport>> open_line(const std::string&, const LineSettings&) override {
      return no();
    }
    Result<std::unique_ptr<Transport>> open_hid(unsigned short, unsigned short, const std::string&) override {
      return no();
    }
    Result<std::unique_ptr<Transport>> open_datagrams(const std::string&, const std::string&, int) override {
      return no();
    }
    Result<int> tcp_port(const std::string&, int) override { return no(); }
    double now_s() const override { return 0.0; }
    Result<void> advance_to(double) override { return no(); }
    bool is_virtual() const override { return true; }
    Result<void> mount(const RigRecordRequest&) override { return no(); }
    bool flashes() const override { return false; }
    Result<void> flash(const std::string&) override { return no(); }
  } nowhere;
  const auto motor = Registry<MotorKind>::instance().find(b.motor_adapter)->make(b.table("motor"), nowhere);
  if (!motor) return Unexpected(motor.error());
  // A command between the two would end a record in its middle, as a fault of the rig.
  if (const double takes = (*motor)->velocity_limit_rad_per_s(); b.limits.velocity_max_rad_per_s > takes)
    return fail(ErrorCode::config,
                fmt::format("velocity_max_rad_per_s = {} in [limits], and the drive takes no more than {} rad/s in either direction (velocity_set or velocity_max_rad_per_s of [motor])",
                            shortest(b.limits.velocity_max_rad_per_s), shortest(takes)),
                b.root.find("limits")->find("velocity_max_rad_per_s")->where, "lower it to " + shortest(takes) + ", or correct the limits of the drive");
  const auto reference =
      Registry<ReferenceKind>::instance().find(b.reference_adapter)->make(b.table("reference"), nowhere);
  if (!reference) return Unexpected(reference.error());
  FORCEGATE_CHECK_OK(check_reference_figures(b));
  const auto board = Registry<BoardKind>::instance().find(b.board_adapter)->make(b.table("board"), nowhere);
  if (!board) return Unexpected(board.error());
  return each_port_once(b);
}

}  // namespace forcegate
