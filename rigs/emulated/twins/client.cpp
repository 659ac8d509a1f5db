#include "rigs/emulated/twins/client.h"

#include <chrono>
#include <thread>

#include "hil/base/text.h"

namespace forcegate::emulated {
namespace {

constexpr double kReply_s = 60.0;  // flashing starts an emulator

}  // namespace

Result<TwinClient> TwinClient::connect(const std::filesystem::path& folder, double timeout_s) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_s);
  for (;;) {
    auto line = connect_unix(folder / "control");
    if (line) return TwinClient(std::move(*line));
    if (std::chrono::steady_clock::now() > end)
      return fail(ErrorCode::device, "no twins answer", (folder / "control").string(),
                  "start those of this bench: forcegate bench serve with the bench file that is given here");
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

Result<std::string> TwinClient::say(const std::string& line) {
  const std::string text = line + "\n";
  FORCEGATE_CHECK_OK(
      line_->write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, kReply_s));
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kReply_s);
  std::size_t at = 0;
  while ((at = pending_.find('\n')) == std::string::npos) {
    std::uint8_t bytes[4096];
    auto n = line_->read(bytes, 0.5);
    if (!n) return fail(ErrorCode::device, "the twins are gone", line_->name());
    if (*n == 0 && std::chrono::steady_clock::now() > end)
      return fail(ErrorCode::timeout, "the twins do not answer", line_->name());
    pending_.append(reinterpret_cast<const char*>(bytes), *n);
  }
  const std::string reply = pending_.substr(0, at);
  pending_.erase(0, at + 1);
  if (reply == "ok") return std::string();
  if (reply.starts_with("ok ")) return reply.substr(3);
  std::string what = reply.starts_with("error ") ? reply.substr(6) : reply;
  // A mistake of the request travels with its code.
  for (const ErrorCode code : {ErrorCode::config, ErrorCode::usage, ErrorCode::firmware}) {
    const std::string prefix = std::string(to_string(code)) + " ";
    if (what.starts_with(prefix)) return fail(code, what.substr(prefix.size()));
  }
  return fail(ErrorCode::device, "the twins refuse '" + line + "': " + what);
}

Result<std::map<std::string, std::string>> TwinClient::status() {
  FORCEGATE_TRY(const std::string text, say("status"));
  std::map<std::string, std::string> values;
  for (const std::string& word : split(text, ' '))
    if (const std::size_t equals = word.find('='); equals != std::string::npos)
      values[word.substr(0, equals)] = word.substr(equals + 1);
  return values;
}

}  // namespace forcegate::emulated
