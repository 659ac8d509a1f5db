#include "hil/app/files/beside_program.h"

#include <unistd.h>

namespace forcegate {

namespace fs = std::filesystem;

fs::path program_folder() {
  char program[4096];
  const ssize_t n = readlink("/proc/self/exe", program, sizeof program - 1);
  return n > 0 ? fs::path(std::string(program, static_cast<std::size_t>(n))).parent_path() : fs::path();
}

std::string path_from_here(const fs::path& path) {
  std::error_code ignored;
  const fs::path whole = fs::weakly_canonical(path, ignored);
  const fs::path here = whole.lexically_relative(fs::weakly_canonical(fs::current_path(ignored), ignored));
  return here.empty() || *here.begin() == ".." ? whole.string() : here.string();
}

std::optional<std::string> shipped_image(const std::string& name) {
  std::error_code ignored;
  const fs::path image = program_folder() / "firmware" / name;
  if (!fs::is_regular_file(image, ignored)) return std::nullopt;
  return path_from_here(image);
}

}  // namespace forcegate
