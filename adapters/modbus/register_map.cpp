#include "adapters/modbus/register_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

#include "hil/base/text.h"

namespace forcegate::modbus {
namespace {

constexpr const char* kGuide = "docs/bench.md";

std::vector<std::uint16_t> split_words(const Register& reg, std::uint32_t bits) {
  if (reg.size() == 1) return {static_cast<std::uint16_t>(bits)};
  const auto high = static_cast<std::uint16_t>(bits >> 16), low = static_cast<std::uint16_t>(bits);
  if (reg.high_word_first) return {high, low};
  return {low, high};
}

void range_of(WordType type, double& low, double& high) {
  switch (type) {
    case WordType::u16: low = 0, high = 65535; break;
    case WordType::i16: low = -32768, high = 32767; break;
    case WordType::u32: low = 0, high = 4294967295.0; break;
    case WordType::i32: low = -2147483648.0, high = 2147483647.0; break;
    case WordType::f32: low = -3.4e38, high = 3.4e38; break;
  }
}

Result<Register> read_register(const std::string& name, const ConfigNode& node, int base) {
  Register r;
  r.name = name;
  if (node.kind != ConfigNode::Kind::table)
    return fail(ErrorCode::config, fmt::format("register '{}' must be a table", name), node.where);
  ConfigReader in(node, fmt::format("register '{}'", name), kGuide);
  std::int64_t address = 0, read_fc = 3, write_fc = 16;
  std::string type = "u16", words = "high_first";
  in.integer("addr", address, base, 0xFFFF + base, ConfigReader::required);
  in.choice("type", type, {"u16", "i16", "u32", "i32", "f32"});
  in.choice("words", words, {"high_first", "low_first"});
  in.integer("read_fc", read_fc, 3, 4);
  in.integer("write_fc", write_fc, 6, 16);
  in.number("scale", r.scale, -1e12, 1e12);
  in.number("offset", r.offset, -1e12, 1e12);
  if (const ConfigNode* limits = in.array("limits")) {
    if (limits->items.size() != 2 || !(limits->items[0].number < limits->items[1].number))
      in.complain(*limits, fmt::format("'limits' of register '{}' must be two rising numbers", name),
                  "for example limits = [-10.0, 10.0]");
    else
      r.low = limits->items[0].number, r.high = limits->items[1].number;
  }
  r.type = type == "u16"   ? WordType::u16
           : type == "i16" ? WordType::i16
           : type == "u32" ? WordType::u32
           : type == "i32" ? WordType::i32
                           : WordType::f32;
  r.high_word_first = words == "high_first";
  r.address = static_cast<int>(address) - base;
  r.read_function = static_cast<int>(read_fc);
  r.write_function = static_cast<int>(write_fc);
  if (write_fc != 6 && write_fc != 16) in.complain(node, "'write_fc' must be 6 or 16");
  if (r.scale == 0.0) in.complain(node, fmt::format("'scale' of register '{}' must not be 0", name));
  if (r.size() == 2 && r.address == 0xFFFF)
    in.complain(node, fmt::format("register '{}' has 32 bits and cannot begin at the last address", name));
  if (r.size() == 2 && r.write_function == 6)
    in.complain(node, fmt::format("register '{}' has 32 bits and cannot be written by function 6", name),
                "use write_fc = 16");
  FORCEGATE_CHECK_OK(in.finish());
  return r;
}

// What would fail when the step is written is found when the file is read: an emergency stop has no second chance.
Result<void> check_step(const std::string& command, const Step& step, const Register& reg, const std::string& where) {
  if (!step.raw) {
    if (command == "run" && step.reg == "velocity_set") return {};
    return fail(ErrorCode::config, fmt::format("command '{}' has no value for register '{}'", command, step.reg), where,
                "add value = N; only the step of 'velocity_set' in 'run' takes the velocity instead");
  }
  if (command == "run" && step.reg == "velocity_set")
    return fail(ErrorCode::config, "command 'run' has a fixed value for register 'velocity_set'", where,
                "leave 'value' out: this step takes the velocity that is asked for");
  if (!encode_raw(reg, *step.raw))
    return fail(ErrorCode::config, fmt::format("{} of command '{}' does not fit register '{}'", *step.raw, command, step.reg), where,
                "correct the value, or 'type' of the register");
  if (command == "emergency" && step.after_ms > 0)
    return fail(ErrorCode::config, "command 'emergency' waits before it writes", where,
                "leave 'after_ms' out: an emergency stop is written at once");
  return {};
}

Result<std::vector<Step>> read_steps(const std::string& name, const ConfigNode& list,
                                     const RegisterMap& map) {
  std::vector<Step> steps;
  static const std::vector<std::string> kCommands{"enable", "run", "stop", "emergency", "fault_reset"};
  if (std::find(kCommands.begin(), kCommands.end(), name) == kCommands.end())
    return fail(ErrorCode::config, fmt::format("[motor.cmd] knows no command '{}'", printable_utf8(name)), list.where,
                "it is one of: " + join(kCommands, ", "));
  if (list.kind != ConfigNode::Kind::array || list.items.empty())
    return fail(ErrorCode::config, fmt::format("command '{}' must be a list of writes", name), list.where,
                "for example [ { reg = \"control\", value = 0x20 } ]");
  for (const ConfigNode& item : list.items) {
    if (item.kind != ConfigNode::Kind::table)
      return fail(ErrorCode::config, fmt::format("command '{}' must hold tables", name), item.where);
    ConfigReader in(item, fmt::format("command '{}'", name), kGuide);
    Step step;
    std::int64_t raw = 0, after = 0;
    in.text("reg", step.reg, ConfigReader::required);
    if (in.integer("value", raw, -2147483648LL, 4294967295LL)) step.raw = raw;
    in.integer("after_ms", after, 0, 10000);
    step.after_ms = static_cast<int>(after);
    FORCEGATE_CHECK_OK(in.finish());
    if (!map.reg.contains(step.reg))
      return fail(ErrorCode::config,
                  fmt::format("command '{}' names the unknown register '{}'", name, step.reg), item.where,
                  "declare it under [motor.reg]");
    FORCEGATE_CHECK_OK(check_step(name, step, map.reg.at(step.reg), item.where));
    steps.push_back(step);
  }
  if (name == "run" && std::count_if(steps.begin(), steps.end(), [](const Step& s) { return !s.raw; }) != 1)
    return fail(ErrorCode::config, "command 'run' must write the velocity once", list.where,
                "give it one step { reg = \"velocity_set\" } without a value");
  return steps;
}

Result<Condition> read_condition(const std::string& name, const ConfigNode& node, const RegisterMap& map) {
  Condition c;
  if (node.kind != ConfigNode::Kind::table)
    return fail(ErrorCode::config, fmt::format("state '{}' must be a table", name), node.where);
  ConfigReader in(node, fmt::format("state '{}'", name), kGuide);
  std::int64_t mask = 0xFFFFFFFFLL, equals = 0, differs = 0;
  in.text("reg", c.reg, ConfigReader::required);
  in.integer("mask", mask, 0, 0xFFFFFFFFLL);
  const bool equal = in.integer("equals", equals, 0, 0xFFFFFFFFLL);
  const bool not_equal = in.integer("not_equals", differs, 0, 0xFFFFFFFFLL);
  if (equal == not_equal)
    in.complain(node, fmt::format("state '{}' needs either 'equals' or 'not_equals'", name));
  FORCEGATE_CHECK_OK(in.finish());
  if (!map.reg.contains(c.reg))
    return fail(ErrorCode::config, fmt::format("state '{}' names the unknown register '{}'", name, c.reg),
                node.where);
  c.mask = static_cast<std::uint32_t>(mask);
  c.equal = equal;
  c.value = static_cast<std::uint32_t>(equal ? equals : differs);
  const std::uint32_t bits = c.mask & (map.reg.at(c.reg).size() == 1 ? 0xFFFFU : 0xFFFFFFFFU);
  const char* const always = equal ? "never" : "always";
  if (bits == 0)
    return fail(ErrorCode::config, fmt::format("the mask 0x{:x} of state '{}' looks at no bit of register '{}'", c.mask, name, c.reg),
                node.where, "set the bits that tell the state");
  if ((c.value & ~bits) != 0)
    return fail(ErrorCode::config,
                fmt::format("state '{}' {} holds: 0x{:x} has bits outside of 0x{:x}, which is all it sees of register '{}'", name, always,
                            c.value, bits, c.reg),
                node.where, "give the value as it stands in the register, under 'mask', not shifted down");
  return c;
}

// Functions 3 and 4 read two tables of the drive; whatever is written lies in the one of function 3.
Result<void> refuse_overlap(const RegisterMap& map, const std::string& where) {
  std::set<std::string> written{map.heartbeat.reg, map.heartbeat.drive_timeout_reg};
  for (const auto& [name, steps] : map.cmd)
    for (const Step& step : steps) written.insert(step.reg);
  const auto one_table = [&](const Register& a, const Register& b) {
    const auto holding = [&](const Register& r) { return r.read_function == 3 || written.contains(r.name); };
    return a.read_function == b.read_function || (holding(a) && holding(b));
  };
  for (const auto& [a_name, a] : map.reg)
    for (const auto& [b_name, b] : map.reg)
      if (a_name < b_name && one_table(a, b) && a.address < b.address + b.size() && b.address < a.address + a.size())
        return fail(ErrorCode::config, fmt::format("registers '{}' and '{}' overlap", a_name, b_name), where,
                    "32-bit registers take two addresses");
  return {};
}

Result<void> require(bool there, const std::string& what, const std::string& where, std::string hint) {
  if (there) return {};
  return fail(ErrorCode::config, "the register map has no " + what, where, std::move(hint));
}

Result<std::vector<std::uint16_t>> encode_timeout(const Register& reg, double timeout_ms, const std::string& where) {
  auto words = encode(reg, timeout_ms);
  if (words) return words;
  return fail(ErrorCode::config, "drive_timeout_ms: " + words.error().text, where, "give another time, or correct type, scale and limits of the register");
}

Result<Heartbeat> read_heartbeat(const ConfigNode& node, const RegisterMap& map) {
  Heartbeat h;
  ConfigReader in(node, "[motor.heartbeat]", kGuide);
  std::int64_t missed = 3, timeout_ms = 0;
  in.text("reg", h.reg, ConfigReader::required);
  in.boolean("fc23", h.read_write_together);
  in.integer("max_missed", missed, 1, 20);
  in.text("drive_timeout_reg", h.drive_timeout_reg, ConfigReader::required);
  in.integer("drive_timeout_ms", timeout_ms, 20, 5000, ConfigReader::required);
  FORCEGATE_CHECK_OK(in.finish());
  for (const std::string& name : {h.reg, h.drive_timeout_reg})
    if (!map.reg.contains(name))
      return fail(ErrorCode::config, fmt::format("[motor.heartbeat] names the unknown register '{}'", name),
                  node.where);
  if (map.reg.at(h.reg).size() != 1)
    return fail(ErrorCode::config, "the heartbeat register must have 16 bits", node.where);
  // Of a register in coarser steps another timeout would be armed, and 0 mostly means none at all.
  constexpr double kAsDeclared_ms = 0.5;
  const Register& timeout = map.reg.at(h.drive_timeout_reg);
  FORCEGATE_TRY(const auto words, encode_timeout(timeout, static_cast<double>(timeout_ms), node.where));
  FORCEGATE_TRY(const double held_ms, decode(timeout, words));
  if (!(std::abs(held_ms - static_cast<double>(timeout_ms)) <= kAsDeclared_ms))
    return fail(ErrorCode::config, fmt::format("drive_timeout_ms = {} becomes {} ms in register '{}', which counts in steps of {} ms", timeout_ms, shortest(held_ms), timeout.name, shortest(std::abs(1.0 / timeout.scale))),
                node.where, "give a multiple of its step, or correct 'scale' of the register (raw = scale * milliseconds + offset)");
  h.max_missed = static_cast<int>(missed);
  h.drive_timeout_ms = static_cast<int>(timeout_ms);
  return h;
}

}  // namespace

Result<std::vector<std::uint16_t>> encode(const Register& reg, double value) {
  if (!std::isfinite(value))
    return fail(ErrorCode::safety, fmt::format("register '{}' was to be written with no number", reg.name));
  if ((reg.low && value < *reg.low) || (reg.high && value > *reg.high))
    return fail(ErrorCode::safety,
                fmt::format("{} for register '{}' is outside its limits", shortest(value), reg.name));
  const double raw = reg.scale * value + reg.offset;
  double low = 0, high = 0;
  range_of(reg.type, low, high);
  const double rounded = reg.type == WordType::f32 ? raw : std::nearbyint(raw);
  if (!(rounded >= low && rounded <= high))
    return fail(ErrorCode::config, fmt::format("{} does not fit register '{}'", shortest(value), reg.name));
  if (reg.type == WordType::f32) return split_words(reg, std::bit_cast<std::uint32_t>(static_cast<float>(raw)));
  return split_words(reg, static_cast<std::uint32_t>(static_cast<std::int64_t>(rounded)));
}

Result<std::vector<std::uint16_t>> encode_raw(const Register& reg, std::int64_t raw) {
  double low = 0, high = 0;
  range_of(reg.type, low, high);
  const auto as_double = static_cast<double>(raw);
  if (reg.type != WordType::f32 && !(as_double >= low && as_double <= high))
    return fail(ErrorCode::config, fmt::format("{} does not fit register '{}'", raw, reg.name));
  return split_words(reg, static_cast<std::uint32_t>(raw));
}

std::uint32_t decode_bits(const Register& reg, std::span<const std::uint16_t> words) {
  if (reg.size() == 1) return words[0];
  const std::uint32_t high = reg.high_word_first ? words[0] : words[1],
                      low = reg.high_word_first ? words[1] : words[0];
  return high << 16 | low;
}

Result<double> decode(const Register& reg, std::span<const std::uint16_t> words) {
  const std::uint32_t bits = decode_bits(reg, words);
  double raw = 0.0;
  switch (reg.type) {
    case WordType::u16:
    case WordType::u32: raw = bits; break;
    case WordType::i16: raw = static_cast<std::int16_t>(bits); break;
    case WordType::i32: raw = static_cast<std::int32_t>(bits); break;
    case WordType::f32: raw = std::bit_cast<float>(bits); break;
  }
  if (!std::isfinite(raw))
    return fail(ErrorCode::device, fmt::format("register '{}' holds no number (0x{:08x})", reg.name, bits));
  return (raw - reg.offset) / reg.scale;
}

std::vector<ReadBlock> merge_reads(const std::vector<const Register*>& registers, int gap, int longest) {
  std::vector<const Register*> sorted = registers;
  std::sort(sorted.begin(), sorted.end(), [](const Register* a, const Register* b) {
    return a->read_function != b->read_function ? a->read_function < b->read_function
                                                : a->address < b->address;
  });
  std::vector<ReadBlock> blocks;
  for (const Register* r : sorted) {
    if (!blocks.empty()) {
      ReadBlock& last = blocks.back();
      const int end = std::max(last.address + last.count, r->address + r->size());
      if (last.function == r->read_function && r->address <= last.address + last.count + gap &&
          end - last.address <= longest) {
        last.count = end - last.address;
        continue;
      }
    }
    blocks.push_back({r->address, r->size(), r->read_function});
  }
  return blocks;
}

Result<RegisterMap> read_register_map(ConfigReader& motor, int address_base) {
  RegisterMap map;
  const ConfigNode* registers = motor.table("reg", ConfigReader::required);
  const ConfigNode* commands = motor.table("cmd", ConfigReader::required);
  const ConfigNode* states = motor.table("state", ConfigReader::required);
  const ConfigNode* heartbeat = motor.table("heartbeat", ConfigReader::required);
  if (!motor.good()) {
    FORCEGATE_CHECK_OK(motor.finish());
    return map;
  }
  for (std::size_t i = 0; i < registers->names.size(); ++i) {
    FORCEGATE_TRY(map.reg[registers->names[i]],
                  read_register(registers->names[i], registers->items[i], address_base));
  }
  for (std::size_t i = 0; i < commands->names.size(); ++i) {
    FORCEGATE_TRY(map.cmd[commands->names[i]], read_steps(commands->names[i], commands->items[i], map));
  }
  for (std::size_t i = 0; i < states->names.size(); ++i) {
    FORCEGATE_TRY(map.state[states->names[i]], read_condition(states->names[i], states->items[i], map));
  }
  FORCEGATE_CHECK_OK(require(map.reg.contains("position"), "register 'position' (rad)", registers->where,
                             "displacement comes from reading back the position, never from the set-point"));
  FORCEGATE_CHECK_OK(
      require(map.reg.contains("velocity_set"), "register 'velocity_set' (rad/s)", registers->where, {}));
  const Register& velocity = map.reg.at("velocity_set");
  FORCEGATE_CHECK_OK(require(velocity.low.has_value(), "limits for 'velocity_set'", registers->where, "add limits = [-V, V] in rad/s"));
  if (*velocity.low >= 0.0 || *velocity.high <= 0.0)
    return fail(ErrorCode::config, fmt::format("the limits of 'velocity_set' are [{}, {}] rad/s: the wheel must turn either way", shortest(*velocity.low), shortest(*velocity.high)),
                registers->find("velocity_set")->where, "write limits = [-V, V] in rad/s");
  for (const char* name : {"enable", "run", "stop", "emergency"})
    FORCEGATE_CHECK_OK(require(map.cmd.contains(name), fmt::format("command '{}'", name), commands->where,
                               "every drive must be able to stop"));
  FORCEGATE_CHECK_OK(require(map.state.contains("fault"), "state 'fault'", states->where, {}));
  FORCEGATE_TRY(map.heartbeat, read_heartbeat(*heartbeat, map));
  FORCEGATE_CHECK_OK(refuse_overlap(map, registers->where));
  return map;
}

}  // namespace forcegate::modbus
