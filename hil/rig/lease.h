#pragma once
// One bench, one run. The lease is a locked file: the kernel frees it when its holder ends, however it ends, so that no
// lock is ever orphaned. What the file says (who, since when, last heartbeat) is for people.

#include <filesystem>
#include <optional>
#include <string>

#include "hil/base/result.h"

namespace forcegate {

struct LeaseHolder {
  int pid = 0;
  std::string token;     ///< of this hold; another hold has another one
  std::string purpose;   ///< "gate build/firmware/x.elf"
  double since_s = 0.0;  ///< wall clock, s since 1970
  double heartbeat_s = 0.0;
};

class Lease {
 public:
  Lease() = default;
  Lease(Lease&& other) noexcept;
  Lease& operator=(Lease&& other) noexcept;
  ~Lease();

  /// ErrorCode::device naming the holder when another process has the bench.
  static Result<Lease> take(const std::string& bench_id, const std::string& purpose);
  /// Writes the time of the last sign of life, at most once a second.
  void beat() noexcept;
  bool held() const { return fd_ >= 0; }

 private:
  void write_holder() noexcept;
  int fd_ = -1;
  LeaseHolder holder_;
};

/// Who has the bench now; nullopt: nobody.
Result<std::optional<LeaseHolder>> lease_holder(const std::string& bench_id);

/// Folder of leases and of the guard's reports: $XDG_RUNTIME_DIR/forcegate, else one of this user's own in the system's
/// temporary folder.
std::filesystem::path bench_runtime_folder();

}  // namespace forcegate
