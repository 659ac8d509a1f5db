#pragma once
// Runs a program as a user does and keeps what it said.

#include <chrono>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace forcegate::test {

struct ProcessResult {
  int exit_code = -1;  ///< 128 + signal when a signal ended it
  int signal = 0;
  bool timed_out = false;
  std::string out, err;
};

struct ProcessOptions {
  std::filesystem::path folder{};                    ///< to run in; empty: here
  std::map<std::string, std::string> environment{};  ///< added to ours; "" removes the variable
  std::chrono::milliseconds timeout{300000};
  std::chrono::milliseconds signal_after{0};  ///< > 0: send `signal` to the process group then
  int signal = 9;
  std::string out_file{};  ///< instead of a pipe, for example /dev/full
};

/// argv[0] is looked for in PATH. stdin is /dev/null.
ProcessResult run_process(const std::vector<std::string>& argv, const ProcessOptions& options = {});

/// build/forcegate with these arguments.
ProcessResult forcegate(std::vector<std::string> arguments, const ProcessOptions& options = {});

/// A folder that vanishes with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }
  std::string operator/(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

std::string read_text(const std::filesystem::path& path);
void write_text(const std::filesystem::path& path, const std::string& text);

}  // namespace forcegate::test
