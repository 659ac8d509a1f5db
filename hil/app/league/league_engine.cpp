#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdio>
#include <filesystem>

#include "hil/app/league/league.h"
#include "hil/app/league/league_baseline.h"
#include "hil/app/model/model_input.h"
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
  return {"built-in",
          [](hidden::MadeCampaign&& made) -> Result<LeagueReply> {
            FORCEGATE_TRY(const Model model, library_model("flexiforce"));
            diagnose::EngineOptions options = engine_options(model, 1);
            options.pictures = false;
            FORCEGATE_TRY(const auto workspace,
                          diagnose::prepare(hidden::to_campaign(std::move(made)), options));
            LeagueReply reply;
            reply.naive = largest_correlation(*workspace);
            if (auto base = diagnose::base_errors(*workspace, options)) reply.base = *base;
            FORCEGATE_TRY(Diagnosis diagnosis, diagnose::diagnose_workspace(*workspace, options));
            diagnosis.maps.clear();  // a quarter of the text, and no judge reads them
            reply.json = to_json(diagnosis);
            return reply;
          },
          [](hidden::MadeCampaign&& made, bool with_force) -> Result<diagnose::BaseErrors> {
            FORCEGATE_TRY(const Model model, library_model("flexiforce"));
            diagnose::EngineOptions options = engine_options(model, 1);
            options.search = with_force;  // the rig's law belongs to the search
            FORCEGATE_TRY(const auto workspace,
                          diagnose::prepare(hidden::to_campaign(std::move(made)), options));
            return diagnose::base_errors(*workspace, options);
          }};
}

LeagueEngine command_engine(std::string command) {
  return {command,
          [command](hidden::MadeCampaign&& made) -> Result<LeagueReply> {
            const TemporaryFolder folder;
            FORCEGATE_CHECK_OK(hidden::write_campaign(made, folder.path() / "campaign", true));
            FORCEGATE_TRY(std::string json,
                          output_of(command + " '" + (folder.path() / "campaign").string() + "'"));
            return LeagueReply{std::move(json), "", std::nullopt};
          },
          {}};
}

}  // namespace forcegate
