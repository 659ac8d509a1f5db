#include "hil/app/files/find_plan.h"

#include <vector>

#include "hil/app/files/beside_program.h"
#include "hil/base/text.h"

namespace forcegate {

Result<std::filesystem::path> find_plan(const std::string& name) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (fs::is_regular_file(name, ignored)) return fs::path(name);
  std::vector<fs::path> folders{fs::path("ci") / "plans"};
  if (const fs::path folder = program_folder(); !folder.empty()) {
    folders.push_back(folder.parent_path() / "ci" / "plans");
    folders.push_back(folder.parent_path() / "share" / "forcegate" / "plans");
  }
  std::vector<std::string> known;
  for (const fs::path& folder : folders) {
    const fs::path path = folder / (name + ".toml");
    if (fs::is_regular_file(path, ignored)) return path;
    for (const auto& entry : fs::directory_iterator(folder, ignored))
      if (entry.path().extension() == ".toml") known.push_back(entry.path().stem().string());
  }
  const std::string near = nearest_name(name, known);
  std::vector<std::string> looked_in;
  for (const fs::path& folder : folders) looked_in.push_back(folder.string());
  return fail(ErrorCode::usage, "there is no plan '" + printable_utf8(name) + "'", "looked in " + join(looked_in, ", "),
              !near.empty() ? "did you mean '" + near + "'?"
                            : "give the file instead of its name (FOLDER/" + printable_utf8(name) + ".toml), or run it in the source tree, which has ci/plans");
}

}  // namespace forcegate
