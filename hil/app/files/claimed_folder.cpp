#include "hil/app/files/claimed_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "hil/app/files/write_file.h"

namespace forcegate {
namespace {

bool is_at(int folder, const std::filesystem::path& path) {
  struct stat opened {}, named {};
  return ::fstat(folder, &opened) == 0 && ::stat(path.c_str(), &named) == 0 && opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

}  // namespace

Result<ClaimedFolder> ClaimedFolder::take(const std::filesystem::path& folder) {
  constexpr int kTries = 10;  // who held it may take an empty folder away between our making and our locking it
  for (int k = 0; k < kTries; ++k) {
    ClaimedFolder claim;
    if (folder.empty()) return claim;
    claim.path_ = folder;
    claim.made_ = missing_folders(folder);
    FORCEGATE_CHECK_OK(make_folder(folder));
    claim.folder_ = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (claim.folder_ < 0 && errno == ENOENT) continue;
    if (claim.folder_ < 0) return fail(ErrorCode::io, std::string("cannot read the folder: ") + std::strerror(errno), folder.string(), "check its permissions");
    if (::flock(claim.folder_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      claim.made_.clear();
      break;
    }
    if (is_at(claim.folder_, folder)) return claim;
  }
  return fail(ErrorCode::usage, "another run is writing there now", folder.string(), "give another folder with -o, or wait for it");
}

ClaimedFolder::ClaimedFolder(ClaimedFolder&& other) noexcept
    : path_(std::move(other.path_)), made_(std::exchange(other.made_, {})), folder_(std::exchange(other.folder_, -1)) {}

ClaimedFolder::~ClaimedFolder() {
  std::error_code not_empty;
  for (const std::filesystem::path& made : made_) std::filesystem::remove(made, not_empty);
  if (folder_ >= 0) ::close(folder_);
}

}  // namespace forcegate
