#include "adapters/emulator/qemu.h"

#include <algorithm>

#include "hil/base/read_file.h"
#include "hil/base/read_number.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

constexpr double kLongest_s = 3600.0;

// What the emulator says of itself stands before the registers that it dumps as it aborts.
std::string last_words(const std::filesystem::path& log) {
  constexpr std::size_t kLongest = 1 << 16;
  const auto text = read_file(log);
  if (!text) return {};
  const std::string_view tail = std::string_view(*text).substr(text->size() > kLongest ? text->size() - kLongest : 0);
  const std::size_t at = tail.rfind("qemu: fatal: ");
  if (at == std::string_view::npos) return last_line(log);
  return printable_utf8(std::string(tail.substr(at, std::min(tail.find('\n', at) - at, std::size_t{200}))));
}

}  // namespace

Result<QemuOptions> Qemu::options(const std::string& lane, const std::map<std::string, std::string>& given, double timeout_s) {
  std::string name = "qemu-system-arm";
  for (const auto& [key, text] : given) {
    if (key == "qemu") {
      name = text;
    } else if (key == "timeout_s") {
      timeout_s = read_number(text).value_or(0.0);
      if (timeout_s <= 0.0 || timeout_s > kLongest_s)
        return fail(ErrorCode::usage, "timeout_s = '" + printable_utf8(text) + "' is no time", "--lane-option", "give seconds above 0, at most " + shortest(kLongest_s));
    } else {
      return fail(ErrorCode::usage, "the " + lane + " lane has no option '" + printable_utf8(key) + "'", "--lane-option",
                  "it has: qemu (the program), timeout_s (longest wait for one answer)");
    }
  }
  const auto program = find_program(name);
  if (!program)
    return fail(ErrorCode::config, "the emulator " + printable_utf8(name) + " is not installed", {},
                "apt-get install qemu-system-arm, or judge the native build with --lane native");
  return QemuOptions{program->string(), timeout_s};
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
  const std::string line = folder_ != nullptr ? last_words(folder_->path() / "log") : "";
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
