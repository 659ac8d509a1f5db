#include "hil/rig/park_guard.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstring>

namespace forcegate {
namespace {

constexpr char kBeat = 'b', kDismissed = 'q';

// Until the harness says goodbye or falls silent. True: the motor is to be stopped.
bool watch(int fd, double silence_s) {
  for (;;) {
    pollfd p{fd, POLLIN, 0};
    const int wait_ms = silence_s > 0.0 ? static_cast<int>(std::ceil(silence_s * 1e3)) : -1;
    const int ready = ::poll(&p, 1, wait_ms);
    if (ready < 0 && errno == EINTR) continue;
    if (ready == 0) return true;
    char bytes[256];
    const ssize_t n = ::read(fd, bytes, sizeof bytes);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return true;
    if (std::memchr(bytes, kDismissed, static_cast<std::size_t>(n)) != nullptr) return false;
  }
}

}  // namespace

Result<void> ParkGuard::start(std::function<void()> stop_motor, double silence_s) {
  dismiss();
  int ends[2], ready[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)  // a pipe would end us by a signal when the guard has left
    return fail(ErrorCode::io, std::string("no pair of sockets: ") + std::strerror(errno));
  if (pipe2(ready, O_CLOEXEC) != 0) {
    close(ends[0]);
    close(ends[1]);
    return fail(ErrorCode::io, std::string("no pipe: ") + std::strerror(errno));
  }
  child_ = fork();
  if (child_ < 0) {
    for (const int fd : {ends[0], ends[1], ready[0], ready[1]}) close(fd);
    return fail(ErrorCode::io,
                std::string("the process that parks the motor cannot be started: ") + std::strerror(errno));
  }
  if (child_ == 0) {
    setsid();  // neither Ctrl-C nor the end of the terminal reaches it
    for (const int s : {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGQUIT}) ::signal(s, SIG_IGN);
    const int in = fcntl(ends[0], F_DUPFD, 200), told = fcntl(ready[1], F_DUPFD, 200);
    dup2(in, 3);
    dup2(told, 4);
    close_range(5, ~0U, 0);  // whatever else was open belongs to the harness: its locks must die with it
    const int null = ::open("/dev/null", O_RDWR);
    for (int fd = 0; fd < 3; ++fd) dup2(null, fd);
    (void)!::write(4, &kBeat, 1);
    close(4);
    if (watch(3, silence_s)) stop_motor();
    _exit(0);
  }
  close(ends[0]);
  close(ready[1]);
  line_ = ends[1];
  char answer = 0;
  while (::read(ready[0], &answer, 1) < 0 && errno == EINTR) {
  }
  close(ready[0]);
  if (answer != kBeat) {
    dismiss();
    return fail(ErrorCode::internal, "the process that parks the motor did not start");
  }
  return {};
}

bool ParkGuard::beat() noexcept {
  return line_ < 0 || send(line_, &kBeat, 1, MSG_NOSIGNAL | MSG_DONTWAIT) == 1 || errno == EAGAIN;
}

void ParkGuard::dismiss() noexcept {
  if (line_ < 0) return;
  (void)send(line_, &kDismissed, 1, MSG_NOSIGNAL | MSG_DONTWAIT);
  close(line_);
  line_ = -1;
  while (waitpid(child_, nullptr, 0) < 0 && errno == EINTR) {
  }
  child_ = -1;
}

}  // namespace forcegate
