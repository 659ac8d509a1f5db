#include "hil/cli/lost_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "hil/base/text.h"

namespace forcegate {
namespace {

namespace fs = std::filesystem;

struct Named {
  std::string option;  ///< as a user writes it
  Names names = Names::nothing;
  fs::path path;
};

std::vector<Named> named_files(const Command& command, const std::vector<std::pair<std::string, std::string>>& values) {
  std::vector<Named> out;
  for (const auto& [name, value] : values) {
    if (value.empty()) continue;
    for (const Option& o : command.options)
      if (o.name == name && o.names != Names::nothing) out.push_back({o.letter != 0 ? std::string("-") + o.letter : "--" + o.name, o.names, value});
    for (const Positional& p : command.positionals)
      if (p.name == name && p.names != Names::nothing) out.push_back({p.name, p.names, value});
  }
  return out;
}

bool is_input(Names names) { return names == Names::input || names == Names::campaign; }

bool is_same(const fs::path& a, const fs::path& b) {
  std::error_code unknown;
  if (fs::exists(a, unknown) && fs::exists(b, unknown)) return fs::equivalent(a, b, unknown);
  return fs::weakly_canonical(a, unknown) == fs::weakly_canonical(b, unknown);
}

constexpr std::array kRecordings = {".csv", ".tsv", ".lvm", ".mat", ".h5", ".hdf5", ".fgj"};

bool is_recording(const fs::path& path) { return std::ranges::find(kRecordings, ascii_lower(path.extension().string())) != kRecordings.end(); }

bool is_data(const fs::path& path) {
  const std::string name = path.filename().string();
  return name == "campaign.json" || name == "bundle.json" || name == "result.json" || ascii_lower(path.extension().string()) == ".txt" || is_recording(path);
}

// What a gate left: bundle.json lists the result and all that is in the folder bundle.
bool is_of_bundle(const fs::path& path) {
  std::error_code unknown;
  const fs::path folder = fs::absolute(path).parent_path();
  const std::string name = path.filename().string();
  return ((name == "bundle.json" || name == "result.json") && fs::exists(folder / "bundle.json", unknown)) ||
         (folder.filename() == "bundle" && fs::exists(folder.parent_path() / "bundle.json", unknown));
}

bool is_within(const fs::path& file, const fs::path& folder) {
  for (fs::path at = fs::absolute(file).parent_path(); !at.empty(); at = at.parent_path()) {
    if (is_same(at, folder)) return true;
    if (at == at.parent_path()) break;
  }
  return false;
}

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

// A description is read with the recordings beside it.
bool stands_for_folder(const fs::path& input) { return input.extension() == ".json"; }

std::optional<Error> file_over(const Named& output, const Named& input) {
  std::error_code unknown;
  if (is_same(output.path, input.path) && !fs::is_directory(input.path, unknown))
    return Error{ErrorCode::usage, "input and output are the same file", output.path.string(), "choose another name for " + output.option};
  const bool is_folder = fs::is_directory(input.path, unknown);
  const fs::path folder = is_folder ? input.path : folder_of(input.path);
  if ((is_folder || stands_for_folder(input.path)) && is_data(output.path) && is_within(output.path, folder))
    return Error{ErrorCode::usage, "the output would replace a file of " + input.path.string() + ", which is read", output.path.string(),
                 "choose another name for " + output.option};
  return std::nullopt;
}

std::optional<Error> records_over(const Named& output, const Named& input) {
  std::error_code unknown;
  if (!is_same(output.path, fs::is_directory(input.path, unknown) ? input.path : folder_of(input.path))) return std::nullopt;
  return Error{ErrorCode::usage, "the folder of the output holds the recordings that are read, which files of the same names would replace", output.path.string(),
               "choose another folder for " + output.option};
}

// A verb that has --force looks after its own outputs.
std::optional<Error> file_of_others(const Command& command, const Named& output) {
  if (is_of_bundle(output.path))
    return Error{ErrorCode::usage, "the output would replace a file of the bundle of a run, which forcegate check could then not judge",
                 output.path.string(), "choose another name for " + output.option};
  if (std::ranges::any_of(command.options, [](const Option& o) { return o.name == "force"; })) return std::nullopt;
  if (is_recording(output.path) || output.path.filename() == "campaign.json")
    return Error{ErrorCode::usage, "the output would replace a recording or its description", output.path.string(),
                 "choose another name for " + output.option + ", or move the file away"};
  return std::nullopt;
}

}  // namespace

std::optional<Error> lost_input(const Command& command, const std::vector<std::pair<std::string, std::string>>& values) {
  const std::vector<Named> files = named_files(command, values);
  std::error_code unknown;
  for (const Named& output : files) {
    if (is_input(output.names)) continue;
    if (output.path == "-")
      return Error{ErrorCode::usage, "\"-\" names no file: what goes to standard output is the answer", output.option + " -",
                   "give a file or folder by its name, or ./- where it is really called so"};
    const fs::file_status status = fs::status(output.path, unknown);
    if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status)) continue;
    for (const Named& other : files) {
      if (&other == &output) continue;
      if (is_input(other.names)) {
        if (!fs::exists(other.path, unknown)) continue;
        if (output.names == Names::file && fs::exists(status))
          if (auto error = file_over(output, other)) return error;
        if (output.names == Names::records && other.names == Names::campaign)
          if (auto error = records_over(output, other)) return error;
      } else if (output.names == Names::file && other.names == Names::file && is_same(output.path, other.path)) {
        return Error{ErrorCode::usage, fmt::format("{} and {} write the same file", output.option, other.option), output.path.string(), "give each a name of its own"};
      }
    }
    if (output.names == Names::file && fs::is_regular_file(status))
      if (auto error = file_of_others(command, output)) return error;
  }
  return std::nullopt;
}

}  // namespace forcegate
