#pragma once
// What stands between a bench file and the instruments: where a named port leads, and what time it is. The real world
// opens serial ports and waits for the clock on the wall; a world of twins starts wire-level twins of the instruments
// and moves their time on, so that the same adapters run in virtual time.

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "hil/base/config_node.h"
#include "hil/base/registry.h"
#include "hil/base/result.h"
#include "hil/interface/rig.h"
#include "hil/interface/transport.h"

namespace forcegate {

enum class LineParity { none, even, odd };

/// A serial line with 8 data bits and one stop bit.
struct LineSettings {
  unsigned baud = 115200;
  LineParity parity = LineParity::none;
};

class BenchWorld {
 public:
  virtual ~BenchWorld() = default;

  /// Path of a serial port for a library that opens it itself; ErrorCode::config when the bench has no such port.
  virtual Result<std::string> serial_path(const std::string& port) = 0;
  /// The line as a byte stream, exclusively ours.
  virtual Result<std::unique_ptr<Transport>> open_line(const std::string& port,
                                                       const LineSettings& settings) = 0;
  /// A HID device: each write and read is one 64-byte report.
  virtual Result<std::unique_ptr<Transport>> open_hid(unsigned short vendor, unsigned short product,
                                                      const std::string& serial) = 0;
  /// Datagrams to and from one UDP port; each write and read is one datagram. Port 0: that of the world.
  virtual Result<std::unique_ptr<Transport>> open_datagrams(const std::string& device,
                                                            const std::string& host, int port) = 0;
  /// TCP port of a device that the bench file gives as 0 ("ask the world"); else the number itself.
  virtual Result<int> tcp_port(const std::string& device, int declared) = 0;

  /// Time of the bench, s, from an arbitrary zero; never runs backwards.
  virtual double now_s() const = 0;
  /// Returns at t_s or later, with every byte that the instruments have sent until then ready to be read.
  virtual Result<void> advance_to(double t_s) = 0;
  /// Time that moves only when advance_to is called.
  virtual bool is_virtual() const = 0;

  /// Lays the specimen in (twins) or checks that it may be played now (real).
  virtual Result<void> mount(const RigRecordRequest& request) = 0;
  /// Value of the option "attach" with which another process reaches the same instruments; "" when it needs none.
  virtual std::string guard_option() const { return {}; }
  /// Puts a firmware image on the board; nothing when flashes() is false: the board runs what it runs.
  virtual bool flashes() const = 0;
  virtual Result<void> flash(const std::string& image) = 0;
  /// How the firmware on the board fares. ended: "" while it runs. A real bench sees only what its wires say: not known.
  struct FirmwareFate {
    bool known = false;
    std::string ended;  ///< "crashed with signal SEGV after sample 40000"
  };
  virtual FirmwareFate firmware_fate() { return {}; }
};

struct BenchWorldKind {
  std::string name;  ///< "real", "twins"
  std::string doc;
  /// The whole bench file and options of the command line ("attach" = folder of a served bench).
  std::function<Result<std::unique_ptr<BenchWorld>>(const ConfigNode& bench,
                                                    const std::map<std::string, std::string>& options)>
      make;
};

}  // namespace forcegate
