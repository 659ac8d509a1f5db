#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <filesystem>

#include "hil/app/league.h"
#include "rigs/emulated/hidden/campaign_writer.h"

namespace forcegate {
namespace {

namespace fs = std::filesystem;

/// A folder below the temporary one that goes when its owner goes.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    static std::atomic<unsigned> count{0};
    path_ = fs::temp_directory_path() / fmt::format("forcegate-league-{}-{}", ::getpid(), count++);
    std::error_code ignored;
    fs::create_directory(path_, ignored);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

Result<std::string> output_of(const std::string& command) {
  std::FILE* pipe = ::popen(command.c_str(), "r");
  if (!pipe) return fail(ErrorCode::io, "cannot start the engine", command);
  std::string text;
  std::array<char, 65536> buffer;
  for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;)
    text.append(buffer.data(), n);
  const int status = ::pclose(pipe);
  if (text.empty())
    return fail(
        ErrorCode::io,
        fmt::format("the engine printed nothing (exit {})", WIFEXITED(status) ? WEXITSTATUS(status) : -1),
        command);
  return text;
}

}  // namespace

LeagueEngine built_in_engine() {
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error);
  LeagueEngine engine =
      command_engine("'" + (error ? fs::path("forcegate") : self).string() + "' diagnose --json --threads 1");
  engine.name = "built-in";
  return engine;
}

LeagueEngine command_engine(std::string command) {
  return {command, [command](hidden::MadeCampaign&& made) -> Result<std::string> {
            const TemporaryFolder folder;
            FORCEGATE_CHECK_OK(hidden::write_campaign(made, folder.path() / "campaign", true));
            return output_of(command + " '" + (folder.path() / "campaign").string() + "'");
          }};
}

}  // namespace forcegate
