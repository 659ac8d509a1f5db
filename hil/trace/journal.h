#pragma once
// Append-only recording that survives the death of the program: header, then frames of marker, length, device, kind,
// time, bytes and CRC-32 (byte table in docs/traces.md). Whatever was cut off or damaged, the frames that are whole
// can be read.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/trace/channel_spec.h"
#include "hil/trace/csv.h"

namespace forcegate {

inline constexpr int kJournalFormat = 1;

struct JournalHeader {
  std::string name;  ///< of the recording
  std::vector<TimeBaseSpec> time_bases;
  std::vector<ChannelSpec> channels;
  std::map<std::string, std::string> provenance;
};

enum class FrameKind : std::uint16_t {
  samples =
      0,  ///< u32 n, n instants f64, then n values of each channel of the time base `device`, in header order
  raw = 1,  ///< bytes of a device as they came
  end = 2,  ///< the recording was closed properly; no bytes
};

struct JournalFrame {
  std::uint16_t device = 0;
  FrameKind kind = FrameKind::samples;
  std::uint64_t time_ns = 0;
  std::span<const std::byte> bytes;
};

/// Writes frames. Buffered bytes go to the operating system at each half second of recorded time (they then survive
/// `kill -9`), and to the disk once a second of wall time by a thread of its own (they then survive a power cut).
/// Memory: half a second of recording, at most 1 MB. Errors: io (a full disk is reported by the append that met it
/// and by every call after it; the file stays readable up to there).
class JournalWriter {
 public:
  static Result<JournalWriter> create(const std::filesystem::path& path, const JournalHeader& header);
  ~JournalWriter();
  JournalWriter(JournalWriter&&) noexcept;
  JournalWriter& operator=(JournalWriter&&) noexcept;

  /// At most 16 MB a frame.
  Result<void> append(const JournalFrame& frame);
  Result<void> flush();
  /// Marks the end and syncs.
  Result<void> close();

 private:
  struct Impl;
  explicit JournalWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// What was found while reading a journal.
struct JournalReport {
  std::uint64_t frames = 0;
  std::uint64_t samples = 0;  ///< rows of all time bases
  std::uint64_t raw_frames = 0;
  std::uint64_t bytes_skipped = 0;   ///< damaged or cut off
  std::uint64_t damaged_places = 0;  ///< stretches of skipped bytes
  std::uint64_t rows_dropped = 0;    ///< instants that did not ascend
  double last_s = 0.0;               ///< latest instant that was saved
  bool closed = false;               ///< the recording ended properly
};

/// Reads in 1 MB pieces and hands over each whole frame; the bytes are valid during the call. Errors: io, parse when
/// the header itself is damaged or newer than kJournalFormat, and what `visit` returns.
Result<JournalReport> read_journal(const std::filesystem::path& path,
                                   const std::function<Result<void>(const JournalHeader&)>& header,
                                   const std::function<Result<void>(const JournalFrame&)>& visit);

/// Makes the HDF5 file of a journal, whole or not, in bounded memory. The journal stays. Provenance gets "recovered"
/// (a sentence) when the recording was not closed or has damage.
Result<JournalReport> recover_journal(const std::filesystem::path& journal,
                                      const std::filesystem::path& hdf5);

/// The same into memory.
Result<TraceFile> read_journal_trace(const std::filesystem::path& journal);

}  // namespace forcegate
