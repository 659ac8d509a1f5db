#include "hil/rig/specimen_log.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "hil/base/read_file.h"
#include "hil/base/read_number.h"
#include "hil/base/text.h"
#include "hil/base/utc_clock.h"
#include "hil/trace/date_time.h"

namespace forcegate {
namespace {

constexpr const char* kHeader = "# forcegate specimen log, format 1";

}  // namespace

Result<std::map<std::string, SpecimenHistory>> SpecimenLog::read() const {
  std::map<std::string, SpecimenHistory> out;
  std::error_code ignored;
  if (!std::filesystem::exists(file_, ignored)) return out;
  FORCEGATE_TRY(const std::string text, read_file(file_));
  std::size_t from = 0;
  for (int number = 1; from < text.size(); ++number) {
    const std::size_t to = text.find('\n', from);
    if (to == std::string::npos) break;
    const std::string line = text.substr(from, to - from);
    from = to + 1;
    if (line.empty() || (line.front() == '#' && line.starts_with(kHeader))) continue;
    const std::vector<std::string> words = split(line, '\t');
    const auto wrong = [&](const char* what) {
      return fail(ErrorCode::parse, std::string("a line of the specimen log ") + what,
                  fmt::format("{}:{}", file_.string(), number),
                  "mend the line by hand: when was the specimen used last?");
    };
    if (words.size() != 4 || (words[1] != "begin" && words[1] != "end"))
      return wrong("is neither a begin nor an end");
    const auto when_s = seconds_of_stamp(words[0]);
    const auto amount = read_number(words[3]);
    if (!when_s || !amount || *amount < 0.0) return wrong("has no time or no number");
    SpecimenHistory& h = out[words[2]];
    if (words[1] == "begin") {
      ++h.records;
      h.last_use_s = std::max(h.last_use_s, *when_s + *amount);
    } else {
      h.cycles += static_cast<std::uint64_t>(*amount);
      h.last_use_s = *when_s;
    }
  }
  return out;
}

Result<std::optional<double>> SpecimenLog::rest_s(const std::string& specimen, double now_s) const {
  FORCEGATE_TRY(const auto all, read());
  const auto at = all.find(specimen);
  if (at == all.end()) return std::optional<double>();
  return std::optional<double>(std::max(0.0, now_s - at->second.last_use_s));
}

Result<void> SpecimenLog::begin(const std::string& specimen, double now_s, double planned_s) const {
  return append(fmt::format("{}\tbegin\t{}\t{:.0f}\n", utc_text(now_s), specimen, std::ceil(planned_s)));
}

Result<void> SpecimenLog::end(const std::string& specimen, double now_s, std::uint64_t cycles) const {
  return append(fmt::format("{}\tend\t{}\t{}\n", utc_text(now_s), specimen, cycles));
}

Result<void> SpecimenLog::append(const std::string& line) const {
  const int fd = open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  const auto io = [&](const char* what) {
    const std::string why = std::strerror(errno);
    if (fd >= 0) close(fd);
    return fail(ErrorCode::io, std::string("the specimen log cannot be ") + what + ": " + why, file_.string(),
                "without it nobody knows how long the specimen has rested");
  };
  if (fd < 0) return io("opened");
  const off_t size = lseek(fd, 0, SEEK_END);
  char last = '\n';
  if (size > 0 && pread(fd, &last, 1, size - 1) != 1) return io("read");
  // A line that a crash has cut off keeps to itself.
  const std::string text = (size == 0 ? std::string(kHeader) + "\n" : last == '\n' ? "" : "\n") + line;
  if (write(fd, text.data(), text.size()) != static_cast<ssize_t>(text.size()) || fdatasync(fd) != 0)
    return io("written");
  close(fd);
  return {};
}

}  // namespace forcegate
