#pragma once
// qemu-system-arm around one firmware image: found, started in its own folder, killed and reaped, its death
// told in words.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "adapters/link/image.h"
#include "adapters/transport/child_process.h"
#include "adapters/transport/private_folder.h"

namespace forcegate {

struct QemuOptions {
  std::string program;
  double timeout_s = 0.0;
};

class Qemu {
 public:
  /// "qemu": program (default qemu-system-arm in PATH); "timeout_s": longest wait for one answer, s. ErrorCode::usage names an
  /// option that `lane` does not have and a time that is none, config the package when the program is missing.
  static Result<QemuOptions> options(const std::string& lane, const std::map<std::string, std::string>& given, double timeout_s);

  /// `extra` follows "-machine BOARD -kernel IMAGE"; the working folder is folder().
  Result<void> start(const std::string& program, const std::string& board, const std::filesystem::path& image,
                     const std::vector<std::string>& extra);
  Result<void> make_folder();
  const std::filesystem::path& folder() const { return folder_->path(); }
  pid_t id() const { return child_.id(); }
  bool dead() { return child_.ended().has_value(); }
  /// ErrorCode::firmware: "the image ended: killed by signal 6 (Aborted): qemu: fatal: Lockup ...".
  Error death(const std::string& where);
  void finish(double timeout_s) { child_.finish(timeout_s); }
  void stop();

 private:
  std::vector<PrivateFolder> holder_;  // at most one
  const PrivateFolder* folder_ = nullptr;
  ChildProcess child_;
};

}  // namespace forcegate
