#pragma once
// The twin's end of a cable: a pseudo terminal, a TCP server or a UDP port. Faults of the script happen here, byte by byte.

#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "adapters/transport/descriptor.h"
#include "hil/base/rng.h"
#include "rigs/emulated/twins/fault_script.h"

namespace forcegate::emulated {

using Bytes = std::vector<std::uint8_t>;

/// One plugged end: the pseudo terminal, or one TCP client.
struct WireEnd {
  Descriptor fd;
  std::uint64_t received = 0, sent = 0;  ///< bytes since the client attached
  Bytes rest;                            ///< bytes that the device has not understood yet
};

class Wire {
 public:
  /// `wall_delays`: a delayed message waits by the clock on the wall (request and reply), else by the plant's time.
  Wire(std::string device, FaultScript& faults, bool wall_delays)
      : device_(std::move(device)), faults_(faults), wall_delays_(wall_delays), rng_(1, "wire/" + device_) {}

  /// Pseudo terminal behind a symbolic link.
  Result<void> open_terminal(const std::filesystem::path& link);
  /// TCP server on loopback; 0: any free port, which is returned.
  Result<int> open_server(int port);

  /// UDP on loopback; 0: any free port, which is returned. Answers go to whoever has sent last.
  Result<int> open_datagrams(int port);

  /// What the device does with received bytes; takes what it understands off the front.
  std::function<void(WireEnd&)> on_bytes;

  void poll_descriptors(std::vector<int>& out) const;
  /// Reads whatever is there and hands it to the device.
  void receive(double t_s);
  /// One message to one end (nullptr: the terminal), through the faults.
  void send(WireEnd* end, Bytes message, double t_s);
  /// Sends what has become due. Returns the wall time until the next delayed message, s; negative: none.
  double send_due(double t_s);
  void apply_plug(double t_s);

  bool unplugged() const { return unplugged_; }
  WireEnd* terminal() { return terminal_.fd ? &terminal_ : nullptr; }
  void attach();  ///< a new client: counters from zero
  const std::string& device() const { return device_; }
  FaultScript& faults() { return faults_; }

 private:
  struct Delayed {
    double due_s;
    WireEnd* end;
    Bytes message;
  };
  double clock_s(double t_s) const;
  void put(WireEnd& end, std::span<const std::uint8_t> bytes);
  bool read_end(WireEnd& end, double t_s);

  std::string device_;
  FaultScript& faults_;
  bool wall_delays_;
  Rng rng_;
  std::filesystem::path link_;
  WireEnd terminal_;
  Descriptor keeper_;  ///< an open slave, so that the terminal lives between clients
  Descriptor listener_;
  std::deque<WireEnd> clients_;
  std::deque<Delayed> delayed_;
  bool unplugged_ = false, datagrams_ = false;
  std::uint16_t peer_port_ = 0;  ///< of the last sender of a datagram, network byte order
};

}  // namespace forcegate::emulated
