#include "rigs/emulated/hidden/played_forces.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "hil/base/read_file.h"

namespace forcegate::hidden {
namespace {

namespace fs = std::filesystem;

nlohmann::ordered_json to_json(const AskedForce& f) {
  return {{"number", f.number}, {"kind", f.kind}, {"f_min_Hz", f.f_min_Hz}, {"rest_before_s", f.rest_before_s}, {"t_s", f.t_s}, {"force_N", f.force_N}};
}

AskedForce from_json(const nlohmann::json& j) {
  AskedForce f;
  j.at("number").get_to(f.number);
  j.at("kind").get_to(f.kind);
  j.at("f_min_Hz").get_to(f.f_min_Hz);
  j.at("rest_before_s").get_to(f.rest_before_s);
  j.at("t_s").get_to(f.t_s);
  j.at("force_N").get_to(f.force_N);
  return f;
}

}  // namespace

Result<std::vector<AskedForce>> read_played(const fs::path& folder) {
  const fs::path path = folder / kPlayedFile;
  std::error_code unknown;
  if (!fs::exists(path, unknown)) return std::vector<AskedForce>{};
  FORCEGATE_TRY(const std::string text, read_file(path));
  const auto damaged = [&](const std::string& why) {
    return fail(ErrorCode::parse, "what was played on this sensor cannot be read: " + why, path.string(), "go on from a copy of the campaign whose file is whole");
  };
  try {
    const auto j = nlohmann::json::parse(text);
    if (j.at("format") != 1) return damaged("unknown format");
    std::vector<AskedForce> out;
    for (const auto& one : j.at("played")) out.push_back(from_json(one));
    return out;
  } catch (const nlohmann::json::exception& e) {
    return damaged(e.what());
  }
}

Result<void> write_played(const std::vector<AskedForce>& played, const fs::path& folder) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const AskedForce& one : played) list.push_back(to_json(one));
  std::ofstream file(folder / kPlayedFile, std::ios::binary);
  file << nlohmann::ordered_json{{"format", 1}, {"played", list}}.dump() << '\n';
  file.close();
  if (!file) return fail(ErrorCode::io, "cannot write the file", (folder / kPlayedFile).string(), "is the folder writable and the disk not full?");
  return {};
}

}  // namespace forcegate::hidden
