#include "hil/trace/csv_table.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>

#include "hil/base/text.h"
#include "hil/base/units.h"
#include "hil/trace/csv_cells.h"
#include "hil/trace/csv_preamble.h"
#include "hil/trace/date_time.h"
#include "hil/trace/decimal.h"

namespace forcegate {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kChunk = std::size_t{1} << 20;
constexpr std::size_t kLongestLine = std::size_t{64} << 20;
constexpr std::size_t kMostColumns = 4096;

std::string in_quotes(std::string_view text) {
  std::string shown = printable_utf8(text.substr(0, 40));
  return "\"" + shown + (text.size() > 40 ? "...\"" : "\"");
}

/// Eats whole lines; a chunk always ends with '\n'.
class Parser {
 public:
  explicit Parser(std::string name) : name_(std::move(name)) {}

  Result<void> feed(std::string_view chunk, bool last_line_is_cut) {
    const char* p = chunk.data();
    const char* const end = p + chunk.size();
    if (!started_) {
      started_ = true;
      FORCEGATE_CHECK_OK(check_kind(chunk));
      if (chunk.starts_with("\xEF\xBB\xBF")) p += 3;
      skip_preamble(p, end);
    }
    while (p < end) {
      ++line_;
      if (has_header_ && seen_data_) {
        if (const char* next = fast_row(p)) {
          p = next;
          continue;
        }
      }
      const char* const stop = static_cast<const char*>(std::memchr(p, '\n', static_cast<std::size_t>(end - p)));
      std::string_view line(p, static_cast<std::size_t>(stop - p));
      p = stop + 1;
      if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      const std::string_view bare = trim(line);
      if (bare.empty() || bare.front() == '#') {
        if (has_header_) table_.skipped_lines.push_back(line_);
        continue;
      }
      if (!has_header_) {
        FORCEGATE_CHECK_OK(header(line));
        continue;
      }
      FORCEGATE_CHECK_OK(slow_row(line, last_line_is_cut && p >= end));
    }
    return {};
  }

  void expect(std::size_t bytes_in_all, std::size_t bytes_so_far) {
    if (table_.rows() == 0 || bytes_so_far == 0) return;
    const double rows = static_cast<double>(table_.rows()) * static_cast<double>(bytes_in_all) /
                        static_cast<double>(bytes_so_far);
    for (CsvColumn& c : table_.columns) c.value.reserve(static_cast<std::size_t>(rows * 1.01) + 64);
  }

  Result<CsvTable> finish() {
    if (!has_header_)
      return fail(ErrorCode::parse, "the file is empty: not even a header line", name_,
                  "the first line must name the columns, for instance t_s,F_ref_N,U_V");
    for (std::size_t c = 0; c < is_text_.size(); ++c)
      if (is_text_[c])
{
        table_.notes.push_back("column " + in_quotes(table_.columns[c].header) + " holds text and was left out");
        table_.text_columns.push_back({table_.columns[c].header, first_text_[c], text_line_});
      }
    std::size_t at = 0;
    std::erase_if(table_.columns, [&](const CsvColumn&) { return is_text_[at++] != 0; });
    if (table_.rows() == 0)
      return fail(ErrorCode::parse, "the file has a header but no rows of numbers", name_,
                  "check that the recording was not empty");
    return std::move(table_);
  }

 private:
  Unexpected error(std::string text, std::size_t column, std::string hint) const {
    return fail(ErrorCode::parse, std::move(text),
                name_ + ":" + std::to_string(line_) + ":" + std::to_string(column), std::move(hint));
  }

  void skip_preamble(const char*& p, const char* end) {
    const std::size_t above = lines_above_header({p, static_cast<std::size_t>(end - p)});
    if (above == 0) return;
    for (std::size_t i = 0; i < above; ++i) p = static_cast<const char*>(std::memchr(p, '\n', static_cast<std::size_t>(end - p))) + 1;
    line_ += above;
    table_.notes.push_back("the names of the columns stand in line " + std::to_string(line_ + 1) + "; what is above was skipped");
  }

  Result<void> check_kind(std::string_view chunk) const {
    const auto refuse = [&](const char* what, const char* hint) {
      return fail(ErrorCode::parse, std::string("the file is ") + what + ", not CSV", name_, hint);
    };
    if (chunk.starts_with("\x89HDF")) return refuse("HDF5", "give it the ending .h5");
    if (chunk.starts_with("MATLAB 5.0")) return refuse("a MATLAB file", "give it the ending .mat");
    if (chunk.starts_with("\xFF\xFE") || chunk.starts_with("\xFE\xFF"))
      return refuse("UTF-16 text", "save it as UTF-8");
    if (chunk.starts_with("PK\x03\x04")) return refuse("a ZIP archive or spreadsheet", "export the sheet as CSV");
    if (std::memchr(chunk.data(), 0, std::min<std::size_t>(chunk.size(), 4096)))
      return refuse("binary", "export it as CSV");
    return {};
  }

  Result<void> header(std::string_view line) {
    separator_ = choose_separator(line);
    cut_cells(line, separator_, cells_);
    if (cells_.size() > kMostColumns)
      return error("the header has " + std::to_string(cells_.size()) + " columns", 1, "at most 4096 can be read");
    while (cells_.size() > 1 && trim(cells_.back()).empty()) cells_.pop_back(), ++trailing_;
    bool all_numbers = true;
    for (const std::string_view cell : cells_) {
      double value;
      all_numbers = all_numbers && read_cell(cell, '.', value) != CsvCell::text;
    }
    if (all_numbers)
      return error("the first line holds numbers, not column names", 1,
                   "put a line like t_s,F_ref_N,U_V before the first row");
    for (const std::string_view cell : cells_) {
      CsvColumn column;
      column.header = header_text(cell);
      table_.columns.push_back(std::move(column));
    }
    if (separator_ != ',') table_.notes.push_back(std::string("the separator is ") + separator_name());
    for (std::size_t a = 0; a < table_.columns.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        if (!table_.columns[a].header.empty() && table_.columns[a].header == table_.columns[b].header)
          return error("two columns are called " + in_quotes(table_.columns[a].header), 1, "rename or remove one of them");
    is_text_.assign(table_.columns.size(), 0);
    first_text_.resize(table_.columns.size());
    row_.resize(table_.columns.size());
    table_.header_line = line_;
    has_header_ = true;
    return {};
  }

  const char* separator_name() const {
    return separator_ == ';' ? "a semicolon" : separator_ == '\t' ? "a tab" : separator_ == '|' ? "a bar"
           : separator_ == ' ' ? "a blank" : "a comma";
  }

  /// A row of plain numbers, nullptr for anything else.
  const char* fast_row(const char* p) {
    const std::size_t n = row_.size();
    if (trailing_ > 0) return nullptr;
    for (std::size_t c = 0; c < n; ++c) {
      if (is_text_[c]) return nullptr;
      while (*p == ' ') ++p;
      p = read_plain_decimal(p, point_, row_[c]);
      if (!p) return nullptr;
      if (c + 1 == n) break;
      if (*p != separator_) return nullptr;
      ++p;
    }
    if (*p == '\r') ++p;
    if (*p != '\n') return nullptr;
    for (std::size_t c = 0; c < n; ++c) table_.columns[c].value.push_back(row_[c]);
    return p + 1;
  }

  Result<void> slow_row(std::string_view line, bool cut_short) {
    cut_cells(line, separator_, cells_);
    for (std::size_t k = 0; k < trailing_ && cells_.size() > row_.size() && trim(cells_.back()).empty(); ++k)
      cells_.pop_back();
    if (cells_.size() == row_.size() + 1 && trim(cells_.back()).empty()) cells_.pop_back();
    if (!seen_data_) {
      if (row_of_units()) return {};
      if (separator_ != ',' && point_ == '.' && has_decimal_commas()) {
        point_ = ',';
        table_.notes.push_back("the decimals are commas");
      }
    }
    if (cells_.size() != row_.size()) {
      if (cut_short && cells_.size() < row_.size()) {
        table_.notes.push_back("the last line is cut short and was dropped");
        return {};
      }
      const bool doubled = separator_ == ',' && cells_.size() >= 2 * row_.size() - 1;
      return error("the line has " + std::to_string(cells_.size()) + " cells, the header has " +
                       std::to_string(row_.size()) + " columns",
                   line.size() + 1,
                   doubled       ? "these look like decimal commas; write decimal points, or separate the columns by semicolons"
                   : !seen_data_ ? "the first line must name the columns: take out what stands above the line of names; leave a missing value empty"
                                 : "every line needs one cell for each column; leave a missing value empty");
    }
    for (std::size_t c = 0; c < row_.size(); ++c) {
      const CsvCell kind = read_cell(cells_[c], point_, row_[c]);
      if (kind == CsvCell::number || is_text_[c]) continue;
      if (kind == CsvCell::text && cut_short && c + 1 == row_.size()) {
        table_.notes.push_back("the last line is cut short and was dropped");
        return {};
      }
      if (kind == CsvCell::text && !seen_data_) {
        is_text_[c] = 1;
        first_text_[c] = printable_utf8(trim(cells_[c]).substr(0, 40));
        text_line_ = line_;
        row_[c] = kNan;
        continue;
      }
      if (kind == CsvCell::text)
        return error(in_quotes(trim(cells_[c])) + " in column " + in_quotes(table_.columns[c].header) + " is not a number",
                     static_cast<std::size_t>(cells_[c].data() - line.data()) + 1,
                     point_ == ',' && cells_[c].find('.') != std::string_view::npos
                         ? "the decimals of this file are commas; write 1007 and not 1.007"
                         : "leave the cell empty when the value is missing");
      ++table_.columns[c].missing;
    }
    if (!seen_data_)
      for (std::size_t c = 0; c < row_.size(); ++c) table_.columns[c].dates = seconds_of_stamp(unquoted(cells_[c])).has_value();
    seen_data_ = true;
    for (std::size_t c = 0; c < row_.size(); ++c) table_.columns[c].value.push_back(row_[c]);
    return {};
  }

  bool row_of_units() {
    if (cells_.size() != row_.size()) return false;
    bool any = false;
    for (const std::string_view cell : cells_) {
      const std::string_view symbol = trim(cell);
      if (symbol.empty() || symbol == "-" || symbol == "1") continue;
      if (!find_unit(strip_brackets(symbol))) return false;
      any = true;
    }
    if (!any) return false;
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      const std::string_view symbol = strip_brackets(trim(cells_[c]));
      if (find_unit(symbol)) table_.columns[c].header += "_" + std::string(symbol);
    }
    table_.notes.push_back("the second line was read as the units of the columns");
    table_.skipped_lines.push_back(line_);
    return true;
  }

  bool has_decimal_commas() const {
    return std::any_of(cells_.begin(), cells_.end(), [](std::string_view cell) {
      double value;
      return cell.find(',') != std::string_view::npos && read_cell(cell, ',', value) == CsvCell::number;
    });
  }

  std::string name_;
  CsvTable table_;
  std::vector<std::string_view> cells_;
  std::vector<double> row_;
  std::vector<char> is_text_;
  std::vector<std::string> first_text_;
  std::uint64_t text_line_ = 0;
  std::size_t trailing_ = 0;
  std::uint64_t line_ = 0;
  char separator_ = ',', point_ = '.';
  bool started_ = false, has_header_ = false, seen_data_ = false;
};

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
  std::string text(bytes);
  const bool cut = !text.empty() && text.back() != '\n';
  if (cut) text += '\n';
  Parser parser{std::string(name)};
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

  Parser parser{path.string()};
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
