#include "hil/trace/csv_table.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "hil/base/read_file.h"
#include "hil/trace/csv_parser.h"
#include "hil/trace/csv_text.h"

namespace forcegate {
namespace {

constexpr std::size_t kChunk = std::size_t{1} << 20;
constexpr std::size_t kLongestLine = std::size_t{64} << 20;

Unexpected io_error(const std::filesystem::path& path, const char* what) {
  return fail(ErrorCode::io, std::string(what) + ": " + std::strerror(errno), path.string(),
              errno == ENOENT ? "check the name of the file" : "");
}

struct File {
  int descriptor;
  ~File() {
    if (descriptor >= 0) ::close(descriptor);
  }
};

}  // namespace

std::uint64_t CsvTable::line_of_row(std::size_t row) const {
  std::uint64_t line = header_line + 1 + row;
  for (const std::uint64_t skipped : skipped_lines)  // in ascending order
    if (skipped <= line) ++line;
  return line;
}

Result<CsvTable> parse_csv_table(std::string_view bytes, std::string_view name) {
  if (needs_rewriting(bytes)) {
    const RewrittenText plain = rewritten(bytes);
    FORCEGATE_TRY(CsvTable table, parse_csv_table(plain.text, name));
    table.notes.insert(table.notes.begin(), plain.note);
    return table;
  }
  std::string text(bytes);
  const bool cut = !text.empty() && text.back() != '\n';
  if (cut) text += '\n';
  CsvParser parser{std::string(name)};
  FORCEGATE_CHECK_OK(parser.feed(text, cut));
  return parser.finish();
}

Result<CsvTable> read_csv_table(const std::filesystem::path& path) {
  const File file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.descriptor < 0) return io_error(path, "the file cannot be opened");
  struct stat status {};
  if (::fstat(file.descriptor, &status) != 0) return io_error(path, "the file cannot be examined");
  if (S_ISDIR(status.st_mode))
    return fail(ErrorCode::io, "this is a folder, not a CSV file", path.string(), "name a file in it");
  const auto size = static_cast<std::size_t>(std::max<off_t>(0, status.st_size));

  CsvParser parser{path.string()};
  std::vector<char> buffer(kChunk + 1);
  std::size_t held = 0, total = 0;
  bool first = true;
  while (true) {
    if (held + 1 >= buffer.size()) {
      if (buffer.size() > kLongestLine)
        return fail(ErrorCode::parse, "a line is longer than 64 MB", path.string(), "is this really a CSV file?");
      buffer.resize(2 * buffer.size());
    }
    const ssize_t got = ::read(file.descriptor, buffer.data() + held, buffer.size() - 1 - held);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return io_error(path, "the file cannot be read");
    if (got == 0) break;
    if (held == 0 && total == 0 && needs_rewriting({buffer.data(), static_cast<std::size_t>(got)})) {
      FORCEGATE_TRY(const std::string bytes, read_file(path));
      return parse_csv_table(bytes, path.string());
    }
    held += static_cast<std::size_t>(got);
    const void* const newline = ::memrchr(buffer.data(), '\n', held);
    if (!newline) continue;
    const auto whole = static_cast<std::size_t>(static_cast<const char*>(newline) - buffer.data()) + 1;
    FORCEGATE_CHECK_OK(parser.feed({buffer.data(), whole}, false));
    total += whole;
    if (first) parser.expect(size, total);
    first = false;
    std::memmove(buffer.data(), buffer.data() + whole, held - whole);
    held -= whole;
  }
  if (held > 0) {
    buffer[held] = '\n';
    FORCEGATE_CHECK_OK(parser.feed({buffer.data(), held + 1}, true));
  }
  return parser.finish();
}

}  // namespace forcegate
