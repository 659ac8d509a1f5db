#include "adapters/transport/serial.h"

#include <asm/termbits.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/ioctl.h>

#include <cerrno>

#include "hil/base/text.h"

namespace forcegate {
namespace {

Result<void> make_raw(int fd, const SerialSettings& s, const std::string& where) {
  termios2 t{};
  if (ioctl(fd, TCGETS2, &t) != 0)
    return fail(ErrorCode::device, "not a serial port: " + system_text(errno), where);
  t.c_iflag = 0;
  t.c_oflag = 0;
  t.c_lflag = 0;
  t.c_cflag = CS8 | CREAD | CLOCAL | BOTHER;
  if (s.parity != Parity::none) t.c_cflag |= PARENB;
  if (s.parity == Parity::odd) t.c_cflag |= PARODD;
  t.c_ispeed = t.c_ospeed = s.baud;
  t.c_cc[VMIN] = 1;  // with O_NONBLOCK an idle line is EAGAIN, and 0 bytes mean that it was hung up
  t.c_cc[VTIME] = 0;
  if (ioctl(fd, TCSETS2, &t) != 0 || ioctl(fd, TCGETS2, &t) != 0)
    return fail(ErrorCode::device, "the port refuses its settings: " + system_text(errno), where);
  const unsigned tolerance = s.baud / 50;
  if (t.c_ospeed + tolerance < s.baud || t.c_ospeed > s.baud + tolerance)
    return fail(
        ErrorCode::device,
        "the port runs at " + std::to_string(t.c_ospeed) + " instead of " + std::to_string(s.baud) + " baud",
        where, "choose a rate that the adapter can make");
  return {};
}

}  // namespace

Result<std::unique_ptr<Transport>> open_serial(const std::filesystem::path& port,
                                               const SerialSettings& settings) {
  const std::string where = port.string();
  Descriptor fd(open(port.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!fd)
    return fail(ErrorCode::device, "cannot open the serial port " + printable_utf8(where) + ": " + system_text(errno), where,
                "check the cable and that you belong to the group dialout");
  if (flock(fd.get(), LOCK_EX | LOCK_NB) != 0)
    return fail(ErrorCode::device, "another program holds the serial port " + printable_utf8(where), where, "close it there");
  FORCEGATE_CHECK_OK(make_raw(fd.get(), settings, where));
  ioctl(fd.get(), TCFLSH, 2 /* both directions */);
  return std::make_unique<DescriptorTransport>(std::move(fd),
                                               "serial:" + where + " " + std::to_string(settings.baud));
}

Result<PseudoTerminal> open_pseudo_terminal() {
  Descriptor fd(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  char name[128] = "";
  if (!fd || grantpt(fd.get()) != 0 || unlockpt(fd.get()) != 0 || ptsname_r(fd.get(), name, sizeof name) != 0)
    return fail(ErrorCode::io, "cannot make a pseudo terminal: " + system_text(errno));
  PseudoTerminal terminal;
  terminal.slave = name;
  terminal.master = std::make_unique<DescriptorTransport>(std::move(fd), std::string("pty:") + name);
  return terminal;
}

}  // namespace forcegate
