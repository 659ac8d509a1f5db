#include "hil/app/export/compensator_check.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <deque>
#include <fstream>
#include <memory>
#include <tuple>

#include "hil/app/export/recorded_output.h"
#include "hil/base/read_file.h"
#include "hil/base/text.h"
#include "hil/model/rows.h"

extern char** environ;

namespace forcegate {
namespace {

namespace fs = std::filesystem;

constexpr double kFloorMemory_s = 120.0;
constexpr double kTrackerStep_s = 0.1;

// low_N: the force itself; floor_N: what a firmware sees of it.
constexpr const char* kDriver = R"(#include "compensation.h"
void fg_replay(int n, const float* u_N, const float* shrink, const float* low_N, int low_is_force, const float* T_C, float* F_N) {
  FgComp c;
  fg_comp_reset(&c);
  for (int i = 0; i < n; ++i)
    F_N[i] = fg_comp_step(&c, u_N[i], shrink[i], low_is_force ? low_N[i] + c.at_floor_N : low_N[i], T_C[i]);
}
)";
using Replay = void (*)(int, const float*, const float*, const float*, int, const float*, float*);

struct TemporaryFolder {
  fs::path path;   ///< empty: there is none
  fs::path place;  ///< where it was to be made
  TemporaryFolder() {
    std::error_code none;
    place = fs::temp_directory_path(none);
    if (none) return;  // `place` is then empty
    std::string name = (place / "forcegate-check-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) path = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path.empty()) fs::remove_all(path, ignored);
  }
};

class Library {
 public:
  static Result<std::unique_ptr<Library>> build(const std::string& header) {
    auto out = std::make_unique<Library>();
    const fs::path& folder = out->folder_.path;
    if (folder.empty())
      return fail(ErrorCode::io, "there is no place to build the header in", out->folder_.place.empty() ? "TMPDIR" : out->folder_.place.string(),
                  "set TMPDIR to a folder that you may write into, for instance TMPDIR=/tmp");
    FORCEGATE_CHECK_OK(write(folder / "compensation.h", header));
    FORCEGATE_CHECK_OK(write(folder / "replay.c", kDriver));
    const std::string source = (folder / "replay.c").string(), target = (folder / "replay.so").string(),
                      log = (folder / "log").string();
    const char* const words[] = {"cc",
                                 "-std=c11",
                                 "-O2",
                                 "-ffp-contract=off",
                                 "-Wall",
                                 "-Wextra",
                                 "-Wno-unused-function",
                                 "-Werror",
                                 "-fPIC",
                                 "-shared",
                                 source.c_str(),
                                 "-o",
                                 target.c_str(),
                                 nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    posix_spawn_file_actions_adddup2(&actions, 1, 2);
    pid_t pid = 0;
    const int started = posix_spawnp(&pid, "cc", &actions, nullptr, const_cast<char* const*>(words), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (started == ENOENT)
      return fail(ErrorCode::io, "there is no C compiler to build the header with", "cc",
                  "apt-get install gcc");
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
      return fail(ErrorCode::config,
                  "the exported header does not compile: " + read_file(log).value_or("").substr(0, 600),
                  "cc");
    out->handle_ = dlopen(target.c_str(), RTLD_NOW | RTLD_LOCAL);
    out->replay_ =
        out->handle_ == nullptr ? nullptr : reinterpret_cast<Replay>(dlsym(out->handle_, "fg_replay"));
    if (out->replay_ == nullptr) {
      const char* why = dlerror();
      return fail(ErrorCode::io, std::string("the built header cannot be loaded: ") + (why != nullptr ? why : "fg_replay is not in it"), target,
                  "set TMPDIR to a folder on a file system that is not mounted noexec");
    }
    return out;
  }
  ~Library() {
    if (handle_ != nullptr) dlclose(handle_);
  }
  std::vector<float> run(const std::vector<float>& u, const std::vector<float>& shrink,
                         const std::vector<float>& low, bool low_is_force,
                         const std::vector<float>& T) const {
    std::vector<float> F(u.size());
    replay_(static_cast<int>(u.size()), u.data(), shrink.data(), low.data(), low_is_force ? 1 : 0, T.data(),
            F.data());
    return F;
  }

 private:
  static Result<void> write(const fs::path& path, std::string_view text) {
    std::ofstream file(path, std::ios::binary);
    file << text;
    file.close();
    if (file) return {};
    return fail(ErrorCode::io, "the source cannot be written to build the header", path.string(), "is the disk full? TMPDIR chooses another folder");
  }

  TemporaryFolder folder_;
  void* handle_ = nullptr;
  Replay replay_ = nullptr;
};

std::vector<double> resample(const RecordInput& r, const std::vector<double>& x, double rate_Hz,
                             std::size_t n) {
  std::vector<double> out;
  if (x.empty()) return out;
  out.resize(n);
  std::size_t j = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = r.t_s.front() + static_cast<double>(i) / rate_Hz;
    while (j + 2 < r.rows() && r.t_s[j + 1] <= t) ++j;
    const double share = std::clamp((t - r.t_s[j]) / (r.t_s[j + 1] - r.t_s[j]), 0.0, 1.0);
    out[i] = x[j] + share * (x[j + 1] - x[j]);
  }
  return out;
}

// 1 where both rows around an instant hold samples and no gap lies between them; what bridges a gap is an input, no measurement.
std::vector<std::uint8_t> judged_instants(const RecordInput& r, double rate_Hz, std::size_t n) {
  constexpr double kGap = 4.0;  // rows
  std::vector<std::uint8_t> out(n, 0);
  std::size_t j = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = r.t_s.front() + static_cast<double>(i) / rate_Hz;
    while (j + 2 < r.rows() && r.t_s[j + 1] <= t) ++j;
    out[i] = r.ok[j] != 0 && r.ok[j + 1] != 0 && r.t_s[j + 1] - r.t_s[j] <= kGap * r.row_step_s ? 1 : 0;
  }
  return out;
}

// The record at the rate of the compensator: rows and full rate are the same, and its output is what the samples say.
RecordInput at_rate(const Campaign& campaign, const RecordInput& r, double rate_Hz, double most_s) {
  RecordInput out = r;
  const double seconds = std::min(most_s, r.t_s.back() - r.t_s.front());
  const auto n = static_cast<std::size_t>(seconds * rate_Hz);
  out.row_step_s = 1.0 / rate_Hz;
  out.F_N = resample(r, r.F_N, rate_Hz, n);
  out.temp_C = resample(r, r.temp_C, rate_Hz, n);
  out.humidity = resample(r, r.humidity, rate_Hz, n);
  out.theta_rad = resample(r, r.theta_rad, rate_Hz, n);
  out.drive_V = resample(r, r.drive_V, rate_Hz, n);
  out.travel_N = resample(r, r.travel_N, rate_Hz, n);
  out.C_F.clear();
  out.F_cmd_N.clear();
  out.rig_force_N.clear();
  out.ok = judged_instants(r, rate_Hz, n);
  out.t_s.resize(n);
  out.rate_N_per_s.assign(n, 0.0);
  out.row_begin.resize(n + 1);
  for (std::size_t i = 0; i < n; ++i) {
    out.t_s[i] = r.t_s.front() + static_cast<double>(i) / rate_Hz;
    out.row_begin[i] = static_cast<std::uint32_t>(i);
    if (i == 1) out.rate_N_per_s[i] = rate_Hz * (out.F_N[i] - out.F_N[i - 1]);
    if (i > 1) out.rate_N_per_s[i] = rate_Hz * (1.5 * out.F_N[i] - 2.0 * out.F_N[i - 1] + 0.5 * out.F_N[i - 2]);
  }
  out.row_begin[n] = static_cast<std::uint32_t>(n);
  out.U_V = recorded_output(campaign, r, out.t_s);
  if (out.U_V.empty()) out.U_V = resample(r, r.U_V, rate_Hz, n);
  out.fast_t_s = out.t_s;
  out.fast_F_N = out.F_N;
  return out;
}

// Lowest u of the last two minutes of cycling, as the reference firmware tracks U_min.
std::vector<float> tracked_floor(const RecordInput& r, const std::vector<float>& u, double rate_Hz) {
  std::vector<float> out(u.size());
  std::deque<std::pair<std::size_t, float>> least;
  const auto memory = static_cast<std::size_t>(kFloorMemory_s * rate_Hz),
             step = static_cast<std::size_t>(std::max(1.0, kTrackerStep_s * rate_Hz));
  float bucket = 0.0f;
  for (std::size_t i = 0; i < u.size(); ++i) {
    const bool cycling = r.dynamic && r.t_s[i] >= r.onset_s;
    bucket = i % step == 0 ? u[i] : std::min(bucket, u[i]);
    if (cycling && i % step == step - 1) {
      while (!least.empty() && least.back().second >= bucket) least.pop_back();
      least.emplace_back(i, bucket);
      while (least.front().first + memory < i) least.pop_front();
    }
    out[i] = least.empty() ? u[i] : std::min(u[i], least.front().second);
  }
  return out;
}

// Sums for the best straight line from x to F.
struct Line {
  double n = 0, x = 0, F = 0, xx = 0, xF = 0;
  void add(double xi, double Fi, double weight) {
    n += weight, x += weight * xi, F += weight * Fi, xx += weight * xi * xi, xF += weight * xi * Fi;
  }
  std::pair<double, double> fit() const {
    const double v = xx / n - x * x / (n * n), slope = v > 0.0 ? (xF / n - x * F / (n * n)) / v : 1.0;
    return {slope, F / n - slope * x / n};
  }
};

struct Thinned {
  std::vector<float> F, plain, compensated, shrink;
  // As a law is fitted, and calibrated on slow sweeps: by the output, records weighing the same. Counted in newtons, what a decayed record is off
  // would bend the line of all of them.
  void add_to(Line& line, const std::vector<float>& x) const {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const auto D = static_cast<double>(shrink[i]);
      line.add(static_cast<double>(x[i]), static_cast<double>(F[i]), D * D / static_cast<double>(x.size()));
    }
  }
};

// Of the converter, in the output's unit.
struct Step {
  double size = 0.0;
  std::string assumed;
};

Step step_of(const BenchFacts& bench, const std::string& unit) {
  constexpr int kBits = 16;
  constexpr double kRange_V = 10.0;
  if (unit == "counts") return {1.0, ""};
  if (unit != "V") return {};
  const bool has_bits = bench.adc_bits > 0, has_range = std::isfinite(bench.voltage_max_V);
  const double low_V = has_range && std::isfinite(bench.voltage_min_V) ? bench.voltage_min_V : 0.0, range_V = has_range ? bench.voltage_max_V - low_V : kRange_V;
  const int bits = has_bits ? bench.adc_bits : kBits;
  Step out{range_V / (std::ldexp(1.0, bits) - 1.0), ""};
  if (!has_bits || !has_range)
    out.assumed = fmt::format("an LSB is here that of {} bits over {} V; the campaign does not say {}: write {} into \"bench\" of campaign.json", bits, shortest(range_V),
                              has_range  ? "how many bits the converter has"
                              : has_bits ? "what range the converter has"
                                         : "what converter it is",
                              has_range  ? "adc_bits"
                              : has_bits ? "voltage_range_V"
                                         : "adc_bits and voltage_range_V");
  return out;
}

}  // namespace

Result<CompensatorCheck> check_compensator(const Model& model, const Compensator& compensator, double rate_Hz,
                                           const Campaign& campaign, double most_s) {
  FORCEGATE_TRY(const std::unique_ptr<Library> library, Library::build(compensator.header));
  FORCEGATE_TRY(CampaignInput own, make_campaign_input(campaign));
  const CampaignInFrame in_frame(model.frame, std::move(own));
  const CampaignInput& input = in_frame.input();
  CompensatorCheck out;
  out.compiler = "cc -std=c11 -O2 -ffp-contract=off";
  const Step step = step_of(campaign.bench, model.output_unit);
  out.lsb_N = std::fabs(model.law.gain_N_per_V) * step.size;
  out.assumed = step.assumed;
  const double G = model.law.gain_N_per_V, F0 = model.law.offset_N;
  std::vector<Thinned> kept;
  Line plain_line, compensated_line;
  for (const RecordInput& rows : input.records) {
    if (rows.rows() < 16) continue;
    if (const auto of = std::ranges::find(campaign.records, rows.name, &Record::name); compensator.needs_temperature && rows.temp_C.empty())
      return fail(ErrorCode::config, "the model needs a temperature (" + join(compensator.effects, "; ") + "), and this record has none",
                  of != campaign.records.end() ? of->place() : rows.name,
                  "replay the header on records with a column temp_C; without --check it is written all the same");
    RecordInput r = at_rate(campaign, rows, rate_Hz, most_s);
    set_decay(r, model.law);
    r.recording =
        input.records.front().recording;  // no history: the firmware is switched on where the record begins
    FORCEGATE_TRY(const std::vector<double> U, model_output_V(model, in_frame, r));
    const std::size_t n = r.rows();
    std::vector<float> u(n), shrink(n), low(n, static_cast<float>(r.F_min_N)), T(n, 0.0f), recorded(n);
    for (std::size_t i = 0; i < n; ++i) {
      u[i] = static_cast<float>(G * U[i] + F0);
      recorded[i] = static_cast<float>(G * r.U_V[i] + F0);
      shrink[i] = static_cast<float>(r.decay[i]);
      if (!r.temp_C.empty()) T[i] = static_cast<float>(r.temp_C[i]);
    }
    ReplayedRecord item;
    item.record = r.name;
    const auto judged = static_cast<std::size_t>(std::count(r.ok.begin(), r.ok.end(), std::uint8_t{1}));
    item.seconds = static_cast<double>(judged) / rate_Hz;
    item.left_out_s = static_cast<double>(n - judged) / rate_Hz;
    item.cut_s = std::max(0.0, rows.t_s.back() - rows.t_s.front() - most_s);
    const std::vector<float> inverse = library->run(u, shrink, low, true, T);
    for (std::size_t i = 0; i < n; ++i)
      if (const double apart = std::fabs(static_cast<double>(inverse[i]) - r.F_N[i]); r.ok[i] != 0 && !std::isnan(item.largest_N) && !(apart <= item.largest_N))
        item.largest_N = apart, item.largest_at_N = r.F_N[i];
    if (!std::isfinite(item.largest_N))
      return fail(ErrorCode::config, "the compensator gives no number", r.name);

    const std::vector<float> floor = tracked_floor(r, recorded, rate_Hz);
    const std::vector<float> found = library->run(recorded, shrink, floor, false, T);
    Thinned t;
    const auto every = static_cast<std::size_t>(std::max(1.0, 0.05 * rate_Hz));
    for (std::size_t i = every; i < n; i += every) {
      if (r.ok[i] == 0) continue;
      const double above = static_cast<double>(recorded[i] - floor[i]);
      t.F.push_back(static_cast<float>(r.F_N[i]));
      t.plain.push_back(above > 0.0 ? static_cast<float>(static_cast<double>(floor[i]) +
                                                         above / static_cast<double>(shrink[i]))
                                    : recorded[i]);
      t.compensated.push_back(found[i]);
      t.shrink.push_back(shrink[i]);
    }
    if (t.F.empty()) continue;  // no instant of it was measured
    t.add_to(plain_line, t.plain);
    t.add_to(compensated_line, t.compensated);
    kept.push_back(std::move(t));
    out.largest_N = std::max(out.largest_N, item.largest_N);
    out.records.push_back(item);
  }
  if (kept.empty()) return fail(ErrorCode::config, "the campaign has no record to replay", campaign.name);
  const auto rms = [](const std::vector<float>& x, const std::vector<float>& F,
                      std::pair<double, double> line) {
    double sum = 0.0;
    for (std::size_t i = 0; i < x.size(); ++i)
      sum += std::pow(line.first * static_cast<double>(x[i]) + line.second - static_cast<double>(F[i]), 2);
    return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, x.size())));
  };
  double low_N = 1e300, high_N = -1e300;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    ReplayedRecord& item = out.records[k];
    item.plain_rms_N = rms(kept[k].plain, kept[k].F, plain_line.fit());
    item.compensated_rms_N = rms(kept[k].compensated, kept[k].F, compensated_line.fit());
    item.raw_plain_rms_N = rms(kept[k].plain, kept[k].F, {1.0, 0.0});
    item.raw_compensated_rms_N = rms(kept[k].compensated, kept[k].F, {1.0, 0.0});
    Line own_plain, own_compensated;
    kept[k].add_to(own_plain, kept[k].plain);
    kept[k].add_to(own_compensated, kept[k].compensated);
    item.own_plain_rms_N = rms(kept[k].plain, kept[k].F, own_plain.fit());
    item.own_compensated_rms_N = rms(kept[k].compensated, kept[k].F, own_compensated.fit());
    out.plain_rms_N += item.plain_rms_N * item.plain_rms_N / static_cast<double>(kept.size());
    out.compensated_rms_N +=
        item.compensated_rms_N * item.compensated_rms_N / static_cast<double>(kept.size());
    out.raw_plain_rms_N += item.raw_plain_rms_N * item.raw_plain_rms_N / static_cast<double>(kept.size());
    out.raw_compensated_rms_N += item.raw_compensated_rms_N * item.raw_compensated_rms_N / static_cast<double>(kept.size());
    const auto [least, most] = std::ranges::minmax(kept[k].F);
    low_N = std::min(low_N, static_cast<double>(least)), high_N = std::max(high_N, static_cast<double>(most));
  }
  std::tie(out.line_gain, out.line_zero_N) = compensated_line.fit();
  out.span_N = high_N - low_N;
  out.raw_plain_rms_N = std::sqrt(out.raw_plain_rms_N);
  out.raw_compensated_rms_N = std::sqrt(out.raw_compensated_rms_N);
  out.plain_rms_N = std::sqrt(out.plain_rms_N);
  out.compensated_rms_N = std::sqrt(out.compensated_rms_N);
  return out;
}

}  // namespace forcegate
