#pragma once
// The server side of Modbus RTU and TCP from the byte tables of the specification (Modbus Application Protocol V1.1b3,
// Modbus over Serial Line V1.02). Shares nothing with the adapter.
//   RTU: slave u8 | function u8 | data | CRC-16 (polynomial 0xA001, start 0xFFFF), low byte first
//   TCP: transaction u16 | protocol u16 = 0 | length u16 | unit u8 | function u8 | data          all big-endian

#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "rigs/emulated/twins/wire.h"

namespace forcegate::emulated {

std::uint16_t modbus_crc16(std::span<const std::uint8_t> bytes);

/// Holding registers behind the server. Functions 3, 4, 6, 16 and 23.
class RegisterBank {
 public:
  virtual ~RegisterBank() = default;
  /// nullopt: there is no such register (exception 2).
  virtual std::optional<std::uint16_t> read(int address) = 0;
  /// 0, or the exception code.
  virtual int write(int address, std::uint16_t word) = 0;
  virtual void written() {}  ///< after all registers of one request
};

/// Reply to a request without slave address and checksum ("PDU"); an exception reply for what cannot be done.
Bytes modbus_reply(RegisterBank& bank, std::span<const std::uint8_t> request);

class ModbusServer {
 public:
  ModbusServer(RegisterBank& bank, Wire& wire, int slave, bool tcp)
      : bank_(bank), wire_(wire), slave_(static_cast<std::uint8_t>(slave)), tcp_(tcp) {}

  /// Takes whole requests off the front of what was received and answers them.
  void serve(WireEnd& end, double t_s);
  std::function<void()> on_request;  ///< a valid request arrived (the drive's own watchdog)

 private:
  void serve_rtu(WireEnd& end, double t_s);
  void serve_tcp(WireEnd& end, double t_s);
  Bytes answer(std::span<const std::uint8_t> request, double t_s);

  RegisterBank& bank_;
  Wire& wire_;
  std::uint8_t slave_;
  bool tcp_;
};

}  // namespace forcegate::emulated
