#include "hil/app/files/find_plan.h"

#include <algorithm>
#include <vector>

#include "hil/app/files/beside_program.h"
#include "hil/base/text.h"

namespace forcegate {

namespace {

namespace fs = std::filesystem;

void add_plans_of(const fs::path& folder, std::vector<std::string>& names) {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
}

bool is_path(const std::string& name) { return name.find('/') != std::string::npos || name.ends_with(".toml"); }

Unexpected no_file(const fs::path& path, const std::vector<std::string>& known) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) return fail(ErrorCode::usage, "the plan is a folder", path.string(), "give a file of it, or the name of a plan in ci/plans");
  const fs::path folder = path.parent_path();
  const std::string stem = path.extension() == ".toml" ? path.stem().string() : path.filename().string();
  std::vector<std::string> beside;
  add_plans_of(folder.empty() ? fs::path(".") : folder, beside);
  std::ranges::sort(beside);
  std::string cure = "mend the path" + (known.empty() ? std::string() : ", or give the name of a plan in ci/plans (" + join(known, ", ") + ")");
  if (const std::string near = nearest_name(stem, beside); !near.empty())
    cure = "did you mean '" + (folder / (near + ".toml")).string() + "'?";
  else if (const std::string plan = nearest_name(stem, known); !plan.empty())
    cure = "did you mean the plan '" + plan + "' of ci/plans? Its name has neither folder nor ending";
  else if (!folder.empty() && !fs::is_directory(folder, ignored))
    cure = "there is no folder " + folder.string() + " either: " + cure;
  return fail(ErrorCode::usage, "there is no such plan file", path.string(), printable_utf8(cure));
}

}  // namespace

Result<fs::path> find_plan(const std::string& name) {
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
    add_plans_of(folder, known);
  }
  std::ranges::sort(known);
  known.erase(std::unique(known.begin(), known.end()), known.end());
  if (is_path(name)) return no_file(name, known);
  const std::string near = nearest_name(name, known);
  std::vector<std::string> looked_in;
  for (const fs::path& folder : folders) looked_in.push_back(folder.string());
  return fail(ErrorCode::usage, "there is no plan '" + printable_utf8(name) + "'", "looked in " + join(looked_in, ", "),
              !near.empty() ? "did you mean '" + near + "'?"
                            : "give the file instead of its name (FOLDER/" + printable_utf8(name) + ".toml), or run it in the source tree, which has ci/plans");
}

}  // namespace forcegate
