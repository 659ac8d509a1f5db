// From a journal to a trace, on disk or in memory.

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "hil/base/text.h"
#include "hil/trace/hdf5_io.h"
#include "hil/trace/journal.h"
#include "hil/trace/missing_count.h"

namespace forcegate {
namespace {

/// Rows of one sample frame, with those left out whose instant does not ascend.
class FrameRows {
 public:
  explicit FrameRows(const JournalHeader& header)
      : header_(header), last_s_(header.time_bases.size(), -HUGE_VAL) {}

  /// False when the frame does not fit the header. Afterwards `t` and `columns` (one for each channel of the base).
  bool read(const JournalFrame& frame) {
    if (frame.device >= header_.time_bases.size() || frame.bytes.size() < 4) return false;
    std::uint32_t n;
    std::memcpy(&n, frame.bytes.data(), 4);
    std::size_t row_bytes = 8;
    channels.clear();
    for (std::size_t c = 0; c < header_.channels.size(); ++c)
      if (header_.channels[c].time_base == frame.device) {
        channels.push_back(c);
        row_bytes += size_of(header_.channels[c].type);
      }
    if (frame.bytes.size() != 4 + row_bytes * n) return false;

    const std::byte* from = frame.bytes.data() + 4;
    std::vector<double> stamps(n);
    if (n > 0) std::memcpy(stamps.data(), from, n * 8);
    from += n * std::size_t{8};
    keep_.clear();
    t.clear();
    double& last = last_s_[frame.device];
    for (std::uint32_t i = 0; i < n; ++i)
      if (stamps[i] > last && stamps[i] < HUGE_VAL) {
        last = stamps[i];
        t.push_back(stamps[i]);
        keep_.push_back(i);
      }
    dropped = n - t.size();
    columns.resize(channels.size());
    for (std::size_t k = 0; k < channels.size(); ++k) {
      const std::size_t size = size_of(header_.channels[channels[k]].type);
      columns[k].resize(t.size() * size);
      for (std::size_t i = 0; i < keep_.size(); ++i)
        std::memcpy(columns[k].data() + i * size, from + keep_[i] * size, size);
      from += n * size;
    }
    return true;
  }

  std::vector<double> t;
  std::vector<std::size_t> channels;
  std::vector<std::vector<std::byte>> columns;
  std::size_t dropped = 0;

 private:
  const JournalHeader& header_;
  std::vector<double> last_s_;
  std::vector<std::size_t> keep_;
};

/// Where the rows of a journal go.
class Sink {
 public:
  virtual ~Sink() = default;
  virtual Result<void> begin(const JournalHeader& header) = 0;
  virtual Result<void> rows(std::size_t base, const FrameRows& rows) = 0;
};

struct Recovered {
  JournalReport report;
  JournalHeader header;
  std::vector<std::vector<Gap>> gaps;
};

Result<Recovered> pour(const std::filesystem::path& path, Sink& sink) {
  Recovered out;
  std::optional<FrameRows> rows;
  std::vector<std::size_t> count;
  std::vector<double> last;
  std::uint64_t samples = 0, dropped = 0, misfits = 0;
  double last_s = 0.0;
  auto read = read_journal(
      path,
      [&](const JournalHeader& header) -> Result<void> {
        out.header = header;
        out.gaps.resize(header.time_bases.size());
        count.assign(header.time_bases.size(), 0);
        last.assign(header.time_bases.size(), 0.0);
        rows.emplace(out.header);
        return sink.begin(out.header);
      },
      [&](const JournalFrame& frame) -> Result<void> {
        if (frame.kind != FrameKind::samples) return {};
        if (!rows->read(frame)) {
          ++misfits;
          return {};
        }
        const double rate = out.header.time_bases[frame.device].nominal_rate_Hz;
        std::size_t& n = count[frame.device];
        for (const double t : rows->t) {
          if (rate > 0.0 && n > 0 && (t - last[frame.device]) * rate > 1.5)
            out.gaps[frame.device].push_back({n, last[frame.device], t});
          last[frame.device] = t;
          ++n;
        }
        samples += rows->t.size();
        dropped += rows->dropped;
        if (!rows->t.empty()) last_s = std::max(last_s, rows->t.back());
        return sink.rows(frame.device, *rows);
      });
  if (!read) return tl::unexpected(std::move(read).error());
  out.report = *read;
  out.report.samples = samples;
  out.report.rows_dropped = dropped;
  out.report.last_s = last_s;
  out.report.damaged_places += misfits;
  if (!out.report.closed || out.report.bytes_skipped > 0 || misfits > 0)
    out.header.provenance["recovered"] =
        std::string(out.report.closed ? "the recording is damaged" : "the recording was interrupted") + ": " +
        std::to_string(samples) + " rows saved, the last at " + shortest(last_s) + " s, " +
        std::to_string(out.report.bytes_skipped) + " bytes skipped";
  return out;
}

class Hdf5Sink : public Sink {
 public:
  explicit Hdf5Sink(std::filesystem::path path) : path_(std::move(path)) {}
  Result<void> begin(const JournalHeader& header) override {
    auto made = Hdf5Writer::create(path_, header.time_bases, header.channels);
    if (!made) return tl::unexpected(std::move(made).error());
    writer.emplace(std::move(*made));
    channels_ = header.channels;
    return {};
  }
  Result<void> rows(std::size_t base, const FrameRows& r) override {
    FORCEGATE_CHECK_OK(writer->append_time(base, r.t));
    for (std::size_t k = 0; k < r.channels.size(); ++k)
      FORCEGATE_CHECK_OK(
          writer->append(r.channels[k], {r.columns[k].data(), r.t.size(), channels_[r.channels[k]].type}));
    return {};
  }
  std::optional<Hdf5Writer> writer;

 private:
  std::filesystem::path path_;
  std::vector<ChannelSpec> channels_;
};

template <class T>
void append_as(const std::vector<std::byte>& bytes, std::size_t n, Channel& channel, bool counts) {
  for (std::size_t i = 0; i < n; ++i) {
    T value;
    std::memcpy(&value, bytes.data() + i * sizeof(T), sizeof(T));
    if (counts) channel.raw.push_back(static_cast<std::int32_t>(value));
    channel.value.push_back(counts ? value_of_count(channel.raw.back()) : static_cast<double>(value));
  }
}

class MemorySink : public Sink {
 public:
  Result<void> begin(const JournalHeader& header) override {
    for (const TimeBaseSpec& b : header.time_bases) {
      TimeBase base;
      base.device = b.device;
      base.nominal_rate_Hz = b.nominal_rate_Hz;
      trace.time_bases.push_back(std::move(base));
    }
    for (const ChannelSpec& c : header.channels)
      trace.channels.push_back({c.name, c.unit, c.quantity, c.time_base, {}, {}});
    specs_ = header.channels;
    return {};
  }
  Result<void> rows(std::size_t base, const FrameRows& r) override {
    auto& t = trace.time_bases[base].t_s;
    t.insert(t.end(), r.t.begin(), r.t.end());
    for (std::size_t k = 0; k < r.channels.size(); ++k) {
      Channel& channel = trace.channels[r.channels[k]];
      switch (specs_[r.channels[k]].type) {
        case SampleType::f64: append_as<double>(r.columns[k], r.t.size(), channel, false); break;
        case SampleType::f32: append_as<float>(r.columns[k], r.t.size(), channel, false); break;
        case SampleType::i32: append_as<std::int32_t>(r.columns[k], r.t.size(), channel, true); break;
        case SampleType::u16: append_as<std::uint16_t>(r.columns[k], r.t.size(), channel, true); break;
        case SampleType::u8: append_as<std::uint8_t>(r.columns[k], r.t.size(), channel, true); break;
      }
    }
    return {};
  }
  Trace trace;

 private:
  std::vector<ChannelSpec> specs_;
};

}  // namespace

Result<JournalReport> recover_journal(const std::filesystem::path& journal,
                                      const std::filesystem::path& hdf5) {
  Hdf5Sink sink(hdf5);
  FORCEGATE_TRY(Recovered found, pour(journal, sink));
  for (std::size_t k = 0; k < found.gaps.size(); ++k)
    sink.writer->describe(k, found.header.time_bases[k].nominal_rate_Hz, found.gaps[k], false);
  FORCEGATE_CHECK_OK(sink.writer->close(found.header.name, found.header.provenance));
  return found.report;
}

Result<TraceFile> read_journal_trace(const std::filesystem::path& journal) {
  MemorySink sink;
  FORCEGATE_TRY(Recovered found, pour(journal, sink));
  TraceFile out;
  out.trace = std::move(sink.trace);
  out.trace.name = found.header.name;
  out.trace.provenance = found.header.provenance;
  for (std::size_t k = 0; k < found.gaps.size(); ++k) out.trace.time_bases[k].gaps = std::move(found.gaps[k]);
  if (const auto note = out.trace.provenance.find("recovered"); note != out.trace.provenance.end())
    out.notes.push_back(note->second);
  for (std::size_t i = 0; i < out.trace.channels.size(); ++i) {
    Channel& counts = out.trace.channels[i];
    const auto physical =
        std::find_if(out.trace.channels.begin(), out.trace.channels.end(), [&](const Channel& c) {
          return !counts.raw.empty() && &c != &counts && c.name == counts.name && c.raw.empty() &&
                 c.time_base == counts.time_base;
        });
    if (physical == out.trace.channels.end()) continue;
    physical->raw = std::move(counts.raw);
    out.trace.channels.erase(out.trace.channels.begin() + static_cast<std::ptrdiff_t>(i--));
  }
  return out;
}

}  // namespace forcegate
