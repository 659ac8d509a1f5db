#pragma once
// What the plant does with whichever reference sensor is on the bench.

#include <memory>
#include <string>
#include <string_view>

#include "rigs/emulated/twins/wire.h"

namespace forcegate::emulated {

class ReferenceTwin {
 public:
  virtual ~ReferenceTwin() = default;
  /// "ATI serial": what a person calls it.
  virtual std::string_view name() const = 0;
  /// Datagrams and a web page instead of a terminal.
  virtual bool is_on_network() const { return false; }
  /// Understands what the harness has sent.
  virtual void serve(WireEnd& end, double t_s) = 0;
  /// One row of the plant: sends the records that are complete until then.
  virtual void row(double t_s, double force_N, bool saturated) = 0;
  virtual void restart_clock(double t_s) = 0;
  virtual void power_cycle() = 0;
};

struct ReferenceTwinOptions {
  std::string adapter = "ati_serial";
  double counts_per_N = 1000.0;
  unsigned baud = 38400;
  double rate_Hz = 1000.0;
  int udp_port = 0, http_port = 0, slave = 10;
  std::string serial = "FT-T-1";
};

}  // namespace forcegate::emulated
