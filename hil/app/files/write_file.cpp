#include "hil/app/files/write_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>

namespace forcegate {
namespace {

Unexpected refused(const std::string& what, const std::filesystem::path& path) {
  return fail(ErrorCode::io, what + ": " + std::strerror(errno), path.string(),
              "check the folder, its permissions and the free space");
}

}  // namespace

Result<void> write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
  std::error_code ignored;
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), ignored);
  // /dev/stdout, a pipe or a terminal cannot be renamed onto.
  const bool special =
      std::filesystem::exists(path, ignored) && !std::filesystem::is_regular_file(path, ignored);
  const std::string target = special ? path.string() : path.string() + ".part" + std::to_string(::getpid());
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
