#include "rigs/emulated/twins/modbus_server.h"

#include <algorithm>

namespace forcegate::emulated {
namespace {

constexpr int kIllegalFunction = 1, kIllegalAddress = 2, kIllegalValue = 3;

int word_at(std::span<const std::uint8_t> b, std::size_t at) { return b[at] << 8 | b[at + 1]; }
void put_word(Bytes& out, int word) {
  out.push_back(static_cast<std::uint8_t>(word >> 8));
  out.push_back(static_cast<std::uint8_t>(word));
}
Bytes exception(std::uint8_t function, int code) {
  return {static_cast<std::uint8_t>(function | 0x80U), static_cast<std::uint8_t>(code)};
}

bool read_words(RegisterBank& bank, int address, int count, Bytes& out) {
  out.push_back(static_cast<std::uint8_t>(2 * count));
  for (int i = 0; i < count; ++i) {
    const auto word = bank.read(address + i);
    if (!word) return false;
    put_word(out, *word);
  }
  return true;
}

// Length of an RTU request without its CRC; 0 when more bytes are needed, -1 when the function is unknown.
int rtu_length(std::span<const std::uint8_t> b) {
  if (b.size() < 2) return 0;
  switch (b[1]) {
    case 3:
    case 4:
    case 6: return 6;
    case 16: return b.size() < 7 ? 0 : 7 + b[6];
    case 23: return b.size() < 11 ? 0 : 11 + b[10];
    default: return -1;
  }
}

}  // namespace

std::uint16_t modbus_crc16(std::span<const std::uint8_t> bytes) {
  std::uint16_t crc = 0xFFFF;
  for (const std::uint8_t b : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ b);
    for (int i = 0; i < 8; ++i) crc = static_cast<std::uint16_t>((crc >> 1) ^ ((crc & 1U) ? 0xA001U : 0U));
  }
  return crc;
}

Bytes modbus_reply(RegisterBank& bank, std::span<const std::uint8_t> q) {
  if (q.empty()) return {};
  const std::uint8_t function = q[0];
  Bytes out{function};
  switch (function) {
    case 3:
    case 4: {
      if (q.size() != 5 || word_at(q, 3) < 1 || word_at(q, 3) > 125)
        return exception(function, kIllegalValue);
      return read_words(bank, word_at(q, 1), word_at(q, 3), out) ? out : exception(function, kIllegalAddress);
    }
    case 6: {
      if (q.size() != 5) return exception(function, kIllegalValue);
      if (const int code = bank.write(word_at(q, 1), static_cast<std::uint16_t>(word_at(q, 3))); code != 0)
        return exception(function, code);
      bank.written();
      out.insert(out.end(), q.begin() + 1, q.end());
      return out;
    }
    case 16: {
      if (q.size() < 6) return exception(function, kIllegalValue);
      const int address = word_at(q, 1), count = word_at(q, 3);
      if (count < 1 || count > 123 || q[5] != 2 * count || q.size() != 6U + q[5])
        return exception(function, kIllegalValue);
      for (int i = 0; i < count; ++i) {
        const auto word = static_cast<std::uint16_t>(word_at(q, 6 + 2 * static_cast<std::size_t>(i)));
        if (const int code = bank.write(address + i, word); code != 0) return exception(function, code);
      }
      bank.written();
      out.insert(out.end(), q.begin() + 1, q.begin() + 5);
      return out;
    }
    case 23: {
      if (q.size() < 10) return exception(function, kIllegalValue);
      const int read_address = word_at(q, 1), read_count = word_at(q, 3), address = word_at(q, 5),
                count = word_at(q, 7);
      if (read_count < 1 || read_count > 125 || count < 1 || count > 121 || q[9] != 2 * count ||
          q.size() != 10U + q[9])
        return exception(function, kIllegalValue);
      for (int i = 0; i < count; ++i) {
        const auto word = static_cast<std::uint16_t>(word_at(q, 10 + 2 * static_cast<std::size_t>(i)));
        if (const int code = bank.write(address + i, word); code != 0) return exception(function, code);
      }
      bank.written();
      return read_words(bank, read_address, read_count, out) ? out : exception(function, kIllegalAddress);
    }
    default: return exception(function, kIllegalFunction);
  }
}

Bytes ModbusServer::answer(std::span<const std::uint8_t> request, double t_s) {
  if (on_request) on_request();
  double code = 0.0;
  if (wire_.faults().hit("motor", WireFault::exception, t_s, &code))
    return exception(request[0], std::clamp(static_cast<int>(code), 1, 11));
  return modbus_reply(bank_, request);
}

void ModbusServer::serve(WireEnd& end, double t_s) { tcp_ ? serve_tcp(end, t_s) : serve_rtu(end, t_s); }

void ModbusServer::serve_rtu(WireEnd& end, double t_s) {
  Bytes& in = end.rest;
  while (in.size() >= 4) {
    const int length = rtu_length(in);
    if (length == 0) return;
    const auto whole = static_cast<std::size_t>(length) + 2;
    if (length < 0 || whole > 256) {
      in.erase(in.begin());  // garbage: look for a request from the next byte on
      continue;
    }
    if (in.size() < whole) return;
    const std::uint16_t crc = modbus_crc16({in.data(), static_cast<std::size_t>(length)});
    if (in[whole - 2] != (crc & 0xFFU) || in[whole - 1] != crc >> 8) {
      in.erase(in.begin());
      continue;
    }
    const Bytes request(in.begin(), in.begin() + length);
    in.erase(in.begin(), in.begin() + static_cast<std::ptrdiff_t>(whole));
    if (request[0] != slave_) continue;
    Bytes reply{slave_};
    if (wire_.faults().hit("motor", WireFault::wrong_slave, t_s))
      reply[0] = static_cast<std::uint8_t>(slave_ + 1);
    const Bytes body = answer({request.data() + 1, request.size() - 1}, t_s);
    reply.insert(reply.end(), body.begin(), body.end());
    const std::uint16_t sum = modbus_crc16(reply);
    reply.push_back(static_cast<std::uint8_t>(sum));
    reply.push_back(static_cast<std::uint8_t>(sum >> 8));
    wire_.send(&end, std::move(reply), t_s);
  }
}

void ModbusServer::serve_tcp(WireEnd& end, double t_s) {
  Bytes& in = end.rest;
  while (in.size() >= 8) {
    const int protocol = word_at(in, 2), length = word_at(in, 4);
    if (protocol != 0 || length < 2 || length > 254) {
      in.clear();
      return;
    }
    const auto whole = static_cast<std::size_t>(6 + length);
    if (in.size() < whole) return;
    const Bytes request(in.begin(), in.begin() + static_cast<std::ptrdiff_t>(whole));
    in.erase(in.begin(), in.begin() + static_cast<std::ptrdiff_t>(whole));
    const Bytes body = answer({request.data() + 7, request.size() - 7}, t_s);
    Bytes reply(request.begin(), request.begin() + 4);
    if (wire_.faults().hit("motor", WireFault::wrong_slave, t_s))
      reply[1] = static_cast<std::uint8_t>(reply[1] ^ 1U);
    put_word(reply, static_cast<int>(body.size()) + 1);
    reply.push_back(request[6]);
    reply.insert(reply.end(), body.begin(), body.end());
    wire_.send(&end, std::move(reply), t_s);
  }
}

}  // namespace forcegate::emulated
