#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cassert>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "hil/trace/journal.h"
#include "hil/trace/journal_bytes.h"

namespace forcegate {
namespace {

constexpr std::size_t kBufferLimit = std::size_t{1} << 20;
constexpr std::uint64_t kFlush_ns = 500'000'000;  // of recorded time

std::string header_text(const JournalHeader& header) {
  nlohmann::json json;
  json["format"] = kJournalFormat;
  json["name"] = header.name;
  json["provenance"] = header.provenance;
  json["time_bases"] = nlohmann::json::array();
  for (const TimeBaseSpec& b : header.time_bases)
    json["time_bases"].push_back({{"device", b.device}, {"rate_Hz", b.nominal_rate_Hz}});
  json["channels"] = nlohmann::json::array();
  for (const ChannelSpec& c : header.channels)
    json["channels"].push_back({{"name", c.name},
                                {"unit", c.unit},
                                {"quantity", c.quantity},
                                {"type", static_cast<int>(c.type)},
                                {"time_base", c.time_base}});
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace

struct JournalWriter::Impl {
  Impl(std::filesystem::path where, int fd) : path(std::move(where)), descriptor(fd) {
    syncer = std::jthread([this](const std::stop_token& stop) { keep_syncing(stop); });
  }

  ~Impl() {
    syncer.request_stop();
    if (syncer.joinable()) syncer.join();
    if (!buffer.empty() && write_errno == 0) (void)write_out();
    ::close(descriptor);
  }

  void keep_syncing(const std::stop_token& stop) {
    std::unique_lock lock(mutex);
    while (!wake.wait_for(lock, stop, std::chrono::seconds(1), [] { return false; }) &&
           !stop.stop_requested())
      if (unsynced.exchange(false) && ::fdatasync(descriptor) != 0) sync_errno = errno;
  }

  Unexpected error(int code) const {
    return fail(ErrorCode::io, std::string("the journal cannot be written: ") + std::strerror(code),
                path.string(),
                code == ENOSPC ? "free space on the disk; what is recorded so far can be recovered" : "");
  }

  Result<void> write_out() {
    std::size_t done = 0;
    while (done < buffer.size()) {
      const ssize_t n = ::write(descriptor, buffer.data() + done, buffer.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) {
        write_errno = errno;
        buffer.erase(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(done));
        return error(write_errno);
      }
      done += static_cast<std::size_t>(n);
    }
    buffer.clear();
    unsynced = true;
    return {};
  }

  void put(const void* data, std::size_t n) {
    const auto* bytes = static_cast<const std::byte*>(data);
    buffer.insert(buffer.end(), bytes, bytes + n);
  }

  std::filesystem::path path;
  int descriptor;
  std::vector<std::byte> buffer;
  std::uint64_t flushed_ns = 0;
  int write_errno = 0;
  std::atomic<int> sync_errno{0};
  std::atomic<bool> unsynced{false};
  std::mutex mutex;
  std::condition_variable_any wake;
  std::jthread syncer;
};

JournalWriter::JournalWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
JournalWriter::~JournalWriter() = default;
JournalWriter::JournalWriter(JournalWriter&&) noexcept = default;
JournalWriter& JournalWriter::operator=(JournalWriter&&) noexcept = default;

Result<JournalWriter> JournalWriter::create(const std::filesystem::path& path, const JournalHeader& header) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (descriptor < 0)
    return fail(ErrorCode::io, std::string("the journal cannot be created: ") + std::strerror(errno),
                path.string(), errno == ENOENT ? "create the folder first" : "");
  auto impl = std::make_unique<Impl>(path, descriptor);
  const std::string text = header_text(header);
  const auto length = static_cast<std::uint32_t>(text.size());
  const std::uint32_t check = journal::crc(0, text.data(), text.size());
  impl->put(journal::kMagic, sizeof journal::kMagic);
  impl->put(&length, sizeof length);
  impl->put(&check, sizeof check);
  impl->put(text.data(), text.size());
  FORCEGATE_CHECK_OK(impl->write_out());
  return JournalWriter(std::move(impl));
}

Result<void> JournalWriter::append(const JournalFrame& frame) {
  assert(frame.bytes.size() <= journal::kLargestFrame);
  if (impl_->write_errno != 0) return impl_->error(impl_->write_errno);
  if (const int code = impl_->sync_errno; code != 0) return impl_->error(code);
  const journal::FrameHead head{journal::kMarker,
                                static_cast<std::uint32_t>(frame.bytes.size()),
                                frame.device,
                                static_cast<std::uint16_t>(frame.kind),
                                0,
                                frame.time_ns};
  const std::uint32_t check = journal::frame_crc(head, frame.bytes.data());
  impl_->put(&head, sizeof head);
  impl_->put(frame.bytes.data(), frame.bytes.size());
  impl_->put(&check, sizeof check);
  if (frame.time_ns >= impl_->flushed_ns + kFlush_ns || impl_->buffer.size() >= kBufferLimit) {
    impl_->flushed_ns = frame.time_ns;
    return impl_->write_out();
  }
  return {};
}

Result<void> JournalWriter::flush() {
  if (impl_->write_errno != 0) return impl_->error(impl_->write_errno);
  return impl_->write_out();
}

Result<void> JournalWriter::close() {
  FORCEGATE_CHECK_OK(append({0, FrameKind::end, impl_->flushed_ns, {}}));
  FORCEGATE_CHECK_OK(impl_->write_out());
  if (::fdatasync(impl_->descriptor) != 0) return impl_->error(errno);
  return {};
}

}  // namespace forcegate
