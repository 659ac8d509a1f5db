// Runs the example firmware on this machine: arduino_host LINK, where its serial port appears.

#include <fcntl.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <vector>

#include "tests/support/arduino/Arduino.h"

namespace {

int g_line = -1;
std::vector<std::uint8_t> g_received;

}  // namespace

SerialPort Serial;

unsigned long micros() {
  static const auto start = std::chrono::steady_clock::now();
  return static_cast<std::uint32_t>(
      std::chrono::duration_cast<std::chrono::microseconds>(std::chrono::steady_clock::now() - start)
          .count());
}

int analogRead(std::uint8_t) {
  static int code = 0;
  return code = (code + 1) % 1024;
}

void SerialPort::begin(unsigned long) {}
int SerialPort::available() {
  std::uint8_t bytes[256];
  const ssize_t n = ::read(g_line, bytes, sizeof bytes);
  if (n > 0) g_received.insert(g_received.end(), bytes, bytes + n);
  return static_cast<int>(g_received.size());
}
int SerialPort::read() {
  if (g_received.empty()) return -1;
  const int byte = g_received.front();
  g_received.erase(g_received.begin());
  return byte;
}
int SerialPort::availableForWrite() { return 512; }
std::size_t SerialPort::write(std::uint8_t byte) { return write(&byte, 1); }
std::size_t SerialPort::write(const std::uint8_t* bytes, std::size_t n) {
  std::size_t done = 0;
  while (done < n) {
    const ssize_t written = ::write(g_line, bytes + done, n - done);
    if (written > 0) done += static_cast<std::size_t>(written);
    pollfd p{g_line, POLLOUT, 0};
    if (written <= 0 && ::poll(&p, 1, 1000) <= 0) break;
  }
  return done;
}

int main(int argc, char** argv) {
  g_line = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK);
  if (argc != 2 || g_line < 0 || grantpt(g_line) != 0 || unlockpt(g_line) != 0) return 2;
  const char* const name = ptsname(g_line);
  const int keeper = open(name, O_RDWR | O_NOCTTY);  // the terminal lives between two programs
  termios raw{};
  tcgetattr(keeper, &raw);
  cfmakeraw(&raw);
  tcsetattr(keeper, TCSANOW, &raw);
  if (symlink(name, argv[1]) != 0) return 2;
  setup();
  for (;;) {
    loop();
    usleep(100);
  }
}
