#include "adapters/transport/child_process.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <thread>

#include "adapters/transport/descriptor.h"
#include "hil/base/text.h"

namespace forcegate {

Result<void> ChildProcess::start(const std::vector<std::string>& argv, const std::filesystem::path& folder,
                                 const std::filesystem::path& log) {
  const Descriptor null(open("/dev/null", O_RDONLY | O_CLOEXEC));
  const Descriptor out(open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
  if (!null || !out)
    return fail(ErrorCode::io, "cannot open the log of a program: " + system_text(errno), log.string());
  return launch(argv, folder, null.get(), out.get(), out.get());
}

Result<std::unique_ptr<Transport>> ChildProcess::start_connected(const std::vector<std::string>& argv,
                                                                 const std::filesystem::path& folder,
                                                                 const std::filesystem::path& log) {
  const Descriptor err(open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
  if (!err)
    return fail(ErrorCode::io, "cannot open the log of a program: " + system_text(errno), log.string());
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    return fail(ErrorCode::io, "no pair of sockets: " + system_text(errno), argv.front(), "too many files are open: see ulimit -n");
  Descriptor ours(ends[0]);
  const Descriptor theirs(ends[1]);
  fcntl(ours.get(), F_SETFL, O_NONBLOCK);
  FORCEGATE_CHECK_OK(launch(argv, folder, theirs.get(), theirs.get(), err.get()));
  return std::make_unique<DescriptorTransport>(std::move(ours), argv.front());
}

Result<void> ChildProcess::launch(const std::vector<std::string>& argv, const std::filesystem::path& folder,
                                  int in, int out, int err) {
  kill_and_reap();
  std::vector<char*> arguments;
  for (const std::string& a : argv) arguments.push_back(const_cast<char*>(a.c_str()));
  arguments.push_back(nullptr);
  const pid_t parent = getpid();
  const pid_t pid = fork();
  if (pid < 0) return fail(ErrorCode::io, "cannot start a process: " + system_text(errno), argv.front(),
                               "too many processes run or memory is short: see ulimit -u and free");
  if (pid == 0) {  // only async-signal-safe calls from here to execv
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) _exit(127);
    setpgid(0, 0);  // an interrupt from the keyboard is for the harness, which then ends us in order
    if (dup2(in, 0) < 0 || dup2(out, 1) < 0 || dup2(err, 2) < 0 || chdir(folder.c_str()) != 0) _exit(127);
    sigset_t none;
    sigemptyset(&none);
    sigprocmask(SIG_SETMASK, &none, nullptr);
    execv(arguments[0], arguments.data());
    _exit(127);
  }
  setpgid(pid, pid);  // whoever comes first: from here on the group can be killed
  pid_ = pid;
  reaped_ = false;
  return {};
}

std::optional<std::string> ChildProcess::ended() {
  if (!reaped_) {
    siginfo_t end{};
    if (waitid(P_PID, static_cast<id_t>(pid_), &end, WEXITED | WNOHANG | WNOWAIT) != 0 || end.si_pid != pid_) return std::nullopt;
    kill_and_reap();
  }
  if (WIFSIGNALED(status_)) {
    const int number = WTERMSIG(status_);
    const char* text = sigdescr_np(number);
    return "killed by signal " + std::to_string(number) + " (" + (text != nullptr ? text : "?") + ")";
  }
  return "exit code " + std::to_string(WEXITSTATUS(status_));
}

void ChildProcess::finish(double timeout_s) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
  while (!reaped_ && !ended() && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  kill_and_reap();
}

void ChildProcess::kill_and_reap() {
  if (reaped_) return;
  kill(-pid_, SIGKILL);  // before it is reaped: until then nobody else can get the number of the group
  while (waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
  }
  reaped_ = true;
}

std::optional<std::filesystem::path> find_program(const std::string& name, const std::filesystem::path& base) {
  if (name.find('/') != std::string::npos) {
    const std::filesystem::path file = std::filesystem::absolute(base / name);  // whoever starts it does so in another folder
    return access(file.c_str(), X_OK) == 0 ? std::optional(file) : std::nullopt;
  }
  const char* path = std::getenv("PATH");
  for (const std::string& folder : split(path != nullptr ? path : "/usr/bin:/bin", ':')) {
    const std::filesystem::path candidate = std::filesystem::absolute(folder.empty() ? "." : folder) / name;
    if (access(candidate.c_str(), X_OK) == 0) return candidate;
  }
  return std::nullopt;
}

std::string last_line(const std::filesystem::path& log) {
  std::ifstream file(log);
  std::string line, last;
  while (std::getline(file, line))
    if (!trim(line).empty()) last = line;
  return printable_utf8(last);
}

}  // namespace forcegate
