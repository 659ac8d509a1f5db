#include "adapters/modbus/modbus_line.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <modbus/modbus.h>
#include <sys/file.h>
#include <sys/select.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <thread>

#include "adapters/transport/descriptor.h"
#include "hil/base/text.h"

namespace forcegate::modbus {
namespace {

// Rates that libmodbus 3.1.6 knows; any other one silently becomes 9600.
constexpr std::array kRates{1200u,   2400u,   4800u,   9600u,   19200u,  38400u,  57600u,
                            115200u, 230400u, 460800u, 500000u, 576000u, 921600u, 1000000u};

double monotonic_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void wait_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

}  // namespace

struct ModbusLine::Context {
  modbus_t* bus = nullptr;
  Descriptor lock;
  ~Context() {
    if (bus == nullptr) return;
    modbus_close(bus);
    modbus_free(bus);
  }
};

ModbusLine::ModbusLine(LineOptions options) : options_(std::move(options)) {}
ModbusLine::~ModbusLine() = default;

std::string ModbusLine::name() const {
  return options_.tcp ? fmt::format("modbus-tcp:{}:{}", options_.host, options_.tcp_port)
                      : fmt::format("modbus-rtu:{} {}", options_.path, options_.serial.baud);
}

// What a person can do about it.
std::string ModbusLine::help_with(int number) const {
  switch (number) {
    case ECONNRESET:
    case EPIPE:
    case EIO:
    case EBADF:
    case ENXIO: return "check cable and power of the drive";
    case ECONNREFUSED: return "check host and tcp_port, and that the drive's Modbus server is on";
    case EHOSTUNREACH:
    case ENETUNREACH: return "check host, and that this machine is in the drive's network";
    case ETIMEDOUT:
    case EMBBADCRC:
    case EMBBADDATA:
    case EMBBADSLAVE:
      return options_.tcp ? "check power and network of the drive, host and tcp_port; or raise response_timeout_ms"
                          : "check power, cable and termination, baud, parity and slave; or raise response_timeout_ms";
    case EMBXILFUN:
    case EMBXILADD:
    case EMBXILVAL: return "check addr, type, read_fc and write_fc under [motor.reg] against the drive's manual";
    default: return "look up in the drive's manual when it answers so";
  }
}

Error ModbusLine::error_of(int number, const std::string& what) const {
  const bool late = number == ETIMEDOUT;
  const bool gone =
      number == ECONNRESET || number == EPIPE || number == EIO || number == EBADF || number == ENXIO;
  return {late ? ErrorCode::timeout : ErrorCode::device,
          what + ": " +
              (late   ? "no answer"
               : gone ? "the link is gone"
                      : modbus_strerror(number)),
          "motor: " + name(), help_with(number)};
}

Result<void> ModbusLine::connect() {
  close();
  auto context = std::make_unique<Context>();
  if (options_.tcp) {
    context->bus = modbus_new_tcp(options_.host.c_str(), options_.tcp_port);
  } else {
    if (std::find(kRates.begin(), kRates.end(), options_.serial.baud) == kRates.end())
      return fail(ErrorCode::config, fmt::format("Modbus RTU cannot run at {} baud", options_.serial.baud),
                  "motor: " + name(), "use 9600, 19200, 38400, 57600 or 115200");
    if (options_.lock) {
      // libmodbus does not lock; pyserial and our own serial layer respect flock.
      context->lock = Descriptor(::open(options_.path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
      if (!context->lock)
        return fail(ErrorCode::device, "cannot open the serial port " + printable_utf8(options_.path) + ": " + system_text(errno),
                    "motor: " + name(), "check the cable and that you belong to the group dialout");
      if (flock(context->lock.get(), LOCK_EX | LOCK_NB) != 0)
        return fail(ErrorCode::device, "another program holds the serial port " + printable_utf8(options_.path), "motor: " + name(),
                    "close it there");
    }
    const char parity = options_.serial.parity == LineParity::even  ? 'E'
                        : options_.serial.parity == LineParity::odd ? 'O'
                                                                    : 'N';
    context->bus =
        modbus_new_rtu(options_.path.c_str(), static_cast<int>(options_.serial.baud), parity, 8, 1);
  }
  if (context->bus == nullptr) return Unexpected(error_of(errno, "cannot prepare the Modbus link"));
  modbus_t* bus = context->bus;
  modbus_set_slave(bus, options_.slave);
  const auto set = [bus](auto function, int ms) {
    function(bus, static_cast<std::uint32_t>(ms / 1000), static_cast<std::uint32_t>(ms % 1000 * 1000));
  };
  set(modbus_set_response_timeout, options_.response_timeout_ms);
  set(modbus_set_byte_timeout, options_.byte_timeout_ms);
  modbus_set_error_recovery(bus, MODBUS_ERROR_RECOVERY_NONE);  // drain() does more than PROTOCOL would
  if (modbus_connect(bus) != 0) return Unexpected(error_of(errno, "cannot connect"));
  if (modbus_get_socket(bus) >= FD_SETSIZE)
    return fail(ErrorCode::internal, "too many open files for Modbus", "motor: " + name(),
                "end other work of this process, or of its parent: its limit is " + std::to_string(FD_SETSIZE));
  context_ = std::move(context);
  return {};
}

void ModbusLine::close() noexcept { context_.reset(); }

void ModbusLine::before_request() {
  if (options_.min_gap_ms > 0) {
    const double wait_s = last_end_s_ + options_.min_gap_ms * 1e-3 - monotonic_s();
    if (wait_s > 0.0) wait_ms(static_cast<int>(wait_s * 1e3) + 1);
  }
  if (const int n = modbus_flush(context_->bus); n > 0) drained_bytes_ += static_cast<std::uint64_t>(n);
}

void ModbusLine::drain() {
  if (context_ == nullptr) return;
  wait_ms(options_.worst_reply_ms);
  for (int empty = 0, rounds = 0; empty < 2 && rounds < 20; ++rounds) {
    // The serial flush of libmodbus does not tell how much it threw away; reading does.
    std::uint8_t trash[512];
    const int fd = modbus_get_socket(context_->bus);
    fd_set set;
    FD_ZERO(&set);
    FD_SET(fd, &set);
    timeval none{0, 5000};
    ssize_t n = 0;
    if (select(fd + 1, &set, nullptr, nullptr, &none) > 0) n = ::read(fd, trash, sizeof trash);
    if (n > 0) {
      drained_bytes_ += static_cast<std::uint64_t>(n);
      empty = 0;
    } else {
      ++empty;
    }
  }
  modbus_flush(context_->bus);
}

Result<std::vector<std::uint16_t>> ModbusLine::read(int function, int address, int count) {
  if (context_ == nullptr) return Unexpected(error_of(EBADF, "cannot read"));
  before_request();
  std::vector<std::uint16_t> words(static_cast<std::size_t>(count));
  const int n = function == 4 ? modbus_read_input_registers(context_->bus, address, count, words.data())
                              : modbus_read_registers(context_->bus, address, count, words.data());
  const int number = errno;
  last_end_s_ = monotonic_s();
  if (n != count)
    return Unexpected(error_of(number, fmt::format("reading registers {:#06x}+{}", address, count)));
  return words;
}

Result<void> ModbusLine::write(int function, int address, std::span<const std::uint16_t> words) {
  if (context_ == nullptr) return Unexpected(error_of(EBADF, "cannot write"));
  before_request();
  const int n = function == 6 ? modbus_write_register(context_->bus, address, words[0])
                              : modbus_write_registers(context_->bus, address, static_cast<int>(words.size()),
                                                       words.data());
  const int number = errno;
  last_end_s_ = monotonic_s();
  if (n < 1) return Unexpected(error_of(number, fmt::format("writing register {:#06x}", address)));
  return {};
}

Result<std::vector<std::uint16_t>> ModbusLine::write_and_read(int write_address,
                                                              std::span<const std::uint16_t> words,
                                                              int read_address, int count) {
  if (context_ == nullptr) return Unexpected(error_of(EBADF, "cannot exchange"));
  before_request();
  std::vector<std::uint16_t> out(static_cast<std::size_t>(count));
  const int n = modbus_write_and_read_registers(context_->bus, write_address, static_cast<int>(words.size()),
                                                words.data(), read_address, count, out.data());
  const int number = errno;
  last_end_s_ = monotonic_s();
  if (n != count)
    return Unexpected(error_of(number, fmt::format("exchanging registers {:#06x}", read_address)));
  return out;
}

}  // namespace forcegate::modbus
