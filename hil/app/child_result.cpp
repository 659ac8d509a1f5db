#include "hil/app/child_result.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <nlohmann/json.hpp>

#include "hil/interface/firmware_guard.h"

namespace forcegate {
namespace {

constexpr std::size_t kLargestAnswer = std::size_t{64} << 20;

[[noreturn]] void serve(const std::function<Result<std::string>()>& work, FirmwareGuard* guard, int out, double cpu_s) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit no_core{0, 0}, cpu{static_cast<rlim_t>(std::ceil(cpu_s)), static_cast<rlim_t>(std::ceil(cpu_s)) + 1};
  setrlimit(RLIMIT_CORE, &no_core);
  setrlimit(RLIMIT_CPU, &cpu);
  std::signal(SIGINT, SIG_IGN);
  g_firmware_guard = guard;
  const auto made = work();
  nlohmann::json answer;
  if (made)
    answer["text"] = *made;
  else
    answer["error"] = {static_cast<int>(made.error().code), made.error().text, made.error().where, made.error().hint};
  const std::string text = answer.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t n = write(out, text.data() + done, text.size() - done);
    if (n < 0 && errno != EINTR) break;
    if (n > 0) done += static_cast<std::size_t>(n);
  }
  _exit(0);
}

// Everything up to the end of file, or nothing when the time is over.
bool read_all(int in, double wall_s, std::string& text) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(wall_s));
  char buffer[1 << 16];
  while (text.size() < kLargestAnswer) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    pollfd wanted{in, POLLIN, 0};
    if (left <= 0 || (poll(&wanted, 1, static_cast<int>(left)) == 0)) return false;
    const ssize_t n = read(in, buffer, sizeof buffer);
    if (n == 0) return true;
    if (n > 0) text.append(buffer, static_cast<std::size_t>(n));
  }
  return false;
}

}  // namespace

Result<std::string> run_in_child(const std::function<Result<std::string>()>& work, double cpu_s, double wall_s) {
  int ends[2];
  void* memory = mmap(nullptr, sizeof(FirmwareGuard), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED || pipe2(ends, O_CLOEXEC) != 0) {
    if (memory != MAP_FAILED) munmap(memory, sizeof(FirmwareGuard));
    return fail(ErrorCode::io, std::string("no worker could be started: ") + std::strerror(errno));
  }
  auto* guard = new (memory) FirmwareGuard;
  const pid_t pid = fork();
  if (pid == 0) {
    close(ends[0]);
    serve(work, guard, ends[1], cpu_s);
  }
  close(ends[1]);
  std::string text;
  const bool in_time = pid > 0 && read_all(ends[0], wall_s, text);
  close(ends[0]);
  int status = 0;
  if (pid > 0) {
    if (!in_time) kill(pid, SIGKILL);
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
    }
  }
  const bool inside = guard->in_firmware.load() != 0;
  const std::uint32_t sample = guard->sample_index.load();
  munmap(memory, sizeof(FirmwareGuard));
  if (pid < 0) return fail(ErrorCode::io, "no worker could be started");
  if (!in_time || WIFSIGNALED(status)) {
    const std::string what = !in_time || WTERMSIG(status) == SIGXCPU ? "does not come back" : fmt::format("dies with signal {}", WTERMSIG(status));
    return fail(inside ? ErrorCode::firmware : ErrorCode::internal, inside ? fmt::format("the image {} in the block from sample {}", what, sample) : "the worker " + what);
  }
  const auto answer = nlohmann::json::parse(text, nullptr, false);
  if (answer.is_object() && answer.contains("text")) return answer["text"].get<std::string>();
  if (!answer.is_object() || !answer.contains("error"))
    return fail(inside ? ErrorCode::firmware : ErrorCode::internal, inside ? fmt::format("the image ends its process in the block from sample {}", sample) : "the worker gives no answer");
  const auto& e = answer["error"];
  return Unexpected(Error{static_cast<ErrorCode>(e[0].get<int>()), e[1], e[2], e[3]});
}

}  // namespace forcegate
