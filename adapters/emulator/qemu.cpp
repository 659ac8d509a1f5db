#include "adapters/emulator/qemu.h"

#include <charconv>

#include "hil/base/text.h"

namespace forcegate {

Result<std::string> Qemu::find(const std::map<std::string, std::string>& options) {
  const auto given = options.find("qemu");
  const std::string name = given != options.end() ? given->second : "qemu-system-arm";
  const auto program = find_program(name);
  if (!program)
    return fail(ErrorCode::config, "the emulator " + printable_utf8(name) + " is not installed", {},
                "apt-get install qemu-system-arm, or judge the native build with --lane native");
  return program->string();
}

double Qemu::timeout_s(const std::map<std::string, std::string>& options, double fallback) {
  const auto given = options.find("timeout_s");
  if (given == options.end()) return fallback;
  double value = 0.0;
  const std::string& text = given->second;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && value > 0.0 ? value : fallback;
}

Result<void> Qemu::make_folder() {
  stop();
  FORCEGATE_TRY(PrivateFolder folder, PrivateFolder::make());
  holder_.push_back(std::move(folder));
  folder_ = &holder_.front();
  return {};
}

Result<void> Qemu::start(const std::string& program, const std::string& board,
                         const std::filesystem::path& image, const std::vector<std::string>& extra) {
  std::vector<std::string> argv{
      program,    "-machine", board,      "-kernel", std::filesystem::absolute(image).string(),
      "-display", "none",     "-monitor", "none",    "-nodefaults"};
  argv.insert(argv.end(), extra.begin(), extra.end());
  return child_.start(argv, folder(), folder() / "log");
}

Error Qemu::death(const std::string& where) {
  const std::string line = folder_ != nullptr ? last_line(folder_->path() / "log") : "";
  std::string text = "the image ended: " + child_.ended().value_or("unknown cause");
  if (!line.empty()) text += ": " + line;
  return Error{ErrorCode::firmware, std::move(text), where,
               "run the image by hand under qemu-system-arm to see why"};
}

void Qemu::stop() {
  child_.kill_and_reap();
  folder_ = nullptr;
  holder_.clear();
}

}  // namespace forcegate
