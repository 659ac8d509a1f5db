#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <nlohmann/json.hpp>

#include "hil/base/text.h"
#include "hil/trace/journal.h"
#include "hil/trace/journal_bytes.h"

namespace forcegate {
namespace {

constexpr std::size_t kPiece = std::size_t{1} << 20;
constexpr std::size_t kLongestHeader = std::size_t{16} << 20;

/// Sliding view of a file: `have(n)` makes at least n bytes available unless the file ends before.
class Window {
 public:
  explicit Window(int descriptor) : descriptor_(descriptor) {}
  ~Window() { ::close(descriptor_); }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  bool have(std::size_t n) {
    while (size() < n && !ended_) {
      if (at_ > 0) {
        buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(at_));
        at_ = 0;
      }
      const std::size_t held = buffer_.size(), want = std::max(kPiece, n - held);
      buffer_.resize(held + want);
      ssize_t got;
      do got = ::read(descriptor_, buffer_.data() + held, want);
      while (got < 0 && errno == EINTR);
      if (got <= 0) {
        ended_ = true;
        error_ = got < 0 ? errno : 0;
        got = 0;
      }
      buffer_.resize(held + static_cast<std::size_t>(got));
    }
    return size() >= n;
  }
  const std::byte* data() const { return buffer_.data() + at_; }
  std::size_t size() const { return buffer_.size() - at_; }
  void skip(std::size_t n) { at_ += n; }
  int error() const { return error_; }

 private:
  int descriptor_;
  std::vector<std::byte> buffer_;
  std::size_t at_ = 0;
  bool ended_ = false;
  int error_ = 0;
};

Unexpected damaged(const std::filesystem::path& path, const std::string& what) {
  return fail(ErrorCode::parse, "this is not a readable journal: " + what, path.string(),
              "only a file that TraceRecorder began can be recovered");
}

Result<JournalHeader> header_of(const std::string& text, const std::filesystem::path& path) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  if (!json.is_object()) return damaged(path, "its header is not JSON");
  JournalHeader header;
  try {
    const int format = json.at("format").get<int>();
    if (format > kJournalFormat)
      return fail(ErrorCode::parse,
                  "the journal has format " + std::to_string(format) + ", this program knows up to " +
                      std::to_string(kJournalFormat),
                  path.string(), "use a newer Forcegate");
    header.name = json.at("name").get<std::string>();
    header.provenance = json.at("provenance").get<std::map<std::string, std::string>>();
    for (const auto& b : json.at("time_bases"))
      header.time_bases.push_back({b.at("device").get<std::string>(), b.at("rate_Hz").get<double>()});
    for (const auto& c : json.at("channels")) {
      const int type = c.at("type").get<int>();
      const auto base = c.at("time_base").get<std::size_t>();
      if (type < 0 || type > static_cast<int>(SampleType::u8) || base >= header.time_bases.size())
        return damaged(path, "a channel of its header is not valid");
      header.channels.push_back({c.at("name").get<std::string>(), c.at("unit").get<std::string>(),
                                 c.at("quantity").get<std::string>(), static_cast<SampleType>(type), base});
    }
  } catch (const nlohmann::json::exception& e) {
    return damaged(path, printable_utf8(e.what()));
  }
  return header;
}

}  // namespace

Result<JournalReport> read_journal(const std::filesystem::path& path,
                                   const std::function<Result<void>(const JournalHeader&)>& on_header,
                                   const std::function<Result<void>(const JournalFrame&)>& visit) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0)
    return fail(ErrorCode::io, std::string("the journal cannot be opened: ") + std::strerror(errno),
                path.string(), "check its name: the journal of a recording that did not end well is called like it, with the ending .fgj");
  Window window(descriptor);

  constexpr std::size_t kFixed = sizeof journal::kMagic + 8;
  if (!window.have(kFixed) || std::memcmp(window.data(), journal::kMagic, sizeof journal::kMagic) != 0)
    return damaged(path, "it does not begin like one");
  std::uint32_t length, check;
  std::memcpy(&length, window.data() + 8, 4);
  std::memcpy(&check, window.data() + 12, 4);
  if (length > kLongestHeader || !window.have(kFixed + length) ||
      journal::crc(0, window.data() + kFixed, length) != check)
    return damaged(path, "its header is cut off or damaged");
  const std::string text(reinterpret_cast<const char*>(window.data()) + kFixed, length);
  FORCEGATE_TRY(const JournalHeader header, header_of(text, path));
  FORCEGATE_CHECK_OK(on_header(header));
  window.skip(kFixed + length);

  JournalReport report;
  bool in_damage = false;
  const auto skip_byte = [&](std::size_t n) {
    report.bytes_skipped += n;
    report.damaged_places += !in_damage;
    in_damage = true;
    window.skip(n);
  };
  while (window.have(1)) {
    journal::FrameHead head;
    const bool whole_head = window.have(sizeof head + 4);
    if (whole_head) std::memcpy(&head, window.data(), sizeof head);
    const bool plausible =
        whole_head && head.marker == journal::kMarker && head.length <= journal::kLargestFrame;
    const std::size_t total = plausible ? sizeof head + head.length + 4 : 0;
    if (!plausible || !window.have(total)) {
      // look for the next marker among the bytes at hand
      const char* from = reinterpret_cast<const char*>(window.data());
      const auto* next =
          window.size() > 1
              ? static_cast<const char*>(::memmem(from + 1, window.size() - 1, &journal::kMarker, 4))
              : nullptr;
      skip_byte(next                ? static_cast<std::size_t>(next - from)
                : window.size() > 3 ? window.size() - 3
                                    : window.size());
      continue;
    }
    std::uint32_t stored;
    std::memcpy(&stored, window.data() + sizeof head + head.length, 4);
    if (journal::frame_crc(head, window.data() + sizeof head) != stored) {
      skip_byte(4);  // past this marker; the search goes on behind it
      continue;
    }
    in_damage = false;
    ++report.frames;
    if (head.kind == static_cast<std::uint16_t>(FrameKind::end)) report.closed = true;
    if (head.kind == static_cast<std::uint16_t>(FrameKind::raw)) ++report.raw_frames;
    FORCEGATE_CHECK_OK(visit({head.device, static_cast<FrameKind>(head.kind), head.time_ns,
                              std::span(window.data() + sizeof head, head.length)}));
    window.skip(total);
  }
  if (window.error() != 0)
    return fail(ErrorCode::io, std::string("the journal cannot be read: ") + std::strerror(window.error()),
                path.string());
  return report;
}

}  // namespace forcegate
