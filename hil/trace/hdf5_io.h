#pragma once
// HDF5 files of traces (layout in docs/traces.md). Written under a temporary name and renamed when complete, so that
// a file with the final name is always whole; chunked, shuffled, gzip level 1, in bounded memory.

#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/trace/channel_spec.h"
#include "hil/trace/csv.h"
#include "hil/trace/trace.h"

namespace forcegate {

inline constexpr int kTraceFormat = 1;

/// Appends columns to a new file. Destroyed without close(), it removes the temporary file.
class Hdf5Writer {
 public:
  static Result<Hdf5Writer> create(const std::filesystem::path& path,
                                   const std::vector<TimeBaseSpec>& time_bases,
                                   const std::vector<ChannelSpec>& channels);
  ~Hdf5Writer();
  Hdf5Writer(Hdf5Writer&&) noexcept;
  Hdf5Writer& operator=(Hdf5Writer&&) noexcept;

  Result<void> append_time(std::size_t time_base, std::span<const double> t_s);
  /// The view's type must be the channel's.
  Result<void> append(std::size_t channel, const ColumnView& values);

  /// Facts of a time base that are known at the end.
  void describe(std::size_t time_base, double nominal_rate_Hz, const std::vector<Gap>& gaps, bool invented);

  /// Writes the rest and closes; the file then has its final name. Errors: io.
  Result<void> close(const std::string& name, const std::map<std::string, std::string>& provenance);

 private:
  struct Impl;
  explicit Hdf5Writer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

Result<void> write_hdf5(const Trace& trace, const std::filesystem::path& path);

/// Errors (parse): not HDF5, not a trace of ours, a format newer than kTraceFormat, columns of different length.
Result<TraceFile> read_hdf5(const std::filesystem::path& path);

}  // namespace forcegate
