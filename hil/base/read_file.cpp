#include "hil/base/read_file.h"

#include <fstream>
#include <iterator>

namespace forcegate {

Result<std::string> read_file(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error))
    return fail(ErrorCode::io, "there is no such file", path.string(), "check the name");
  if (std::filesystem::is_directory(path, error))
    return fail(ErrorCode::io, "this is a folder, not a file", path.string(), "name the file itself");
  std::ifstream in(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in) return fail(ErrorCode::io, "the file cannot be read", path.string(), "check its permissions");
  return bytes;
}

}  // namespace forcegate
