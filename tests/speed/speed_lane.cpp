// What a sample costs from the profile to the verdict, in CPU time (children included).
//   speed_lane [minutes of record, default 20] [folder of the firmware images, default build/firmware] [native] [rounds, default 11]
// "native": only the native lane beside the bare loop, the two that a limit compares: best and median of the rounds.
// Native lane against a bare loop of the same arithmetic (tests/speed/bare_lane.h), with curves, with all samples
// kept; the block lanes with their instructions; peak memory of a short and of a ten times longer record.

#include <dlfcn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/app/play/worker.h"
#include "hil/gate/case_json.h"
#include "hil/gate/decision.h"
#include "hil/gate/judge.h"
#include "tests/speed/bare_lane.h"

namespace {

using namespace forcegate;
namespace fs = std::filesystem;

double seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

double cpu_s() {
  double sum = 0.0;
  for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    getrusage(who, &usage);
    sum += seconds(usage.ru_utime) + seconds(usage.ru_stime);
  }
  return sum;
}

double best_of(int rounds, const std::function<void()>& work) {
  double best = 1e9;
  for (int i = 0; i < rounds; ++i) {
    const double start = cpu_s();
    work();
    best = std::min(best, cpu_s() - start);
  }
  return best;
}

CaseJob job(const std::string& lane, const fs::path& image, bool closed, double minutes) {
  CaseJob j;
  j.id = "speed/nominal";
  j.rig = "emulated";
  j.lane = lane;
  j.image = fs::absolute(image).string();
  j.nonce = 7;
  j.planned.name = "speed";
  j.planned.loop = closed ? LoopMode::closed : LoopMode::open;
  j.planned.controller = closed ? "force_integral" : "open_loop";
  j.planned.checks = kCheckConformance | (closed ? kCheckPromise : kCheckAccuracy);
  j.planned.maxima_pct = j.planned.minima_pct = 20.0;
  j.planned.limit_source = "ours: speed";
  j.planned.stimulus.name = "sine";
  j.planned.stimulus.numbers = {{"f_Hz", 0.5}, {"A_N", 1.05}, {"m_N", 2.15}, {"duration_s", 60.0 * minutes}};
  j.specimen = "nominal";
  j.safety.force_max_N = 5.2;
  j.curves = false;
  return j;
}

// The whole path of one record: make it, send it through the pipe's text, judge, decide.
void whole(const CaseJob& j) {
  const auto record = record_from_json(to_json(execute_job(j)));
  if (!record || record->failure) {
    std::fprintf(stderr, "the record failed: %s\n",
                 record ? record->failure->error.to_text().c_str() : "not readable");
    std::exit(1);
  }
  Plan plan;
  JudgedCase judged = judge_case(plan, j.planned, *record, {});
  std::vector<JudgedCheck*> checks;
  std::vector<const Check*> list;
  for (JudgedCheck& c : judged.checks) checks.push_back(&c), list.push_back(&c.check);
  apply_rule(plan.rule, checks);
  if (decide(list, plan.rule, {}).reason.empty()) std::exit(1);
}

void print(const char* what, double cpu, double samples, const std::string& rest) {
  std::printf("%-44s %8.1f ns a sample %10.0f x real time%s\n", what, 1e9 * cpu / samples,
              samples / cpu / 1e3, rest.c_str());
  std::fflush(stdout);
}

// In a process of its own, so that nothing before it counts.
double peak_MB(const CaseJob& j) {
  std::fflush(stdout);
  const pid_t pid = fork();
  if (pid == 0) {
    whole(j);
    _exit(0);
  }
  int status = 0;
  rusage usage{};
  if (pid < 0 || wait4(pid, &status, 0, &usage) != pid || status != 0) std::exit(1);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

// The native port by hand (rigs/firmware/ports/native.h).
struct Firmware {
  explicit Firmware(const fs::path& image) {
    void* library = dlopen(fs::absolute(image).c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) std::exit(1);
    start = reinterpret_cast<Start>(dlsym(library, "forcegate_native_open"));
    step = reinterpret_cast<speed::FirmwareStep>(dlsym(library, "forcegate_native_process"));
    if (start == nullptr || step == nullptr) std::exit(1);
  }
  void open(const Calibration& c) const {
    struct {
      float gain_N_per_V, offset_N, v_range_V, b_scale, q_scale;
      std::uint32_t adc_bits;
      char id[16];
    } told{static_cast<float>(c.gain_N_per_V),
           static_cast<float>(c.offset_N),
           static_cast<float>(c.v_range_V),
           static_cast<float>(c.b_scale),
           static_cast<float>(c.q_scale),
           static_cast<std::uint32_t>(c.adc_bits),
           "speed"};
    char info[512];
    if (start(7, &told, info) != 0) std::exit(1);
  }
  using Start = std::int32_t (*)(std::uint32_t nonce, const void* calibration, void* info);
  Start start = nullptr;
  speed::FirmwareStep step = nullptr;
};

}  // namespace

int main(int argc, char** argv) {
  const double minutes = argc > 1 ? std::max(1.0, std::atof(argv[1])) : 20.0;
  const fs::path images = argc > 2 ? argv[2] : "build/firmware";
  const double samples = 60000.0 * minutes;
  const fs::path native = images / "reference.native.so";
  if (!fs::exists(native)) {
    std::fprintf(stderr,
                 "error: there is no %s\nhelp: build first (./ci/build), or name the folder of the images\n",
                 native.c_str());
    return 2;
  }
  const int rounds = argc > 4 ? std::max(1, std::atoi(argv[4])) : 11;
  const bool only_native = argc > 3 && std::string_view(argv[3]) == "native";
  const double long_MB = only_native ? 0.0 : peak_MB(job("native", native, true, 10.0 * minutes));
  const double short_MB = only_native ? 0.0 : peak_MB(job("native", native, true, minutes));

  const CaseJob closed = job("native", native, true, minutes);
  const Firmware firmware(native);
  volatile double sink = 0.0;
  std::vector<double> bare_s, lane_s;
  for (int round = 0; round < rounds; ++round) {  // in turns: what else runs on the machine hits both alike
    firmware.open(closed.calibration);
    bare_s.push_back(best_of(1, [&] {
      sink = speed::bare_lane(static_cast<std::uint64_t>(samples), closed.calibration, firmware.step);
    }));
    lane_s.push_back(best_of(1, [&] { whole(closed); }));
  }
  std::sort(bare_s.begin(), bare_s.end());
  std::sort(lane_s.begin(), lane_s.end());
  const double bare = bare_s.front(), lane = lane_s.front();
  const double bare_median = bare_s[bare_s.size() / 2], lane_median = lane_s[lane_s.size() / 2];
  char text[96];
  std::snprintf(text, sizeof text, "   (median %.1f ns)", 1e9 * bare_median / samples);
  print("bare loop, closed loop", bare, samples, text);
  std::snprintf(text, sizeof text, "   %.2f x the bare loop (median %.1f ns, %.0f x, %.2f)", lane / bare,
                1e9 * lane_median / samples, samples / lane_median / 1e3, lane_median / bare_median);
  print("native, closed loop, profile to decision", lane, samples, text);
  if (only_native) return sink == 0.0 ? 1 : 0;
  const CaseJob open = job("native", native, false, minutes);
  print("native, open loop", best_of(3, [&] { whole(open); }), samples, "");
  CaseJob curves = closed;
  curves.curves = true;
  print("native, with the report's curves", best_of(3, [&] { whole(curves); }), samples, "");
  const fs::path kept = fs::temp_directory_path() / ("forcegate_speed_" + std::to_string(getpid()));
  fs::create_directories(kept);
  CaseJob keep = closed;
  keep.keep_path = (kept / "record.h5").string();
  const double keep_s = best_of(2, [&] { whole(keep); });
  std::snprintf(text, sizeof text, "   %.1f MB", static_cast<double>(fs::file_size(keep.keep_path)) / 1e6);
  print("native, every sample kept (HDF5)", keep_s, samples, text);
  fs::remove_all(kept);
  for (const char* core : {"m4f", "m3"}) {
    const fs::path image = images / (std::string("reference-") + core + ".block.elf");
    if (!fs::exists(image)) continue;
    const CaseJob block = job("block", image, false, minutes);
    const std::string name = std::string("block, ") + core + ", open loop, emulator included";
    // The cost on the target comes from the lane that counts instructions; two minutes hold start window and steady state.
    const auto counted = execute_job(job("tick", image, false, 2.0));
    if (!counted.failure)
      std::snprintf(text, sizeof text, "   %.0f instructions a sample, worst %.0f",
                    counted.resources.instructions_mean, counted.resources.instructions_worst);
    print(name.c_str(), best_of(2, [&] { whole(block); }), samples, counted.failure ? "" : text);
  }
  std::printf("peak memory: %.0f MB for %g min, %.0f MB for %g min\n", short_MB, minutes, long_MB,
              10.0 * minutes);
  return sink == 0.0 ? 1 : 0;
}
