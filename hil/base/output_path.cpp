#include "hil/base/output_path.h"

namespace forcegate {

Result<std::filesystem::path> output_path(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  // A folder may be named with a slash at its end, by which the system would follow the link itself.
  const fs::path name = path.has_filename() || !path.has_parent_path() ? path : path.parent_path();
  if (!fs::is_symlink(name, error)) return path;
  if (fs::exists(name, error) && !fs::is_regular_file(name, error) && !fs::is_directory(name, error)) return path;  // /dev/stdout
  fs::path target = fs::canonical(name, error);
  if (!error) return target;
  std::error_code ignored;
  return fail(ErrorCode::usage, "the output is a symbolic link that leads nowhere: " + fs::read_symlink(name, ignored).string(), path.string(),
              "make what it leads to, remove the link, or give another name");
}

}  // namespace forcegate
