#include "hil/app/play/watched_task.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "hil/interface/firmware_guard.h"

namespace forcegate {
namespace {

constexpr std::size_t kLargestAnswer = std::size_t{256} << 20;
constexpr double kWaits = 0.05;  // share of processor time below which a process waits

// Shared between one worker and its parent.
struct WorkerPage {
  FirmwareGuard guard;
  std::atomic<std::uint32_t> progress{0};
  std::atomic<float> t_s{0.0f};
  std::atomic<std::uint32_t> other_thread{0};  ///< 1: the signal that ended the child met another thread than its first
  std::atomic<std::uint32_t> own_signal{0};    ///< 1: the child sent it to itself
  std::atomic<std::uint32_t> finished{0};      ///< 1: the child ends because its work is done
  std::atomic<std::uint32_t> pipe_lost{0};     ///< 1: somebody in the child closed the pipe of its answer
};

WorkerPage* g_page = nullptr;  // of a child

// Only what the parent cannot see: whose signal it was. Then the child dies of it as it would have.
void note_signal(int signal, siginfo_t* info, void*) {
  const pid_t self = getpid(), thread = gettid();
  g_page->other_thread.store(thread != self);
  g_page->own_signal.store((info->si_code == SI_USER || info->si_code == SI_TKILL || info->si_code == SI_QUEUE) && info->si_pid == self);
  std::signal(signal, SIG_DFL);
  syscall(SYS_tgkill, self, thread, signal);
}

void watch_signals(WorkerPage* page) {
  static unsigned char stack[65536];  // that of a firmware may be used up
  g_page = page;
  stack_t other{};
  other.ss_sp = stack;
  other.ss_size = sizeof stack;
  sigaltstack(&other, nullptr);
  struct sigaction action{};
  action.sa_sigaction = note_signal;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_NODEFER;
  for (const int signal : {SIGTERM, SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGPIPE, SIGSYS, SIGTRAP, SIGHUP, SIGQUIT, SIGUSR1, SIGUSR2, SIGALRM})
    sigaction(signal, &action, nullptr);
}

// Of the call that was running.
std::string place_of(const FirmwareGuard& guard) {
  if (guard.stage.load() == FirmwareStage::opening) return "while it was opened";
  if (guard.stage.load() == FirmwareStage::closing) return "while it was closed";
  const std::uint64_t first = guard.sample_index.load(), n = guard.sample_count.load();
  return n > 1 ? fmt::format("in the block of samples {} to {}", first, first + n - 1) : fmt::format("at sample {}", first);
}

double now_s(clockid_t clock) {
  timespec t{};
  if (clock_gettime(clock, &t) != 0) return 0.0;
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double cpu_time_s(pid_t pid) {
  clockid_t clock;
  return clock_getcpuclockid(pid, &clock) == 0 ? now_s(clock) : 0.0;
}

// What comes over the pipe: a mark, then the text or the error as JSON.
constexpr char kText = 'T', kError = 'E';

std::string answer_of(const Result<std::string>& made) {
  if (made) return kText + *made;
  const Error& e = made.error();
  return kError + nlohmann::json{static_cast<int>(e.code), e.text, e.where, e.hint}.dump(
                      -1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// An image that closes descriptors which it did not open may also leave another file under the number of the pipe.
bool is_same_file(int descriptor, const struct stat& file) {
  struct stat now{};
  return fstat(descriptor, &now) == 0 && now.st_dev == file.st_dev && now.st_ino == file.st_ino;
}

// Every process of the harness is waited for by whoever started it, so that one which is left is the image's.
bool has_children() { return waitpid(-1, nullptr, WNOHANG) >= 0; }

// noexcept: an exception ends the child where it was thrown, inside the image or not, and never in the parent's own frames.
[[noreturn]] void serve(const WatchedTask& task, WorkerPage* page, int out) noexcept {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  setpgid(0, 0);  // what an image starts is of this group and ends with it
  const pid_t self = getpid();
  struct stat pipe{};
  fstat(out, &pipe);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  std::signal(SIGINT, SIG_IGN);  // Ctrl-C is the parent's to handle
  watch_signals(page);
  const int null = open("/dev/null", O_RDWR);
  dup2(null, STDIN_FILENO);
  dup2(null, STDOUT_FILENO);  // what a firmware prints is not part of any answer
  g_firmware_guard.store(&page->guard);
  Result<std::string> made = task.work([page](double t_s) {
    page->t_s.store(static_cast<float>(t_s), std::memory_order_relaxed);
    page->progress.fetch_add(1, std::memory_order_relaxed);
  });
  if (getpid() != self) _exit(70);  // a process that the image split off and that came back here
  if (made && page->guard.loaded.load() != 0 && has_children())
    made = fail(ErrorCode::firmware, "the firmware leaves a process behind that it started", task.id, "end it and wait for it before the image is closed; a board has no processes");
  const std::string text = answer_of(made);
  page->finished.store(1);
  if (!is_same_file(out, pipe)) {
    page->pipe_lost.store(1);
    _exit(70);
  }
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t n = write(out, text.data() + at, text.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) _exit(70);
    at += static_cast<std::size_t>(n);
  }
  _exit(0);
}

class Pool {
 public:
  Pool(const std::vector<WatchedTask>& tasks, const WorkerOptions& options, const WorkerEvents& events)
      : tasks_(tasks), options_(options), events_(events), answers_(tasks.size()) {}

  std::vector<Result<std::string>> run() {
    unsigned workers =
        options_.workers > 0 ? options_.workers : std::max(1u, std::thread::hardware_concurrency());
    std::size_t next = 0;
    while (next < tasks_.size() || !running_.empty()) {
      if (cancelled()) {
        while (!running_.empty()) end(running_.back(), "interrupted", true);
        for (; next < tasks_.size(); ++next) answers_[next] = gone(next, ErrorCode::cancelled, "interrupted");
        break;
      }
      while (next < tasks_.size() && running_.size() < workers)
        if (const auto hung = hung_.find(tasks_[next].image); hung != hung_.end())
          give_up(next++, hung->second);
        else
          start(next++);
      if (!running_.empty()) wait();
    }
    return std::move(answers_);
  }

 private:
  struct Worker {
    std::size_t task = 0;
    pid_t pid = -1;
    int end = -1;  ///< readable once the process has ended
    int in = -1;   ///< -1 once it is read to its end
    WorkerPage* page = nullptr;
    std::string answer;
    std::uint64_t last_mark = 0;
    double cpu_at_mark_s = 0.0, wall_at_mark_s = 0.0;
    float shown_t_s = -1.0f;
  };

  bool cancelled() const { return options_.cancelled != nullptr && options_.cancelled->load(); }

  Result<std::string> gone(std::size_t task, ErrorCode code, std::string text) const {
    return fail(code, std::move(text), tasks_[task].id);
  }

  Result<std::string> not_started(std::size_t task) const {
    return gone(task, ErrorCode::io, std::string("no worker could be started: ") + std::strerror(errno));
  }

  void give_up(std::size_t task, const std::string& where) {
    answers_[task] = gone(task, ErrorCode::firmware, "not played: the firmware did not come back from " + where);
    if (events_.given_up) events_.given_up(task);
    if (events_.done) events_.done(task);
  }

  void start(std::size_t task) {
    int ends[2];
    void* memory =
        mmap(nullptr, sizeof(WorkerPage), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (memory == MAP_FAILED || pipe2(ends, O_CLOEXEC) != 0) {
      if (memory != MAP_FAILED) munmap(memory, sizeof(WorkerPage));
      answers_[task] = not_started(task);
      return;
    }
    auto* page = new (memory) WorkerPage;
    const pid_t pid = fork();
    if (pid > 0) setpgid(pid, pid);  // whoever comes first: from here on the group can be killed
    if (pid == 0) {
      close(ends[0]);
      serve(tasks_[task], page, ends[1]);
    }
    close(ends[1]);
    if (pid < 0) {
      close(ends[0]);
      munmap(memory, sizeof(WorkerPage));
      answers_[task] = not_started(task);
      return;
    }
    fcntl(ends[0], F_SETFL, O_NONBLOCK);
    Worker w;
    w.task = task;
    w.pid = pid;
    w.end = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
    w.in = ends[0];
    w.page = page;
    w.wall_at_mark_s = now_s(CLOCK_MONOTONIC);
    running_.push_back(std::move(w));
  }

  void wait() {
    std::vector<pollfd> polled;
    for (const Worker& w : running_) polled.insert(polled.end(), {{w.in, POLLIN, 0}, {w.end, POLLIN, 0}});
    poll(polled.data(), polled.size(), 100);
    for (std::size_t i = running_.size(); i-- > 0;) {
      Worker& w = running_[i];
      if (polled[2 * i].revents != 0) read_some(w);
      if (has_ended(w)) {
        finish(w);
        continue;
      }
      show(w);
      watch(w);
    }
  }

  static bool has_ended(const Worker& w) {
    siginfo_t end{};
    return waitid(P_PID, static_cast<id_t>(w.pid), &end, WEXITED | WNOHANG | WNOWAIT) != 0 || end.si_pid == w.pid;
  }

  // False when there is nothing to read now, or no more at all: then the pipe is closed, by which a child that writes beyond the largest answer ends.
  static bool read_some(Worker& w) {
    char buffer[65536];
    if (w.in < 0) return false;
    const ssize_t n = read(w.in, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) return true;
    if (n < 0 && errno == EAGAIN) return false;
    if (n > 0) w.answer.append(buffer, static_cast<std::size_t>(n));
    if (n > 0 && w.answer.size() <= kLargestAnswer) return true;
    close(w.in);
    w.in = -1;
    return false;
  }

  void show(Worker& w) {
    const float t_s = w.page->t_s.load(std::memory_order_relaxed);
    if (t_s == w.shown_t_s || !events_.progress) return;
    w.shown_t_s = t_s;
    events_.progress(w.task, t_s);
  }

  void watch(Worker& w) {
    const std::uint64_t mark = (static_cast<std::uint64_t>(w.page->progress.load()) << 32) +
                               w.page->guard.sample_index.load() + w.answer.size();
    const double cpu_s = cpu_time_s(w.pid), wall_s = now_s(CLOCK_MONOTONIC);
    if (mark != w.last_mark) {
      w.last_mark = mark;
      w.cpu_at_mark_s = cpu_s;
      w.wall_at_mark_s = wall_s;
      return;
    }
    const bool in_firmware = w.page->guard.in_firmware.load() != 0;
    if (!in_firmware) return;  // a calibration marks nothing for as long as it lasts
    const bool loops = cpu_s - w.cpu_at_mark_s > options_.hang_cpu_s;
    // On a busy machine a loop gets little time; what waits takes none.
    const double waited_s = wall_s - w.wall_at_mark_s;
    const bool blocked = waited_s > options_.blocked_s && cpu_s - w.cpu_at_mark_s < kWaits * waited_s;
    if (!loops && !blocked) return;
    const std::string how = loops ? fmt::format("endless loop, {:.0f} s of CPU time", options_.hang_cpu_s) : fmt::format("blocked for {:.0f} s", options_.blocked_s);
    if (const WatchedTask& task = tasks_[w.task]; !task.image.empty()) hung_.emplace(task.image, task.id);
    end(w, fmt::format("the firmware does not return {} ({})", place_of(w.page->guard), how), false);
  }

  void end(Worker& w, std::string text, bool interrupted) {
    reap(w);
    answers_[w.task] =
        gone(w.task, interrupted ? ErrorCode::cancelled : ErrorCode::firmware, std::move(text));
    release(w);
  }

  // The end of the process and not that of the pipe: whatever the image started may hold the pipe open.
  void finish(Worker& w) {
    while (read_some(w)) {
    }
    const int status = reap(w);
    answers_[w.task] =
        WIFEXITED(status) && WEXITSTATUS(status) == 0 && !w.answer.empty() ? answered(w) : ended(w, status);
    release(w);
  }

  static int reap(const Worker& w) {
    kill(-w.pid, SIGKILL);  // before it is waited for: until then nobody else can get the number of the group
    int status = 0;
    waitpid(w.pid, &status, 0);
    return status;
  }

  Result<std::string> answered(Worker& w) const {
    if (w.answer.front() == kText) return std::move(w.answer.erase(0, 1));
    const auto e = nlohmann::json::parse(w.answer.begin() + 1, w.answer.end(), nullptr, false);
    if (w.answer.front() != kError || !e.is_array() || e.size() != 4 || !e[0].is_number_integer() ||
        !e[1].is_string() || !e[2].is_string() || !e[3].is_string())
      return gone(w.task, ErrorCode::internal, "a worker gave no answer");
    return Unexpected(Error{static_cast<ErrorCode>(e[0].get<int>()), e[1], e[2], e[3]});
  }

  Result<std::string> ended(const Worker& w, int status) const {
    const std::string how =
        WIFSIGNALED(status)
            ? fmt::format("signal {} ({})",
                          sigabbrev_np(WTERMSIG(status)) ? sigabbrev_np(WTERMSIG(status)) : "?",
                          strsignal(WTERMSIG(status)))
            : fmt::format("exit code {}", WEXITSTATUS(status));
    const WorkerPage& page = *w.page;
    const bool inside = page.guard.in_firmware.load() != 0, loaded = page.guard.loaded.load() != 0;
    // The emergency stop of a bench ends whoever holds it, a terminal that is closed whoever runs in it; no firmware is judged by that.
    if (WIFSIGNALED(status) && (WTERMSIG(status) == SIGTERM || WTERMSIG(status) == SIGHUP) && page.own_signal.load() == 0)
      return gone(w.task, ErrorCode::cancelled, "stopped from outside: forcegate bench park, or a kill");
    if (inside && WIFSIGNALED(status) && page.other_thread.load() == 0)
      return gone(w.task, ErrorCode::firmware, fmt::format("the firmware crashed with {} {}", how, place_of(page.guard)));
    if (loaded && WIFSIGNALED(status) && page.other_thread.load() != 0)  // no thread of ours computes beside the image
      return gone(w.task, ErrorCode::firmware, fmt::format("a thread of the firmware crashed with {}", how));
    // Abort is how our own code ends itself, too.
    if (loaded && WIFSIGNALED(status) && page.own_signal.load() != 0 && WTERMSIG(status) != SIGABRT)
      return gone(w.task, ErrorCode::firmware, fmt::format("the firmware sent its process {}", how));
    if (loaded && page.pipe_lost.load() != 0)
      return gone(w.task, ErrorCode::firmware, "the firmware closed a file that it did not open, the pipe of its own worker process");
    if ((inside || loaded) && WIFEXITED(status) && page.finished.load() == 0)
      return gone(w.task, ErrorCode::firmware,
                  fmt::format("the firmware ended its process with {}{}", how, inside ? " " + place_of(page.guard) : std::string()));
    return gone(w.task, ErrorCode::internal, fmt::format("a worker ended with {} outside the firmware", how));
  }

  void release(Worker& w) {
    if (w.in >= 0) close(w.in);
    if (w.end >= 0) close(w.end);
    if (!answers_[w.task] && events_.died && w.page->guard.known.load() != 0) events_.died(w.task, w.page->guard);
    munmap(w.page, sizeof(WorkerPage));
    const std::size_t task = w.task;
    running_.erase(running_.begin() + (&w - running_.data()));
    if (events_.done) events_.done(task);
  }

  const std::vector<WatchedTask>& tasks_;
  const WorkerOptions& options_;
  const WorkerEvents& events_;
  std::vector<Result<std::string>> answers_;
  std::vector<Worker> running_;
  std::map<std::string, std::string> hung_;  ///< image, and the task that it did not come back from
};

}  // namespace

std::vector<Result<std::string>> run_watched(const std::vector<WatchedTask>& tasks,
                                             const WorkerOptions& options, const WorkerEvents& events) {
  return Pool(tasks, options, events).run();
}

}  // namespace forcegate
