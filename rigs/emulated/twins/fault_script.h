#pragma once
// Faults of the wires between harness and instruments, as a bench of twins declares them in [[twins.fault]]:
//   device = "motor" | "reference" | "board",  kind, at_s, for_s or count, amount
// A message is one reply or one record of a stream.

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "hil/base/config_node.h"
#include "hil/base/rng.h"

namespace forcegate::emulated {

enum class WireFault {
  delay,        ///< the message comes `amount` ms late
  drop,         ///< the message is lost
  drop_byte,    ///< one byte of it is lost
  duplicate,    ///< the message comes twice
  corrupt,      ///< one bit of it is flipped
  garbage,      ///< `amount` random bytes before it
  truncate,     ///< only its first half comes
  exception,    ///< motor: Modbus exception `amount` instead of the reply
  wrong_slave,  ///< motor, RTU: the reply of another slave
  stall,        ///< the device neither listens nor answers
  unplug,       ///< the line is cut
  saturation,   ///< reference: overload; board: converter at its last code
  frozen,       ///< the device repeats its last value
  reset,        ///< the device starts anew: stream off, registers and state forgotten
};

struct FaultEntry {
  std::string device;
  WireFault kind = WireFault::drop;
  double at_s = 0.0;  ///< plant time of the record
  double for_s = std::numeric_limits<double>::infinity();
  std::uint64_t count = std::numeric_limits<std::uint64_t>::max();  ///< messages of a record at most
  double amount = 0.0;
  std::string where;  ///< of at_s in the file; "": none was written
};

const std::vector<std::string>& fault_names();
/// "motor", "reference", "board": who can have it; a fault that does nothing would pass for one that was survived.
std::vector<std::string> devices_with(WireFault kind);

class FaultScript {
 public:
  static constexpr double kGarbageMax = 4096;  ///< bytes

  static Result<FaultEntry> read_entry(const ConfigNode& table);
  /// DEVICE KIND AT_S FOR_S COUNT AMOUNT of the control socket; COUNT 0: any number of messages. Errors: usage.
  static Result<FaultEntry> read_words(std::span<const std::string> words);
  void add(FaultEntry entry) { entries_.push_back({std::move(entry), 0}); }
  void clear() { entries_.clear(); }
  /// Times and messages count from here.
  void begin_record();

  /// Whether a fault of that kind is on for a device now; a hit counts against its number of messages.
  bool hit(const std::string& device, WireFault kind, double t_s, double* amount = nullptr);
  /// The same without counting.
  bool active(const std::string& device, WireFault kind, double t_s) const;

 private:
  struct Live {
    FaultEntry entry;
    std::uint64_t used = 0;
  };
  static bool covers(const Live& live, const std::string& device, WireFault kind, double t_s);
  std::vector<Live> entries_;
};

}  // namespace forcegate::emulated
