#pragma once
// A campaign: records of one sensor on one bench, as docs/campaign.md describes the files.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/trace/trace.h"

namespace forcegate {

/// What the bench declares about itself. NaN / 0 = not said. Declared resolution, noise and range are what
/// an instrument is allowed to do; they are never a finding.
struct BenchFacts {
  double spring_N_per_mm = kMissing;
  double voltage_min_V = kMissing, voltage_max_V = kMissing;
  double force_min_N = kMissing, force_max_N = kMissing;
  double reference_resolution_N = kMissing, reference_noise_N = kMissing;
  double reference_lowpass_Hz = kMissing;  ///< corner of a filter that only F_ref goes through
  int adc_bits = 0;
  std::string law;

  void forget_converter() { voltage_min_V = voltage_max_V = kMissing, adc_bits = 0; }
};

enum class RecordRole { fit, heldout };

/// One record. Every optional is empty when campaign.json does not say it; then the reader of the value estimates
/// it from the samples and says so.
struct Record {
  std::string name;  ///< file stem
  std::filesystem::path file;  ///< as it was asked for; empty for a record that was never a file
  std::uint64_t header_line = 0;  ///< of a text file; 0 elsewhere
  std::map<std::string, std::string> headers;  ///< name of a channel -> header of its column as written; of text and MAT files
  std::string
      kind;  ///< ramp, staircase, steps, hold, rest, sine, multisine, sweep, prbs, switch ...; "" unknown
  RecordRole role = RecordRole::fit;
  bool role_given = false;
  Trace trace;  ///< channels named F_ref, U, theta, temp, C, F_cmd, F_dut, drive, ... (canonical units)
  std::optional<double> rate_Hz, start_s, rest_before_s, excitation_start_s, f_min_Hz, A_N, m_N, drive_V,
      eccentricity_mm, preload_mm, temp_C, humidity_pct;  ///< the last two of the air, where no channel records them
  std::optional<double> cycles_before;  ///< cycles of the specimen since the record before (of the first: ever) that were not recorded
  std::string mounting;  ///< name or number of the mounting; records that share it were not taken apart in between; "" unknown
  std::optional<bool> dynamic;

  /// For errors about the whole record.
  std::string place() const { return file.empty() ? name : file.string(); }
  /// For errors about its columns.
  std::string place_of_header() const { return place() + (header_line > 0 ? ":" + std::to_string(header_line) : ""); }
};

struct Campaign {
  std::string name;
  std::string sensor;
  std::filesystem::path folder;
  BenchFacts bench;
  std::vector<Record> records;
  std::vector<std::string> notes;  ///< what was estimated, converted, skipped; one sentence each
};

/// Unit of the column U of the first record: "V", "S" where a resistance was read as conductance, "counts", "1" for a ratio. "V" where it says none.
std::string output_unit(const Campaign& campaign);

/// Whether that column holds codes of a converter.
bool is_in_counts(const Campaign& campaign);

struct CampaignOptions {
  std::map<std::string, std::string> column_map;  ///< foreign column name -> "F_ref_N" form
  double assumed_rate_Hz = 0.0;                   ///< for files without a clock; 0 = refuse unless declared
  unsigned threads = 1;                           ///< files read at a time; 0 = one per processor
};

/// `path`: folder with or without campaign.json, campaign.json itself, one CSV, or one HDF5 run of ours.
/// Errors name file, line and column.
Result<Campaign> read_campaign(const std::filesystem::path& path, const CampaignOptions& options = {});

}  // namespace forcegate
