#pragma once
// A folder that one command fills at a time. The claim is a lock on the folder itself: the kernel frees it when its holder ends, however it
// ends, and no file of it lies in the folder.

#include <filesystem>
#include <vector>

#include "hil/base/result.h"

namespace forcegate {

class ClaimedFolder {
 public:
  /// Makes the folder where there is none; an empty name claims nothing. Errors: usage while another process fills it; io. A file system without locks grants every claim.
  static Result<ClaimedFolder> take(const std::filesystem::path& folder);
  ClaimedFolder(ClaimedFolder&& other) noexcept;
  ClaimedFolder& operator=(ClaimedFolder&&) = delete;
  ~ClaimedFolder();  ///< what take() made goes again where it is empty

  const std::filesystem::path& path() const { return path_; }
  /// take() made it.
  bool is_new() const { return !made_.empty(); }

 private:
  ClaimedFolder() = default;
  std::filesystem::path path_;
  std::vector<std::filesystem::path> made_;  ///< the innermost first
  int folder_ = -1;
};

}  // namespace forcegate
