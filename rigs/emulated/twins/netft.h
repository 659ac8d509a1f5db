#pragma once
// ATI Net F/T box as its host sees it: raw data transfer over UDP (port 49152 on a real one) and a page with its
// configuration. All fields big-endian.
//   request: u16 0x1234 | u16 command (0 stop, 2 stream, 0x41 clear latch, 0x42 bias) | u32 samples, 0 = endless
//   record:  u32 RDT sequence (from 1 with each start) | u32 F/T sequence | u32 status | i32 Fx Fy Fz Tx Ty Tz

#include "rigs/emulated/twins/reference_twin.h"

namespace forcegate::emulated {

class NetFt final : public ReferenceTwin {
 public:
  NetFt(const ReferenceTwinOptions& o, Wire& wire) : o_(o), wire_(wire) {}
  std::string_view name() const override { return "Net F/T"; }
  bool is_on_network() const override { return true; }
  void serve(WireEnd& end, double t_s) override;
  void row(double t_s, double force_N, bool saturated) override;
  void restart_clock(double t_s) override { next_s_ = t_s; }
  void power_cycle() override;

  /// GET of any page: netftapi2.xml, or 404.
  void serve_page(Wire& wire, WireEnd& end, double t_s) const;
  static Bytes record(std::uint32_t rdt, std::uint32_t ft, std::uint32_t status, std::int32_t counts_Fz);

 private:
  ReferenceTwinOptions o_;
  Wire& wire_;
  bool streaming_ = false;
  std::uint32_t left_ = 0, rdt_ = 0, ft_ = 1000000;
  double next_s_ = 0.0, bias_N_ = 0.0, force_N_ = 0.0, frozen_N_ = 0.0;
  bool was_frozen_ = false;
};

}  // namespace forcegate::emulated
