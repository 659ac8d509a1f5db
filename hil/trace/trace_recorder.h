#pragma once
// Records a trace while it happens: journal beside the final file, HDF5 at close.

#include <filesystem>
#include <optional>
#include <span>

#include "hil/trace/journal.h"

namespace forcegate {

class TraceRecorder {
 public:
  /// The journal is `hdf5` with the ending .fgj. Errors: io; config for a channel without a time base.
  static Result<TraceRecorder> create(const std::filesystem::path& hdf5, JournalHeader header);

  /// Rows of one time base: instants and one column for each of its channels, in header order and of the declared
  /// types. Columns of another length or type are programmer mistakes.
  Result<void> append(std::size_t time_base, std::span<const double> t_s,
                      std::span<const ColumnView> columns);
  /// The first time base.
  Result<void> append(std::span<const double> t_s, std::span<const ColumnView> columns) {
    return append(0, t_s, columns);
  }

  /// Bytes of a device as they came, for the journal only.
  Result<void> append_raw(std::uint16_t device, double t_s, std::span<const std::byte> bytes);

  /// Makes the HDF5 file and removes the journal. Not called (an exception, a crash): the journal stays, and
  /// recover_journal makes the same file of it.
  Result<JournalReport> close();

  const std::filesystem::path& journal_path() const { return journal_; }

 private:
  TraceRecorder(std::filesystem::path hdf5, std::filesystem::path journal, JournalHeader header,
                JournalWriter writer);

  std::filesystem::path hdf5_, journal_;
  JournalHeader header_;
  JournalWriter writer_;
  std::vector<std::byte> payload_;
};

}  // namespace forcegate
