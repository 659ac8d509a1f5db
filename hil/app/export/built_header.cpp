#include "hil/app/export/built_header.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "hil/base/read_file.h"

extern char** environ;

namespace forcegate {
namespace {

namespace fs = std::filesystem;

// low_N: the force itself; floor_N: what a firmware sees of it.
constexpr const char* kDriver = R"(#include "compensation.h"
void fg_replay(int n, const float* u_N, const float* shrink, const float* low_N, int low_is_force, const float* T_C, float* F_N) {
  FgComp c;
  fg_comp_reset(&c);
  for (int i = 0; i < n; ++i)
    F_N[i] = fg_comp_step(&c, u_N[i], shrink[i], low_is_force ? low_N[i] + c.at_floor_N : low_N[i], T_C[i]);
}
)";

Result<void> write(const fs::path& path, std::string_view text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (file) return {};
  return fail(ErrorCode::io, "the source cannot be written to build the header", path.string(), "is the disk full? TMPDIR chooses another folder");
}

Result<void> compile(const fs::path& folder) {
  const std::string source = (folder / "replay.c").string(), target = (folder / "replay.so").string(), log = (folder / "log").string();
  const char* const words[] = {"cc",      "-std=c11", "-O2",          "-ffp-contract=off", "-Wall", "-Wextra", "-Wno-unused-function", "-Werror", "-fPIC",
                               "-shared", source.c_str(), "-o", target.c_str(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, 1, 2);
  pid_t pid = 0;
  const int started = posix_spawnp(&pid, "cc", &actions, nullptr, const_cast<char* const*>(words), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (started == ENOENT)
    return fail(ErrorCode::io, "there is no C compiler to build the header with", "cc", "apt-get install gcc");
  if (started != 0)
    return fail(ErrorCode::io, std::string("the C compiler cannot be started: ") + std::strerror(started), "cc",
                "try cc --version; is there memory, and may " + folder.string() + " be written to?");
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFSIGNALED(status))
    return fail(ErrorCode::io, fmt::format("signal {} ended the C compiler: {}", WTERMSIG(status), strsignal(WTERMSIG(status))), "cc",
                "is there memory, and room in " + folder.string() + "?");
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    return fail(ErrorCode::config, "the exported header does not compile: " + read_file(log).value_or("").substr(0, 600), "cc");
  return {};
}

}  // namespace

BuiltHeader::BuiltHeader() {
  std::error_code none;
  place_ = fs::temp_directory_path(none);
  if (none) return;  // `place_` is then empty
  std::string name = (place_ / "forcegate-check-XXXXXX").string();
  if (mkdtemp(name.data()) != nullptr) folder_ = name;
}

BuiltHeader::~BuiltHeader() {
  if (handle_ != nullptr) dlclose(handle_);
  std::error_code ignored;
  if (!folder_.empty()) fs::remove_all(folder_, ignored);
}

Result<std::unique_ptr<BuiltHeader>> BuiltHeader::build(const std::string& header) {
  std::unique_ptr<BuiltHeader> out(new BuiltHeader());
  const fs::path& folder = out->folder_;
  if (folder.empty())
    return fail(ErrorCode::io, "there is no place to build the header in", out->place_.empty() ? "TMPDIR" : out->place_.string(),
                "set TMPDIR to a folder that you may write into, for instance TMPDIR=/tmp");
  FORCEGATE_CHECK_OK(write(folder / "compensation.h", header));
  FORCEGATE_CHECK_OK(write(folder / "replay.c", kDriver));
  FORCEGATE_CHECK_OK(compile(folder));
  FORCEGATE_CHECK_OK(out->load());
  return out;
}

Result<void> BuiltHeader::load() {
  const std::string target = (folder_ / "replay.so").string();
  handle_ = dlopen(target.c_str(), RTLD_NOW | RTLD_LOCAL);
  replay_ = handle_ == nullptr ? nullptr : reinterpret_cast<Replay>(dlsym(handle_, "fg_replay"));
  if (replay_ != nullptr) return {};
  const char* why = dlerror();
  return fail(ErrorCode::io, std::string("the built header cannot be loaded: ") + (why != nullptr ? why : "fg_replay is not in it"), target,
              "set TMPDIR to a folder on a file system that is not mounted noexec");
}

std::vector<float> BuiltHeader::run(const std::vector<float>& u, const std::vector<float>& shrink, const std::vector<float>& low, bool low_is_force,
                                    const std::vector<float>& T) const {
  std::vector<float> F(u.size());
  replay_(static_cast<int>(u.size()), u.data(), shrink.data(), low.data(), low_is_force ? 1 : 0, T.data(), F.data());
  return F;
}

}  // namespace forcegate
