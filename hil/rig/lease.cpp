#include "hil/rig/lease.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <utility>

#include "hil/base/text.h"

namespace forcegate {
namespace {

double wall_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

Result<int> open_lease(const std::string& bench_id, int flags) {
  const std::filesystem::path folder = bench_runtime_folder();
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::string name;
  for (const char c : bench_id)
    name += std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' || c == '.' ? c : '_';
  const std::filesystem::path path = folder / ("bench-" + name + ".lease");
  const int fd = ::open(path.c_str(), flags | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (fd < 0 && errno != ENOENT)
    return fail(ErrorCode::io,
                std::string("the lease of the bench cannot be opened: ") + std::strerror(errno),
                path.string());
  return fd;
}

LeaseHolder read_holder(int fd) {
  char text[1024] = "";
  LeaseHolder h;
  if (::pread(fd, text, sizeof text - 1, 0) <= 0) return h;
  std::istringstream in(text);
  in >> h.pid >> h.token >> h.since_s >> h.heartbeat_s;
  std::getline(in >> std::ws, h.purpose);
  h.purpose = printable_utf8(h.purpose);
  h.token = printable_utf8(h.token);
  return h;
}

}  // namespace

std::filesystem::path bench_runtime_folder() {
  if (const char* folder = std::getenv("XDG_RUNTIME_DIR"); folder != nullptr && *folder == '/')
    return std::filesystem::path(folder) / "forcegate";
  std::error_code ignored;
  return std::filesystem::temp_directory_path(ignored) / ("forcegate-" + std::to_string(geteuid()));
}

Lease::Lease(Lease&& other) noexcept : fd_(std::exchange(other.fd_, -1)), holder_(std::move(other.holder_)) {}

Lease& Lease::operator=(Lease&& other) noexcept {
  if (this != &other) {
    if (fd_ >= 0) close(fd_);
    fd_ = std::exchange(other.fd_, -1);
    holder_ = std::move(other.holder_);
  }
  return *this;
}

Lease::~Lease() {
  if (fd_ < 0) return;
  (void)!ftruncate(fd_, 0);
  close(fd_);
}

Result<Lease> Lease::take(const std::string& bench_id, const std::string& purpose) {
  FORCEGATE_TRY(const int fd, open_lease(bench_id, O_RDWR | O_CREAT));
  Lease lease;
  lease.fd_ = fd;
  if (flock(fd, LOCK_EX | LOCK_NB) != 0) {
    const LeaseHolder h = read_holder(fd);
    lease.fd_ = -1;
    close(fd);
    return fail(ErrorCode::device, fmt::format("the bench is held by process {} ({})", h.pid, h.purpose),
                "bench " + bench_id, "wait for it, or see forcegate bench who");
  }
  lease.holder_.pid = getpid();
  lease.holder_.purpose = purpose;
  lease.holder_.since_s = lease.holder_.heartbeat_s = wall_s();
  lease.holder_.token =
      fmt::format("{:x}-{:x}", getpid(), static_cast<std::uint64_t>(lease.holder_.since_s * 1e6));
  lease.write_holder();
  return lease;
}

void Lease::write_holder() noexcept {
  const std::string text = fmt::format("{} {} {:.3f} {:.3f} {}\n", holder_.pid, holder_.token,
                                       holder_.since_s, holder_.heartbeat_s, holder_.purpose);
  (void)!ftruncate(fd_, 0);
  (void)!::pwrite(fd_, text.data(), text.size(), 0);
}

void Lease::beat() noexcept {
  if (fd_ < 0) return;
  const double now_s = wall_s();
  if (now_s - holder_.heartbeat_s < 1.0) return;
  holder_.heartbeat_s = now_s;
  write_holder();
}

Result<std::optional<LeaseHolder>> lease_holder(const std::string& bench_id) {
  FORCEGATE_TRY(const int fd, open_lease(bench_id, O_RDONLY));
  if (fd < 0) return std::optional<LeaseHolder>();
  std::optional<LeaseHolder> holder;
  if (flock(fd, LOCK_SH | LOCK_NB) != 0) holder = read_holder(fd);
  close(fd);
  return holder;
}

}  // namespace forcegate
