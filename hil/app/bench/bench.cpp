#include "hil/app/bench/bench.h"

#include <fmt/format.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>

#include "hil/app/files/beside_program.h"
#include "hil/base/text.h"
#include "hil/base/utc_clock.h"
#include "hil/rig/bench_session.h"
#include "hil/rig/slow_move.h"
#include "hil/rig/specimen_log.h"
#include "rigs/emulated/twins/host.h"

namespace forcegate {
namespace {

namespace fs = std::filesystem;
constexpr double kLookPeriod_s = 0.01;
constexpr double kThere_rad = 0.01, kNear_rad = 0.001;

std::string line_of(const fs::path& path) {
  std::ifstream in(path);
  std::string line;
  std::getline(in, line);
  return printable_utf8(trim(line));
}

std::string who(const std::map<std::string, std::string>& details, const char* device) {
  std::vector<std::string> parts;
  for (const char* what : {" model", " serial", " calibration"})
    if (const auto at = details.find(std::string(device) + what); at != details.end())
      parts.push_back(at->second);
  return join(parts, ", ") + (details.contains(std::string(device) + " serial is that of") ? " (by the bench file)" : "");
}

bool is_valid(const ReferenceReading& r) { return r.status == 0 && std::isfinite(r.force_N); }

// Readings that came and of which none says a force.
Result<void> no_valid_reading(const std::vector<ReferenceReading>& readings) {
  const bool overloaded = std::ranges::any_of(readings, [](const ReferenceReading& r) { return (r.status & kRigReferenceSaturated) != 0; });
  return fail(ErrorCode::device,
              fmt::format("none of {} readings within 0.1 s is valid: {}", readings.size(), overloaded ? "the reference is overloaded" : "it answers faults or no number"),
              "reference",
              overloaded ? "unload the sensor and look for what blocks the wheel" : "check its cable and what its maker says of its error codes");
}

std::string what_it_reads(const std::vector<ReferenceReading>& readings, double took_s) {
  const auto last = std::find_if(readings.rbegin(), readings.rend(), is_valid);
  if (last == readings.rend()) return "";
  const auto faulty = readings.size() - static_cast<std::size_t>(std::ranges::count_if(readings, is_valid));
  return fmt::format("{:.3f} N, {} readings in {:.2g} s{}", static_cast<double>(last->force_N), readings.size(), took_s,
                     faulty > 0 ? fmt::format(", {} of them not valid", faulty) : "");
}

}  // namespace

std::string far_from_declared(std::size_t readings, double took_s, double declared_Hz) {
  constexpr double kMost = 3.0;  // adapters hand over what they have gathered
  constexpr std::size_t kGathered = 100;
  if (!(declared_Hz > 0.0) || static_cast<double>(readings) <= kMost * declared_Hz * took_s + kGathered) return {};
  return fmt::format(", and rate_Hz = {} declares {:.0f}", shortest(declared_Hz), declared_Hz * took_s);
}

std::vector<BenchRow> list_benches(const std::vector<fs::path>& files) {
  std::vector<fs::path> found = files;
  if (found.empty()) {
    std::vector<fs::path> folders{"rigs"};
    if (const fs::path program = program_folder(); !program.empty()) folders.push_back(program.parent_path() / "rigs");
    for (const fs::path& folder : folders) {
      std::error_code ignored;
      for (const auto& entry : fs::directory_iterator(folder, ignored))
        if (entry.path().extension() == ".toml") found.push_back(entry.path());
      if (!found.empty()) break;
    }
    std::sort(found.begin(), found.end());
  }
  std::vector<BenchRow> rows;
  for (const fs::path& file : found) {
    BenchRow row;
    row.file = files.empty() ? path_from_here(file) : file.string();
    auto bench = read_bench(file);
    if (bench)
      if (auto checked = check_devices(*bench); !checked) bench = Unexpected(checked.error());
    if (bench && bench->twins)
      if (auto twins = emulated::read_twin_options(bench->root); !twins) bench = Unexpected(twins.error());
    if (bench) {
      row.name = bench->name;
      row.id = bench->id;
      row.doc = bench->doc;
      row.motor = bench->motor_adapter;
      row.reference = bench->reference_adapter;
      row.board = bench->board_adapter;
      row.twins = bench->twins;
    } else {
      row.mistake = bench.error().where + ": " + bench.error().text;
      row.remedy = bench.error().hint;
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

Result<void> no_reading(const std::map<std::string, std::uint64_t>& counts, const std::string& adapter) {
  std::vector<std::string> refused;
  for (const auto& [name, n] : counts)
    if (n > 0) refused.push_back(std::to_string(n) + " " + name);
  if (refused.empty()) return fail(ErrorCode::timeout, "no record within 0.1 s", "reference",
                                    adapter == "process" ? "its program answers 'poll' without rows: is its instrument on, and does it hand over what was measured since the poll before? (docs/adapters.md)"
                                                         : "look at the controller's display");
  return fail(ErrorCode::device, "no record within 0.1 s that can be believed: " + join(refused, ", "), "reference",
              "check scale, units and wiring: counts_per_force, units and force_max_N of [reference]");
}

Result<std::vector<BenchItem>> examine_bench(const fs::path& file,
                                             const std::map<std::string, std::string>& options) {
  FORCEGATE_TRY(const BenchFile bench, read_bench(file));
  std::vector<BenchItem> items;
  const auto given = options.find("today");
  const std::string day = given != options.end() ? given->second : utc_today();
  for (const BenchCalibration& c : bench.calibrations)
    items.push_back({"calibration " + c.what, c.id + ", until " + c.expires,
                     c.expires < day ? "calibrate it anew" : "", c.expires >= day});
  if (const std::string remark = reference_calibration_remark(bench); !remark.empty())
    items.push_back({"calibration", remark, "write reference = { id, expires } of the calibration that the reference runs with under [calibration]", false});
  FORCEGATE_TRY(const auto s, BenchSession::make(bench, options));
  const auto add = [&](const char* device, const Result<void>& opened, std::string found) {
    items.push_back(opened ? BenchItem{device, std::move(found), "", true}
                           : BenchItem{device, opened.error().text, opened.error().hint, false});
  };
  const auto each = s->open_each();
  if (!each) {
    add("bench", Unexpected(each.error()), {});
    return items;
  }
  const auto details = s->details();
  BenchWorld& world = s->world();
  // One tenth of a second of both streams.
  std::vector<ReferenceReading> readings;
  std::vector<BoardSample> samples;
  // Each by itself: what one says wrong is not the silence of the other.
  Result<void> reference = each->reference, board = each->board;
  if (reference) reference = s->reference().start();
  if (board) board = s->board().start();
  const double from_s = world.now_s();
  for (int i = 0; i < 10 && (reference || board); ++i) {
    if (auto moved = world.advance_to(world.now_s() + kLookPeriod_s); !moved) {
      if (reference) reference = moved;
      if (board) board = moved;
    }
    if (reference) reference = s->reference().poll(readings);
    if (board) board = s->board().poll(samples);
  }
  const double took_s = world.now_s() - from_s;
  if (reference && readings.empty()) reference = no_reading(s->reference().counts(), bench.reference_adapter);
  if (reference && std::ranges::none_of(readings, is_valid)) reference = no_valid_reading(readings);
  if (board && samples.empty())
    board = fail(ErrorCode::timeout, "no sample within 0.1 s", "board", "reset the board");
  add("reference", reference, who(details, "reference") + ": " + what_it_reads(readings, took_s));
  if (const std::string far = reference ? far_from_declared(readings.size(), took_s, s->reference().facts().rate_Hz) : std::string(); !far.empty()) {
    items.back().good = false;
    items.back().found += far;
    items.back().remedy = "correct rate_Hz of [reference], or let its adapter hand over every reading once";
  }
  add("board", board,
      samples.empty() ? ""
                      : fmt::format("{}: code {}, {} samples in {:.2g} s", who(details, "board"),
                                    samples.back().adc, samples.size(), took_s));
  if (reference) (void)s->reference().stop();
  if (board) (void)s->board().stop();
  const auto state = each->motor ? s->motor().read() : Result<MotorState>(Unexpected(each->motor.error()));
  add("motor", state ? Result<void>{} : Result<void>(Unexpected(state.error())),
      state ? fmt::format("{}: {:.3f} rad, {}, stops by itself after {:.0f} ms", who(details, "motor"),
                          state->theta_rad,
                          state->fault ? fmt::format("fault {:#x}", state->fault_code) : "no fault",
                          1e3 * s->motor().drive_timeout_s())
            : "");
  if (state && beyond_travel_rad(bench.geometry, state->theta_rad) > kNearTravel_rad) {
    items.back().good = false;
    items.back().found += fmt::format(", outside its travel of {} to {:.3f} rad", shortest(bench.geometry.theta_min_rad), bench.geometry.theta_max_rad);
    items.back().remedy = kIntoTravel;
  }
  if (state && state->fault)
    items.back().good = false, items.back().remedy = "find the cause of the fault in the drive's manual, then forcegate bench reset with the bench file";
  return items;
}

std::vector<ScannedPort> scan_ports() {
  std::vector<ScannedPort> ports;
  std::error_code ignored;
  std::map<std::string, std::string> stable;
  for (const auto& entry : fs::directory_iterator("/dev/serial/by-id", ignored))
    stable[fs::weakly_canonical(entry.path(), ignored).string()] = entry.path().string();
  for (const auto& entry : fs::directory_iterator("/dev", ignored)) {
    const std::string name = entry.path().filename().string();
    const bool serial = name.starts_with("ttyUSB") || name.starts_with("ttyACM"),
               hid = name.starts_with("hidraw");
    if (!serial && !hid) continue;
    ScannedPort port{entry.path().string(), stable[entry.path().string()], {}};
    const fs::path device = fs::path("/sys/class") / (serial ? "tty" : "hidraw") / name / "device";
    if (hid) {
      std::ifstream uevent(device / "uevent");
      for (std::string line; std::getline(uevent, line);)
        if (line.starts_with("HID_NAME=") || line.starts_with("HID_ID="))
          port.description += (port.description.empty() ? "" : ", ") + printable_utf8(line);
    } else {
      const fs::path usb = fs::weakly_canonical(device, ignored).parent_path().parent_path();
      for (const char* what : {"manufacturer", "product", "serial"})
        if (const std::string text = line_of(usb / what); !text.empty())
          port.description += (port.description.empty() ? "" : ", ") + text;
    }
    ports.push_back(std::move(port));
  }
  std::sort(ports.begin(), ports.end(),
            [](const ScannedPort& a, const ScannedPort& b) { return a.port < b.port; });
  return ports;
}

Result<void> serve_bench(const fs::path& file, const fs::path& folder,
                         const std::function<void(const std::vector<std::string>&)>& ready,
                         const std::atomic<bool>& stop) {
  FORCEGATE_TRY(const BenchFile bench, read_bench(file));
  FORCEGATE_TRY(const emulated::TwinOptions options, emulated::read_twin_options(bench.root));
  FORCEGATE_TRY(const auto host, emulated::TwinHost::make(options, fs::absolute(folder)));
  ready(host->endpoints());
  host->serve(stop, false);
  return {};
}

Result<int> park_bench(const fs::path& file, const std::map<std::string, std::string>& options) {
  FORCEGATE_TRY(const BenchFile bench, read_bench(file));
  const auto stopped = stop_motor_now(bench, options);
  // The holder must not command it on; it parks in its own way and its guard after it.
  FORCEGATE_TRY(const auto holder, lease_holder(bench.id));
  if (holder && holder->pid > 1) ::kill(holder->pid, SIGTERM);
  if (holder) (void)stop_motor_now(bench, options);
  if (!stopped) return Unexpected(stopped.error());
  return holder ? holder->pid : 0;
}

Result<std::optional<std::uint32_t>> reset_bench(const fs::path& file, const std::map<std::string, std::string>& options) {
  FORCEGATE_TRY(BenchFile bench, read_bench(file));
  FORCEGATE_TRY(const auto s, BenchSession::make(std::move(bench), options));
  FORCEGATE_TRY(const BenchSession::Opened opened, s->open_each());
  FORCEGATE_CHECK_OK(opened.motor);  // the others may be off
  FORCEGATE_TRY(const MotorState state, s->motor().read());
  if (!state.fault) return std::optional<std::uint32_t>();
  FORCEGATE_CHECK_OK(s->motor().reset_fault());
  return std::optional<std::uint32_t>(state.fault_code);
}

Result<JogResult> jog_bench(const fs::path& file, const std::map<std::string, std::string>& options,
                            double angle_rad, double speed_rad_per_s, const std::atomic<bool>& stop) {
  FORCEGATE_TRY(BenchFile bench, read_bench(file));
  FORCEGATE_TRY(const auto s, BenchSession::make(std::move(bench), options));
  FORCEGATE_CHECK_OK(s->open());
  // Every way out of here passes through BenchSession's destructor, which stops the motor.
  FORCEGATE_TRY(const SlowMoveEnd end, move_slowly(*s, {angle_rad, speed_rad_per_s, kThere_rad, &stop, kNear_rad}));
  return JogResult{end.from_rad, end.to_rad, end.force_N};
}

Result<std::vector<SpecimenRow>> list_specimens(const fs::path& file) {
  FORCEGATE_TRY(const BenchFile bench, read_bench(file));
  if (bench.specimens.log.empty())
    return fail(ErrorCode::config, "the bench file keeps no log of specimens", file.string(),
                "add [specimens] with log = \"specimens.tsv\"");
  FORCEGATE_TRY(const auto all, SpecimenLog(bench.specimens.log).read());
  std::vector<SpecimenRow> rows;
  for (const auto& [id, h] : all) {
    const double rest_s = std::max(0.0, utc_seconds() - h.last_use_s);
    rows.push_back({printable_utf8(id), utc_text(h.last_use_s), h.records, h.cycles, rest_s / 3600.0,
                    rest_s >= bench.specimens.rest_s});
  }
  return rows;
}

Result<std::optional<BenchHolder>> bench_holder(const fs::path& file) {
  FORCEGATE_TRY(const BenchFile bench, read_bench(file));
  FORCEGATE_TRY(const auto holder, lease_holder(bench.id));
  if (!holder) return std::optional<BenchHolder>();
  const double now_s =
      std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
  return std::optional<BenchHolder>(BenchHolder{bench.name, holder->purpose, holder->token, holder->pid,
                                                now_s - holder->since_s, now_s - holder->heartbeat_s});
}

}  // namespace forcegate
