#pragma once
// `forcegate bench`: what is on the table, and hands on it.

#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hil/base/result.h"

namespace forcegate {

struct BenchRow {
  std::string file, name, id, doc;
  std::string motor, reference, board;  ///< adapters
  bool twins = false;
  std::string mistake;  ///< text of what is wrong with the file; "" = it reads
  std::string remedy;   ///< how to mend it
};
/// Files of the given folders and the ones beside the program.
std::vector<BenchRow> list_benches(const std::vector<std::filesystem::path>& files);

struct BenchItem {
  std::string name, found, remedy;
  bool good = true;
};
/// What to say of more readings than `declared_Hz` (0: none is declared) and an adapter's store of them explain; "" of others.
std::string far_from_declared(std::size_t readings, double took_s, double declared_Hz);

/// Why a reference, read by the adapter of that name, gave no reading: records that came and were not taken (`counts`) say where to look.
Result<void> no_reading(const std::map<std::string, std::uint64_t>& counts, const std::string& adapter);

/// Opens every instrument, asks who it is and for one reading; nothing moves.
Result<std::vector<BenchItem>> examine_bench(const std::filesystem::path& file,
                                             const std::map<std::string, std::string>& options);

struct ScannedPort {
  std::string port, stable_name, description;
};
std::vector<ScannedPort> scan_ports();

/// Serves the twins of a bench file until `stop`; `ready` is told where the wires are.
Result<void> serve_bench(const std::filesystem::path& file, const std::filesystem::path& folder,
                         const std::function<void(const std::vector<std::string>& endpoints)>& ready,
                         const std::atomic<bool>& stop);

/// Stops the motor at once whoever holds the bench, and asks the holder to end (SIGTERM). The holder's pid, 0: nobody.
Result<int> park_bench(const std::filesystem::path& file, const std::map<std::string, std::string>& options);

/// Stops the motor and makes the drive forget its fault; nothing moves, and the bench must be free. The fault that it
/// reported, nothing where it reported none.
Result<std::optional<std::uint32_t>> reset_bench(const std::filesystem::path& file, const std::map<std::string, std::string>& options);

struct JogResult {
  double from_rad = 0.0, to_rad = 0.0, force_N = 0.0;
};
/// Turns the wheel to an angle at a slow speed, under the limits of the bench file.
Result<JogResult> jog_bench(const std::filesystem::path& file,
                            const std::map<std::string, std::string>& options, double angle_rad,
                            double speed_rad_per_s, const std::atomic<bool>& stop);

struct SpecimenRow {
  std::string id, last_use;
  std::uint64_t records = 0, cycles = 0;
  double rest_h = 0.0;
  bool rested = false;  ///< as long as the bench file asks for
};
/// ErrorCode::config when the bench file has no [specimens].
Result<std::vector<SpecimenRow>> list_specimens(const std::filesystem::path& file);

struct BenchHolder {
  std::string bench, purpose, token;
  int pid = 0;
  double held_s = 0.0, silent_s = 0.0;
};
Result<std::optional<BenchHolder>> bench_holder(const std::filesystem::path& file);

}  // namespace forcegate
