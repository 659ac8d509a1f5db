#include "hil/app/files/write_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include "hil/base/output_path.h"

namespace forcegate {
namespace {

constexpr const char* kHelp = "check the folder, its permissions and the free space";

Unexpected refused(const std::string& what, const std::filesystem::path& path) { return fail(ErrorCode::io, what + ": " + std::strerror(errno), path.string(), kHelp); }

std::string part_of(const std::filesystem::path& path) { return path.string() + ".part" + std::to_string(::getpid()); }

}  // namespace

Result<void> make_folder(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  FORCEGATE_CHECK_OK(output_path(folder));
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error) return {};
  std::error_code ignored;
  for (fs::path above = folder; !above.empty(); above = above.parent_path()) {
    if (fs::exists(above, ignored) && !fs::is_directory(above, ignored))
      return fail(ErrorCode::io, "cannot make the folder: a file has that name", above.string(), "name another folder, or move the file away");
    if (above == above.parent_path()) break;
  }
  return fail(ErrorCode::io, "cannot make the folder: " + error.message(), folder.string(), "name a folder below one that you may write into; check its permissions and the free space");
}

std::vector<std::filesystem::path> missing_folders(const std::filesystem::path& folder) {
  std::error_code ignored;
  std::vector<std::filesystem::path> out;
  for (std::filesystem::path above = folder; !above.empty() && !std::filesystem::exists(std::filesystem::symlink_status(above, ignored)); above = above.parent_path()) out.push_back(above);
  return out;
}

Result<void> check_writable(const std::filesystem::path& name) {
  namespace fs = std::filesystem;
  FORCEGATE_TRY(const fs::path path, output_path(name));
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    errno = EISDIR;
    return refused("cannot write file", path);
  }
  if (fs::exists(path, ignored) && !fs::is_regular_file(path, ignored)) return {};  // a pipe or a terminal
  // folders that will be made are made and taken away again: permissions alone do not tell of every file system
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  const std::vector<fs::path> missing = missing_folders(folder);
  const auto take_away = [&] {
    for (const fs::path& made : missing) fs::remove(made, ignored);
  };
  if (Result<void> made = make_folder(folder); !made) {
    take_away();
    return made;
  }
  const std::string target = part_of(path);
  const int file = ::open(target.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_EXCL, 0666);
  if (file < 0) {
    Unexpected error = refused("cannot write file", path);
    take_away();
    return error;
  }
  ::close(file);
  ::unlink(target.c_str());
  take_away();
  return {};
}

Result<void> write_file_atomically(const std::filesystem::path& name, std::string_view bytes) {
  FORCEGATE_TRY(const std::filesystem::path path, output_path(name));
  std::error_code ignored;
  if (path.has_parent_path()) FORCEGATE_CHECK_OK(make_folder(path.parent_path()));
  // /dev/stdout, a pipe or a terminal cannot be renamed onto.
  const bool special =
      std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored);
  const std::string target = special ? path.string() : part_of(path);
  const int file = ::open(target.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | (special ? 0 : O_TRUNC), 0666);
  if (file < 0) return refused("cannot write file", path);
  const auto abandon = [&]() -> Unexpected {
    Unexpected error = refused("cannot write file", path);
    ::close(file);
    if (!special) ::unlink(target.c_str());
    return error;
  };
  while (!bytes.empty()) {
    const ssize_t n = ::write(file, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return abandon();
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  if (!special && ::fsync(file) != 0) return abandon();
  if (::close(file) != 0) return refused("cannot write file", path);
  if (!special && ::rename(target.c_str(), path.c_str()) != 0) {
    Unexpected error = refused("cannot replace file", path);
    ::unlink(target.c_str());
    return error;
  }
  return {};
}

}  // namespace forcegate
