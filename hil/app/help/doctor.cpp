#include "hil/app/help/doctor.h"

#include <fmt/format.h>
#include <sched.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>

#include "hil/app/files/find_plan.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

using State = DoctorItem::State;
namespace fs = std::filesystem;

std::string find_in_path(const std::string& program) {
  const char* path = std::getenv("PATH");
  for (const std::string& folder : split(path == nullptr ? "" : path, ':')) {
    const fs::path candidate = fs::path(folder.empty() ? "." : folder) / program;
    std::error_code ignored;
    if (fs::is_regular_file(candidate, ignored) && ::access(candidate.c_str(), X_OK) == 0)
      return candidate.string();
  }
  return {};
}

std::string first_line_of(const std::string& program, const char* argument) {
  const std::string command = program + " " + argument + " 2>/dev/null </dev/null";
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(::popen(command.c_str(), "r"), ::pclose);
  char line[256] = "";
  if (!pipe || std::fgets(line, sizeof line, pipe.get()) == nullptr) return {};
  return printable_utf8(trim(line));
}

DoctorItem tool(const std::string& name, const std::string& package, bool required,
                const std::string& used_for) {
  DoctorItem item{
      name, State::missing, required, "not found in PATH", used_for, "sudo apt-get install " + package};
  if (const std::string path = find_in_path(name); !path.empty()) {
    const std::string version = first_line_of(name, "--version");
    item.state = State::ok;
    item.found = version.empty() ? path : version;
    item.remedy.clear();
  }
  return item;
}

DoctorItem processors() {
  const unsigned n = std::thread::hardware_concurrency();
  return {"processors", State::ok, false, fmt::format("{} usable", n), "cases run side by side", ""};
}

DoctorItem serial_ports() {
  DoctorItem item{"serial ports",
                  State::limited,
                  false,
                  "no /dev/ttyUSB*, /dev/ttyACM* or /dev/ttyS* that answers",
                  "real boards, motor drives and ATI boxes",
                  "connect the device; then look at: dmesg | tail"};
  int readable = 0, all = 0;
  std::string names;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/dev", ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("ttyUSB") && !name.starts_with("ttyACM")) continue;
    ++all;
    names += (names.empty() ? "" : ", ") + name;
    if (::access(entry.path().c_str(), R_OK | W_OK) == 0) ++readable;
  }
  if (all == 0) {
    item.found = "no /dev/ttyUSB* or /dev/ttyACM*";
  } else if (readable == all) {
    item = {"serial ports", State::ok, false, names, item.used_for, ""};
  } else {
    item.found = fmt::format("{} of {} may be opened ({})", readable, all, names);
    item.remedy = "sudo usermod -aG dialout \"$USER\", then log in again";
  }
  return item;
}

DoctorItem real_time() {
  const std::string used_for =
      "steady 10 ms control periods on a real bench; the emulated rig needs none of it";
  rlimit limit{};
  ::getrlimit(RLIMIT_RTPRIO, &limit);
  if (::geteuid() == 0 || limit.rlim_cur > 0) {
    // Asking is the only sure way: containers refuse it even to root. The old policy comes back at once.
    sched_param old{}, wanted{};
    ::sched_getparam(0, &old);
    const int policy = ::sched_getscheduler(0);
    wanted.sched_priority = 1;
    if (::sched_setscheduler(0, SCHED_FIFO, &wanted) == 0) {
      ::sched_setscheduler(0, policy, &old);
      return {"SCHED_FIFO", State::ok, false, "permitted", used_for, ""};
    }
  }
  return {"SCHED_FIFO",
          State::limited,
          false,
          "not permitted",
          used_for,
          "echo \"$USER - rtprio 50\" | sudo tee /etc/security/limits.d/forcegate.conf, then log in again"};
}

DoctorItem free_space() {
  std::error_code error;
  const fs::space_info space = fs::space(fs::current_path(error), error);
  const double gigabytes = static_cast<double>(space.available) / 1e9;
  DoctorItem item{"disk space",
                  State::ok,
                  false,
                  fmt::format("{:.1f} GB free here", gigabytes),
                  "journals and traces (about 10 MB for 20 min at 1 kHz)",
                  ""};
  if (!error && gigabytes < 1.0) {
    item.state = State::limited;
    item.remedy = "free at least 1 GB";
  }
  return item;
}

DoctorItem firmware_images(const std::string& program) {
  DoctorItem item{
      "firmware images", State::missing, true, "", "the reference build that the gate is proved with",
      "./ci/build"};
  std::error_code ignored;
  const fs::path folder = fs::weakly_canonical(program, ignored).parent_path() / "firmware";
  std::string missing;
  for (const char* name :
       {"reference.native.so", "reference-m4f.block.elf", "reference-m3.block.elf", "reference.uart.elf"})
    if (!fs::exists(folder / name, ignored)) missing += (missing.empty() ? "" : ", ") + std::string(name);
  item.found = missing.empty() ? folder.string() : "missing in " + folder.string() + ": " + missing;
  if (missing.empty()) {
    item.state = State::ok;
    item.remedy.clear();
  }
  return item;
}

DoctorItem plans() {
  const auto plan = find_plan("smoke");
  if (plan) return {"plans", State::ok, true, plan->parent_path().string(), "what the gate plays when no --plan is given", ""};
  return {"plans", State::missing, true, "there is no plan 'smoke': " + plan.error().where, "what the gate plays when no --plan is given",
          "go to the source tree, which has ci/plans, or give a plan file with --plan"};
}

}  // namespace

std::vector<DoctorItem> examine_machine(const std::string& program) {
  return {
      processors(),
      free_space(),
      firmware_images(program),
      plans(),
      tool("qemu-system-arm", "qemu-system-arm", true, "lanes block, tick and uart: the ELF that ships"),
      tool("arm-none-eabi-gcc", "gcc-arm-none-eabi libnewlib-arm-none-eabi", false,
           "building Cortex-M images; not needed to judge one"),
      tool("python3", "python3 python3-serial", false,
           "instruments driven by Python through the process adapter"),
      serial_ports(),
      real_time(),
      tool("umockdev-run", "umockdev", false, "tests of the HID and serial adapters without hardware"),
      tool("rsvg-convert", "librsvg2-bin", false, "SVG figures as PNG"),
  };
}

}  // namespace forcegate
