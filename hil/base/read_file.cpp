#include "hil/base/read_file.h"

#include <sys/stat.h>

#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <utility>

namespace forcegate {
namespace {

Result<std::string> bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in) return fail(ErrorCode::io, "the file cannot be read", path.string(), "check its permissions");
  return bytes;
}

struct KeptPipes {
  std::mutex mutex;
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::string> bytes;  ///< by device and inode
};

Result<std::string> bytes_of_pipe(const std::filesystem::path& path, const struct stat& status) {
  static KeptPipes kept;
  const std::lock_guard lock(kept.mutex);
  const std::pair<std::uint64_t, std::uint64_t> pipe{status.st_dev, status.st_ino};
  if (const auto known = kept.bytes.find(pipe); known != kept.bytes.end()) return known->second;
  FORCEGATE_TRY(std::string bytes, bytes_of(path));
  return kept.bytes.emplace(pipe, std::move(bytes)).first->second;
}

}  // namespace

bool is_pipe(const std::filesystem::path& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && (S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode));
}

Result<std::string> read_file(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    return fail(ErrorCode::io, "there is no such file", path.string(), "check the name");
  if (std::filesystem::is_directory(path, error))
    return fail(ErrorCode::io, "this is a folder, not a file", path.string(), "name the file itself");
  if (struct stat status {}; is_pipe(path) && ::stat(path.c_str(), &status) == 0)
    return bytes_of_pipe(path, status);
  return bytes_of(path);
}

}  // namespace forcegate
