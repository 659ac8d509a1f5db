#pragma once
// ATI stand-alone F/T controller on RS-232 as its host sees it: text commands ended by CR, echoed, prompt '>'; one
// record (QR) or a stream (QS) that any character stops. Bytes written from the tables of ATI 9620-05-CTL.
//   binary record: error u8 | six i16 big-endian | checksum u8 = sum modulo 256 when CD E
//   ASCII record:  error digit, six times comma and six-character signed number, CR LF (45 bytes)

#include <cstdint>
#include <string>

#include "rigs/emulated/twins/reference_twin.h"

namespace forcegate::emulated {

class AtiController final : public ReferenceTwin {
 public:
  AtiController(const ReferenceTwinOptions& p, Wire& wire) : p_(p), wire_(wire) {}

  std::string_view name() const override { return "ATI serial"; }
  void serve(WireEnd& end, double t_s) override;
  /// One row of the plant: sends the records whose last bit leaves the line until then.
  void row(double t_s, double force_N, bool saturated) override;
  void restart_clock(double t_s) override { next_s_ = t_s; }
  void power_cycle() override;
  bool streaming() const { return streaming_; }

  static Bytes binary_record(std::uint8_t error, double counts_Fz, bool checksum);
  static Bytes ascii_record(std::uint8_t error, double counts_Fz);

 private:
  std::string execute(const std::string& command);
  Bytes record(double t_s);

  ReferenceTwinOptions p_;
  Wire& wire_;
  bool binary_ = false, checksum_ = false, streaming_ = false;
  std::string line_;
  double force_N_ = 0.0, bias_N_ = 0.0, sampled_N_ = 0.0;
  bool saturated_ = false, sampled_saturated_ = false;
  double next_s_ = 0.0;  ///< instant at which the record on the line is complete
  double frozen_N_ = 0.0;
  bool was_frozen_ = false;
};

}  // namespace forcegate::emulated
