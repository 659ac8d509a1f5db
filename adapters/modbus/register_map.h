#pragma once
// A drive's registers as the bench file declares them: address, type, word order, scale, limits; commands as lists of
// writes; states as masks. Pure: no bus here.
//
//   raw = scale * value + offset          value in rad, rad/s ... ; raw as the drive counts

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hil/base/config_node.h"
#include "hil/base/result.h"

namespace forcegate::modbus {

enum class WordType { u16, i16, u32, i32, f32 };

struct Register {
  std::string name;
  int address = 0;  ///< as it goes over the wire (address_base already subtracted)
  WordType type = WordType::u16;
  bool high_word_first = true;
  int read_function = 3, write_function = 16;
  double scale = 1.0, offset = 0.0;
  std::optional<double> low, high;  ///< engineering units, checked before a write
  int size() const { return type == WordType::u16 || type == WordType::i16 ? 1 : 2; }
};

/// One write of a command. Without a raw value, which only velocity_set in `run` may lack, it takes the velocity.
struct Step {
  std::string reg;
  std::optional<std::int64_t> raw;
  int after_ms = 0;  ///< wait before the write
};

struct Condition {
  std::string reg;
  std::uint32_t mask = 0xFFFFFFFFU;
  std::uint32_t value = 0;
  bool equal = true;  ///< false: the state holds when the masked value differs
};

struct Heartbeat {
  std::string reg;                   ///< writable and readable, 16 bits
  bool read_write_together = false;  ///< function 23
  int max_missed = 3;
  std::string drive_timeout_reg;
  int drive_timeout_ms = 0;
};

struct RegisterMap {
  std::map<std::string, Register> reg;
  std::map<std::string, std::vector<Step>> cmd;  ///< enable, run, stop, emergency, fault_reset
  std::map<std::string, Condition> state;        ///< running, fault
  Heartbeat heartbeat;
};

/// Value into words, low or high first. ErrorCode::safety outside the limits or when it is no number, ErrorCode::config
/// when it does not fit the type.
Result<std::vector<std::uint16_t>> encode(const Register& reg, double value);
Result<std::vector<std::uint16_t>> encode_raw(const Register& reg, std::int64_t raw);
/// words.size() == reg.size(). ErrorCode::device for a float that is no number.
Result<double> decode(const Register& reg, std::span<const std::uint16_t> words);
std::uint32_t decode_bits(const Register& reg, std::span<const std::uint16_t> words);

/// Neighbouring registers read in one message.
struct ReadBlock {
  int address = 0, count = 0, function = 3;
};
/// Merges registers of one read function that are at most `gap` apart; blocks of at most `longest` registers.
std::vector<ReadBlock> merge_reads(const std::vector<const Register*>& registers, int gap, int longest);

/// Reads [motor.reg.*], [motor.cmd], [motor.state] and [motor.heartbeat]. Refuses overlaps, a 32-bit register at 0xFFFF,
/// scale 0, commands that nobody gives, that name unknown registers or hold a value that does not fit its register, an
/// emergency that waits, a run that does not write velocity_set once, and a map without position, velocity_set (with
/// limits), stop, emergency, run, fault, heartbeat or the drive's own timeout.
Result<RegisterMap> read_register_map(ConfigReader& motor, int address_base);

}  // namespace forcegate::modbus
