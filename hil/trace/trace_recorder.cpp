#include "hil/trace/trace_recorder.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>

namespace forcegate {
namespace {

constexpr std::size_t kRowsPerFrame = 4096;

std::uint64_t nanoseconds(double t_s) {
  return t_s > 0.0 ? static_cast<std::uint64_t>(std::llround(t_s * 1e9)) : 0;
}

}  // namespace

TraceRecorder::TraceRecorder(std::filesystem::path hdf5, std::filesystem::path journal, JournalHeader header,
                             JournalWriter writer)
    : hdf5_(std::move(hdf5)),
      journal_(std::move(journal)),
      header_(std::move(header)),
      writer_(std::move(writer)) {}

Result<TraceRecorder> TraceRecorder::create(const std::filesystem::path& hdf5, JournalHeader header) {
  for (const ChannelSpec& c : header.channels)
    if (c.time_base >= header.time_bases.size())
      return fail(ErrorCode::config, "channel \"" + c.name + "\" names a time base that is not declared",
                  hdf5.string());
  std::filesystem::path journal = hdf5;
  journal.replace_extension(".fgj");
  FORCEGATE_TRY(JournalWriter writer, JournalWriter::create(journal, header));
  return TraceRecorder(hdf5, std::move(journal), std::move(header), std::move(writer));
}

Result<void> TraceRecorder::append(std::size_t time_base, std::span<const double> t_s,
                                   std::span<const ColumnView> columns) {
  for (std::size_t at = 0; at < t_s.size(); at += kRowsPerFrame) {
    const std::size_t n = std::min(kRowsPerFrame, t_s.size() - at);
    const auto put = [&](const void* data, std::size_t bytes) {
      const auto* from = static_cast<const std::byte*>(data);
      payload_.insert(payload_.end(), from, from + bytes);
    };
    payload_.clear();
    const auto count = static_cast<std::uint32_t>(n);
    put(&count, 4);
    put(t_s.data() + at, n * 8);
    std::size_t k = 0;
    for (const ChannelSpec& spec : header_.channels) {
      if (spec.time_base != time_base) continue;
      assert(k < columns.size() && columns[k].n == t_s.size() && columns[k].type == spec.type);
      const std::size_t size = size_of(spec.type);
      put(static_cast<const std::byte*>(columns[k].data) + at * size, n * size);
      ++k;
    }
    assert(k == columns.size());
    FORCEGATE_CHECK_OK(writer_.append(
        {static_cast<std::uint16_t>(time_base), FrameKind::samples, nanoseconds(t_s[at + n - 1]), payload_}));
  }
  return {};
}

Result<void> TraceRecorder::append_raw(std::uint16_t device, double t_s, std::span<const std::byte> bytes) {
  return writer_.append({device, FrameKind::raw, nanoseconds(t_s), bytes});
}

Result<JournalReport> TraceRecorder::close() {
  FORCEGATE_CHECK_OK(writer_.close());
  auto report = recover_journal(journal_, hdf5_);
  if (!report) return report;
  std::error_code ignored;
  std::filesystem::remove(journal_, ignored);
  return report;
}

}  // namespace forcegate
