#pragma once
// A program that dies with us: started with its own working folder and log, killed and reaped at the end of
// life, and with it whatever it has started in its process group.

#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/interface/transport.h"

namespace forcegate {

class ChildProcess {
 public:
  ChildProcess() = default;
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;
  ~ChildProcess() { kill_and_reap(); }

  /// argv[0] is a path. stdin is /dev/null; stdout and stderr go to `log`. The kernel kills the child when
  /// the thread that started it ends.
  Result<void> start(const std::vector<std::string>& argv, const std::filesystem::path& folder,
                     const std::filesystem::path& log);

  /// The same with its stdin and stdout on our end of a pair of sockets; stderr goes to `log`.
  Result<std::unique_ptr<Transport>> start_connected(const std::vector<std::string>& argv,
                                                     const std::filesystem::path& folder,
                                                     const std::filesystem::path& log);

  /// "exit code 3", "killed by signal 11 (Segmentation fault)"; nullopt while it runs. Of one that has ended nothing that it
  /// has started goes on.
  std::optional<std::string> ended();

  /// Waits at most timeout_s for a voluntary end, then kills. Never leaves a zombie.
  void finish(double timeout_s);
  void kill_and_reap();
  pid_t id() const { return pid_; }

 private:
  Result<void> launch(const std::vector<std::string>& argv, const std::filesystem::path& folder, int in,
                      int out, int err);
  pid_t pid_ = -1;
  int status_ = 0;
  bool reaped_ = true;
};

/// Full path of a program in PATH; nullopt when it is not installed. A name with '/' is a file: relative to `base`, or to
/// the working folder where that is empty.
std::optional<std::filesystem::path> find_program(const std::string& name, const std::filesystem::path& base = {});

/// Last line of a log file that is not empty, made printable; "" when there is none.
std::string last_line(const std::filesystem::path& log);

}  // namespace forcegate
