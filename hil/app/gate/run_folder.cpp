#include "hil/app/gate/run_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "hil/app/files/write_file.h"
#include "hil/base/output_path.h"
#include "hil/base/read_file.h"
#include "hil/base/text.h"
#include "hil/interface/reporter.h"

namespace forcegate {
namespace fs = std::filesystem;
namespace {

constexpr const char* kPart = ".part-";
constexpr const char* kOlder = ".older-";

bool is_number(std::string_view text) { return !text.empty() && text.size() < 18 && text.find_first_not_of("0123456789") == std::string_view::npos; }

// The process that a name PREFIX<PID> or, of the second one of a process, PREFIX<PID>-2 tells; 0 where it is another name.
long pid_in(const std::string& name, const std::string& prefix) {
  if (!name.starts_with(prefix)) return 0;
  const std::string tail = name.substr(prefix.size()), pid = tail.substr(0, tail.find('-'));
  if (!is_number(pid) || (pid.size() < tail.size() && !is_number(std::string_view(tail).substr(pid.size() + 1)))) return 0;
  return std::stol(pid);
}

// Nothing but what a run may leave in its folder, finished or not: a file that is being written has its name and .part<PID>.
bool holds_only_ours(const fs::path& folder) {
  std::vector<std::string> ours{"traces", "bundle", "bundle.json", "golden"};
  for (const ReporterKind& reporter : Registry<ReporterKind>::instance().all())
    if (!reporter.file_name.empty()) ours.push_back(reporter.file_name);
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    const auto is = [&](const std::string& one) { return name == one || pid_in(name, one + ".part") > 0; };
    if (std::none_of(ours.begin(), ours.end(), is)) return false;
  }
  return !error;
}

// The last thing that a run writes is there too: a folder of somebody's own traces has none.
bool is_ours(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_empty(folder, ignored) || (fs::exists(folder / "result.json", ignored) && holds_only_ours(folder));
}

void sync_folder(const fs::path& folder) {
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY);
  if (descriptor < 0) return;
  fsync(descriptor);
  close(descriptor);
}

fs::path unfinished(const fs::path& final_path, long pid) { return final_path.string() + ".unfinished-" + std::to_string(pid); }

std::vector<fs::path> traces_in(const fs::path& folder) {
  std::vector<fs::path> out;
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(folder, error))
    if (const fs::path ending = entry.path().extension(); ending == ".fgj" || ending == ".h5") out.push_back(entry.path());
  std::ranges::sort(out);
  return out;
}

// Traces that no seed makes again. A result that cannot be read may be of a bench.
bool holds_what_a_bench_played(const fs::path& run) {
  if (traces_in(run).empty()) return false;
  const auto text = read_file(run / "result.json");
  const auto result = text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
  const auto at = nlohmann::json::json_pointer("/rig/name");
  return !result.is_object() || !result.contains(at) || (result[at] != "emulated" && result[at] != "replay");
}

// Killed, and its parent has not asked for its exit code yet: it can be signalled, and writes nothing any more.
bool is_zombie(long pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string stat;
  std::getline(file, stat);
  const std::size_t name_ends = stat.rfind(") ");
  return name_ends != std::string::npos && name_ends + 2 < stat.size() && (stat[name_ends + 2] == 'Z' || stat[name_ends + 2] == 'X');
}

// A process of another user must not be signalled (EPERM), but it lives.
bool lives(long pid) { return pid > 0 && pid != getpid() && (kill(static_cast<pid_t>(pid), 0) == 0 || errno == EPERM) && !is_zombie(pid); }

// The folder that a living run fills for the same name; "" without one.
fs::path of_another_run(const fs::path& final_path) {
  const std::string prefix = final_path.filename().string() + kPart;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(final_path.parent_path(), ignored))
    if (lives(pid_in(entry.path().filename().string(), prefix))) return entry.path();
  return {};
}

bool lies_within(const fs::path& path, const fs::path& folder) {
  std::error_code error;
  const fs::path inner = fs::weakly_canonical(path, error), whole = fs::weakly_canonical(folder, error);
  return !inner.empty() && std::mismatch(whole.begin(), whole.end(), inner.begin(), inner.end()).first == whole.end();
}

// Who stands in a folder that is replaced stands in none, and relative paths lead nowhere; what the run reads would be gone with it.
Result<void> check_may_be_replaced(const fs::path& folder, const std::vector<fs::path>& inputs) {
  std::error_code ignored;
  if (lies_within(fs::current_path(ignored), folder))
    return fail(ErrorCode::usage, "the output is the folder that the command is given in, or one above it", folder.string(),
                "a result replaces its folder as a whole: give the name of another one, for example --output run");
  for (const fs::path& input : inputs)
    if (!input.empty() && lies_within(input, folder))
      return fail(ErrorCode::usage, "the run reads a file of the folder that it replaces", input.string(), "give another folder with --output, or copy the file elsewhere first");
  return {};
}

// Temporary folders whose process is gone. Those that hold traces stay under another name, which is returned.
std::vector<fs::path> remove_leftovers(const fs::path& final_path) {
  const std::string prefix = final_path.filename().string() + kPart;
  std::error_code ignored;
  std::vector<std::pair<fs::path, long>> dead;
  for (const auto& entry : fs::directory_iterator(final_path.parent_path(), ignored)) {
    const long pid = pid_in(entry.path().filename().string(), prefix);
    if (pid > 0 && !lives(pid) && fs::is_directory(entry.path(), ignored)) dead.emplace_back(entry.path(), pid);
  }
  std::vector<fs::path> stay;
  for (const auto& [path, pid] : dead) {
    if (traces_in(path).empty()) {
      if (holds_only_ours(path)) fs::remove_all(path, ignored);
      continue;
    }
    std::error_code failed;
    fs::rename(path, unfinished(final_path, pid), failed);
    stay.push_back(failed ? path : unfinished(final_path, pid));
  }
  return stay;
}

}  // namespace

fs::path run_put_aside(const fs::path& final_path) {
  std::error_code error;
  fs::path name = fs::absolute(final_path, error).lexically_normal(), youngest;
  if (name.filename().empty()) name = name.parent_path();
  fs::file_time_type when{};
  for (const auto& entry : fs::directory_iterator(name.parent_path(), error)) {
    const long pid = pid_in(entry.path().filename().string(), name.filename().string() + kOlder);
    if (pid <= 0 || lives(pid) || !is_ours(entry.path())) continue;
    std::error_code unknown;
    const auto made = fs::last_write_time(entry.path() / "result.json", unknown);
    if (unknown || (!youngest.empty() && made <= when)) continue;
    youngest = entry.path(), when = made;
  }
  return youngest;
}

Result<RunFolder> RunFolder::open(const fs::path& final_path, const std::vector<fs::path>& inputs) {
  RunFolder folder;
  std::error_code error;
  FORCEGATE_TRY(const fs::path target, output_path(final_path));
  folder.final_ = fs::absolute(target).lexically_normal();
  if (folder.final_.filename().empty()) folder.final_ = folder.final_.parent_path();
  // what a run is called before it is whole
  constexpr std::size_t kLongest = 255 - std::string_view(".unfinished-4194304-2").size();
  if (const std::size_t length = folder.final_.filename().string().size(); length > kLongest)
    return fail(ErrorCode::usage, fmt::format("the name of the output folder is too long: {} bytes, and {} are left for it", length, kLongest), folder.final_.string(), "give a shorter name with --output");
  FORCEGATE_CHECK_OK(check_may_be_replaced(folder.final_, inputs));
  if (const fs::path other = of_another_run(folder.final_); !other.empty())
    return fail(ErrorCode::usage, "another run is writing there now", folder.final_.string(),
                "give another folder with --output, or wait for it (it fills " + other.string() + ")");
  if (fs::exists(folder.final_, error)) {
    if (!fs::is_directory(folder.final_, error))
      return fail(ErrorCode::usage, "the output is a file", folder.final_.string(),
                  "give a folder with --output");
    if (!is_ours(folder.final_))
      return fail(ErrorCode::usage, "the output folder holds files that are not of a finished run",
                  folder.final_.string(), "give a new or empty folder with --output");
    const std::string own = folder.final_.string() + kOlder + std::to_string(getpid());
    fs::path aside = own;
    for (int k = 2; fs::exists(aside, error); ++k) aside = own + "-" + std::to_string(k);
    if (fs::is_empty(folder.final_, error)) fs::remove(folder.final_, error);
    else if (fs::rename(folder.final_, aside, error); !error) folder.older_ = aside;
    if (error)
      return fail(ErrorCode::io, "the older result cannot be put aside: " + error.message(),
                  folder.final_.string(), "check the permissions of the folder that it is in");
  }
  if (folder.older_.empty()) folder.older_ = run_put_aside(folder.final_);  // by a run that was killed
  fs::create_directories(folder.final_.parent_path(), error);
  folder.left_ = remove_leftovers(folder.final_);
  folder.temporary_ = folder.final_.string() + kPart + std::to_string(getpid());
  fs::create_directories(folder.temporary_, error);
  if (const fs::path other = of_another_run(folder.final_); !error && !other.empty())  // began in this very moment
    return fail(ErrorCode::usage, "another run is writing there now", folder.final_.string(), "give another folder with --output");
  if (error)
    return fail(ErrorCode::io, "the output folder cannot be made: " + error.message(),
                folder.final_.string(), "check its permissions and the free space");
  return folder;
}

RunFolder::RunFolder(RunFolder&& other) noexcept
    : final_(std::move(other.final_)), temporary_(std::move(other.temporary_)), keeps_traces_(other.keeps_traces_), left_(std::move(other.left_)), older_(std::exchange(other.older_, {})) {
  other.temporary_.clear();
}

RunFolder::~RunFolder() {
  std::error_code ignored;
  // Another run that began in the same moment would find its name taken.
  if (!older_.empty() && !fs::exists(final_, ignored) && of_another_run(final_).empty()) fs::rename(older_, final_, ignored);
  if (temporary_.empty()) return;
  if (keeps_traces_ && !traces_in(temporary_).empty()) fs::rename(temporary_, unfinished(final_, getpid()), ignored);
  else fs::remove_all(temporary_, ignored);
}

fs::path RunFolder::keep_traces() {
  keeps_traces_ = true;
  return unfinished(final_, getpid());
}

std::vector<fs::path> RunFolder::traces_that_stay() const {
  std::vector<fs::path> out;
  if (!keeps_traces_) return out;
  for (const fs::path& trace : traces_in(temporary_)) out.push_back(unfinished(final_, getpid()) / trace.lexically_relative(temporary_));
  return out;
}

Result<void> RunFolder::publish(const RunResult& result) {
  const ReporterKind* last = nullptr;
  for (const ReporterKind& reporter : Registry<ReporterKind>::instance().all()) {
    if (reporter.file_name.empty()) continue;
    if (reporter.file_name == "result.json") {
      last = &reporter;
      continue;
    }
    FORCEGATE_CHECK_OK(write_file_atomically(temporary_ / reporter.file_name, reporter.render(result)));
  }
  if (last != nullptr)
    FORCEGATE_CHECK_OK(write_file_atomically(temporary_ / last->file_name, last->render(result)));
  sync_folder(temporary_);
  std::error_code error;
  fs::rename(temporary_, final_, error);
  if (error) {
    const std::string why = error.message();
    const fs::path kept = final_.string() + ".run-" + std::to_string(getpid());
    fs::rename(temporary_, kept, error);
    const fs::path stays = error ? temporary_ : kept;
    temporary_.clear();
    return fail(ErrorCode::io, "the result cannot be given its name: " + why, final_.string(),
                "it is kept whole: forcegate report " + file_quoted(stays.string()));
  }
  temporary_.clear();
  sync_folder(final_.parent_path());
  remove_older();
  return {};
}

bool RunFolder::older_stays() const { return !older_.empty() && holds_what_a_bench_played(older_); }

// This run's and those of runs that were interrupted.
void RunFolder::remove_older() const {
  const std::string prefix = final_.filename().string() + kOlder;
  std::error_code ignored;
  std::vector<fs::path> replaced;
  for (const auto& entry : fs::directory_iterator(final_.parent_path(), ignored))
    if (const long pid = pid_in(entry.path().filename().string(), prefix);
        pid > 0 && !lives(pid) && is_ours(entry.path()) && !holds_what_a_bench_played(entry.path()))
      replaced.push_back(entry.path());
  for (const fs::path& run : replaced) fs::remove_all(run, ignored);
}

void note_not_written(RunResult& result, Error why) {
  result.notes.push_back("the decision stands, and its folder could not be written: " + why.text);
  result.not_written = std::move(why);
}

}  // namespace forcegate
