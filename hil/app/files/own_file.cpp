#include "hil/app/files/own_file.h"

#include <fstream>
#include <string>

namespace forcegate {

Result<void> check_own_file(const std::filesystem::path& path, std::string_view mark) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored) || std::filesystem::file_size(path, ignored) == 0) return {};
  std::string begin(4096, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(file.gcount()));
  if (begin.find(mark) != std::string::npos) return {};
  return fail(ErrorCode::usage, "the output exists already, and this command did not write it", path.string(), "choose another name, or add --force to replace it");
}

}  // namespace forcegate
