#pragma once
// ATI Digital F/T as its host sees it on RS-485: holding registers behind Modbus RTU, and after function 0x46 a stream
// of gage records that a jam of zero bytes ends. Wire addresses from 0.
//   0x0000-0x0005 active gains, 0x0006-0x000B active offsets (writable once function 0x6A 0xAA has unlocked them)
//   0x001D status, 0x00E3 + 192 (n - 1) calibration n of 168 words
//   record: gages G0 G2 G4 G1 G3 G5, i16 big-endian | bit 7 error, bits 6-0 sum of the 12 bytes modulo 128
// The twin has one calibration; its matrix turns pairs of gages into pairs of axes.

#include <array>

#include "rigs/emulated/twins/modbus_server.h"
#include "rigs/emulated/twins/reference_twin.h"

namespace forcegate::emulated {

class DigitalFt final : public ReferenceTwin, private RegisterBank {
 public:
  DigitalFt(const ReferenceTwinOptions& o, Wire& wire);
  std::string_view name() const override { return "ATI digital"; }
  void serve(WireEnd& end, double t_s) override;
  void row(double t_s, double force_N, bool saturated) override;
  void restart_clock(double t_s) override { next_s_ = t_s; }
  void power_cycle() override;

  using Gages = std::array<std::int16_t, 6>;
  static Bytes record(const Gages& gages, bool error);
  /// Gages that the matrix turns into that many counts along Fz.
  static Gages gages_of(double counts_Fz);
  /// The 168 words of its calibration.
  static std::array<std::uint16_t, 168> calibration(const std::string& serial, std::int32_t counts_per_N);

 private:
  std::optional<std::uint16_t> read(int address) override;
  int write(int address, std::uint16_t word) override;
  Bytes answer(std::span<const std::uint8_t> request);

  ReferenceTwinOptions o_;
  Wire& wire_;
  std::array<std::uint16_t, 12> active_{};
  std::array<std::uint16_t, 168> calibration_;
  bool streaming_ = false, unlocked_ = false, was_frozen_ = false;
  std::size_t zeros_ = 0;
  double next_s_ = 0.0, frozen_N_ = 0.0;
};

}  // namespace forcegate::emulated
