#pragma once
// `forcegate convert`: a recording from one file format into another.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "hil/trace/column_map.h"

namespace forcegate {

struct ConvertRequest {
  std::filesystem::path from,
      to;  ///< formats by ending: .csv .txt .tsv .dat, .h5 .hdf5, .mat, .fgj (read only)
  std::map<std::string, std::string> column_map;
  double assumed_rate_Hz = 0.0;  ///< 0: a file without a clock is refused
  bool overwrite = false;
};

struct ConvertedChannel {
  std::string name, unit, device;
  std::size_t samples = 0, missing = 0, gaps = 0;
};

struct ConvertReport {
  std::vector<ConvertedChannel> channels;
  double duration_s = 0.0;
  std::vector<std::string> notes;  ///< what was assumed, converted or dropped
  std::map<std::string, std::string> provenance;
};

/// Reads, writes and reports. Refuses to write over an existing file without `overwrite`, and onto its own input.
Result<ConvertReport> convert(const ConvertRequest& request);

}  // namespace forcegate
