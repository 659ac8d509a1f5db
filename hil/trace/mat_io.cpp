#include "hil/trace/mat_io.h"

#include <matio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string_view>

#include "hil/base/output_path.h"
#include "hil/base/some_of.h"
#include "hil/base/text.h"
#include "hil/trace/column_map.h"
#include "hil/trace/columns.h"
#include "hil/trace/missing_count.h"

namespace forcegate {
namespace {

struct CloseFile {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
struct FreeVariable {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using FilePointer = std::unique_ptr<mat_t, CloseFile>;
using VariablePointer = std::unique_ptr<matvar_t, FreeVariable>;

constexpr const char* kHeader = "MATLAB 5.0 MAT-file, written by Forcegate, missing counts are intmin";
constexpr std::string_view kFormerHeader = "MATLAB 5.0 MAT-file, written by Forcegate";  // missing counts were -1

/// A MATLAB name: letters, digits, underscore, a letter first, at most 63.
std::string variable_name(std::string text) {
  for (char& c : text)
    if (!((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_')) c = '_';
  if (text.empty() || !((text[0] >= 'a' && text[0] <= 'z') || (text[0] >= 'A' && text[0] <= 'Z')))
    text = "x" + text;
  return text.substr(0, 63);
}

bool has_former_header(mat_t* file) {
  const char* const text = Mat_GetHeader(file);  // none in level 4
  const std::string_view header(text != nullptr ? text : "");
  return header.substr(0, header.find_last_not_of(' ') + 1) == kFormerHeader;
}

bool put(mat_t* file, const std::string& name, matio_classes kind, matio_types type, std::size_t rows,
         std::size_t columns, const void* data) {
  std::size_t size[2] = {rows, columns};
  const VariablePointer variable(
      Mat_VarCreate(name.c_str(), kind, type, 2, size, const_cast<void*>(data), MAT_F_DONT_COPY_DATA));
  return variable && Mat_VarWrite(file, variable.get(), MAT_COMPRESSION_ZLIB) == 0;
}

template <class T>
void widen(const matvar_t& variable, std::vector<double>& out) {
  const T* values = static_cast<const T*>(variable.data);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = static_cast<double>(values[i]);
}

/// False when the variable is not a real numeric vector.
bool column_of(const matvar_t& v, std::vector<double>& out) {
  if (v.rank != 2 || v.isComplex || !v.data || (v.dims[0] != 1 && v.dims[1] != 1)) return false;
  const std::size_t n = v.dims[0] * v.dims[1];
  if (n < 2) return false;
  const auto holds = [&](std::size_t element) { return v.nbytes >= n * element; };
  out.resize(n);
  switch (v.class_type) {
    case MAT_C_DOUBLE: return holds(8) && (widen<double>(v, out), true);
    case MAT_C_SINGLE: return holds(4) && (widen<float>(v, out), true);
    case MAT_C_INT32: return holds(4) && (widen<std::int32_t>(v, out), true);
    case MAT_C_UINT32: return holds(4) && (widen<std::uint32_t>(v, out), true);
    case MAT_C_INT16: return holds(2) && (widen<std::int16_t>(v, out), true);
    case MAT_C_UINT16: return holds(2) && (widen<std::uint16_t>(v, out), true);
    case MAT_C_INT8: return holds(1) && (widen<std::int8_t>(v, out), true);
    case MAT_C_UINT8: return holds(1) && (widen<std::uint8_t>(v, out), true);
    default: return false;
  }
}

template <class T>
bool read_at(std::ifstream& file, std::uint64_t at, bool swapped, T& out) {
  file.seekg(static_cast<std::streamoff>(at));
  std::array<char, sizeof(T)> bytes;
  if (!file.read(bytes.data(), bytes.size())) return false;
  if (swapped) std::ranges::reverse(bytes);
  std::memcpy(&out, bytes.data(), sizeof out);
  return true;
}

struct Claim {
  std::uint64_t end = 0;     ///< of the last variable; 0 where the file is another kind of MAT file
  std::uint64_t broken = 0;  ///< where something stands that is no variable and leads beyond the file, so that `end` means nothing
};

/// Where the last variable ought to end; matio fills up what a file lacks.
Claim claimed_end(const std::filesystem::path& path, std::uint64_t size) {
  constexpr std::uint64_t kHeader5 = 128, kTag5 = 8, kHeader4 = 20;
  constexpr std::uint32_t kMatrix = 14, kCompressed = 15;
  std::ifstream file(path, std::ios::binary);
  std::uint16_t endian = 0, version = 0;
  if (size >= kHeader5 && read_at(file, 126, false, endian) && (endian == 0x4D49 || endian == 0x494D)) {  // "MI" as this machine writes it, or swapped
    if (!read_at(file, 124, endian != 0x4D49, version) || version != 0x0100) return {};  // 7.3 is HDF5
    std::uint64_t at = kHeader5, last = 0;
    std::uint32_t kind = kMatrix;
    for (std::uint32_t bytes = 0; at + kTag5 <= size && read_at(file, at, endian != 0x4D49, kind) && read_at(file, at + 4, endian != 0x4D49, bytes);) {
      last = at;
      at += kTag5 + bytes;
    }
    return {at, at > size && kind != kMatrix && kind != kCompressed ? last : 0};
  }
  file.clear();
  std::uint64_t at = 0;
  while (at + kHeader4 <= size) {
    std::array<std::int32_t, 5> head{};  // type, rows, columns, imaginary part, length of the name
    for (std::size_t k = 0; k < head.size(); ++k)
      if (!read_at(file, at + 4 * k, false, head[k])) return {};
    constexpr std::array<std::uint64_t, 6> kBytes = {8, 4, 4, 2, 2, 1};
    const auto kind = static_cast<std::size_t>(head[0] / 10 % 10);
    if (head[0] < 0 || head[0] > 99 || kind >= kBytes.size() || head[1] < 0 || head[2] < 0 || head[3] < 0 || head[3] > 1 || head[4] < 0) return {};
    at += kHeader4 + static_cast<std::uint64_t>(head[4]) +
          static_cast<std::uint64_t>(head[1]) * static_cast<std::uint64_t>(head[2]) * kBytes[kind] * static_cast<std::uint64_t>(1 + head[3]);
  }
  return {at};
}

// Why a variable is no column.
std::string why_no_column(const matvar_t& v) {
  if (v.class_type == MAT_C_CHAR) return "text";
  if (v.class_type == MAT_C_STRUCT || v.class_type == MAT_C_CELL || v.class_type == MAT_C_OBJECT) return "a structure or cell: save its fields as vectors";
  if (v.isComplex) return "complex numbers";
  if (v.rank != 2) return std::to_string(v.rank) + " dimensions";
  if (v.dims[0] * v.dims[1] < 2) return v.dims[0] * v.dims[1] == 1 ? "one value" : "empty";
  if (v.dims[0] != 1 && v.dims[1] != 1) return "a matrix of " + std::to_string(v.dims[0]) + " x " + std::to_string(v.dims[1]);
  return "no real numbers";
}

/// "t", "F_ref" and "U" are what every answer is made from; "" for any other.
std::string needed_name(const std::string& header, const CsvOptions& options) {
  const auto mapped = options.column_map.find(header);
  const ColumnMeaning meaning = mapped != options.column_map.end() ? meaning_of_target(mapped->second) : meaning_of(header);
  if (meaning.is_clock) return "t";
  const std::string known = known_name(meaning.name);
  return known == "F_ref" || known == "U" ? known : std::string();
}

/// The length that most vectors share is that of the record. Another one is left out, but for a clock, force or output that nothing else in the file is.
Result<void> keep_one_length(CsvTable& table, std::vector<std::string>& left_out, const std::string& where, const CsvOptions& options) {
  std::map<std::size_t, std::size_t> lengths;
  for (const CsvColumn& c : table.columns) ++lengths[c.value.size()];
  std::size_t length = 0;
  for (const auto& [n, count] : lengths)
    if (length == 0 || count >= lengths[length]) length = n;
  std::vector<std::string> kept;
  for (const CsvColumn& c : table.columns)
    if (c.value.size() == length) kept.push_back(c.header);
  for (const CsvColumn& c : table.columns) {
    if (c.value.size() == length) continue;
    const std::string wanted = needed_name(c.header, options), size = std::to_string(c.value.size());
    const bool is_only_one = std::ranges::none_of(kept, [&](const std::string& header) { return needed_name(header, options) == wanted; });
    if (!wanted.empty() && is_only_one)
      return fail(ErrorCode::parse, c.header + " has " + size + " values, and " + some_of(kept) + (kept.size() == 1 ? " has " : " have ") + std::to_string(length), where,
                  "save them at one length, sample by sample; --map " + shell_quoted(c.header + "=unused") + " leaves it out");
    left_out.push_back(c.header + " (" + size + " values, the record has " + std::to_string(length) + ")");
  }
  std::erase_if(table.columns, [&](const CsvColumn& c) { return c.value.size() != length; });
  return {};
}

// The library tells of no failed write: what stands on the disk is counted.
bool holds(const std::filesystem::path& path, std::size_t variables) {
  std::error_code failed;
  const std::uint64_t size = std::filesystem::file_size(path, failed);
  if (failed || claimed_end(path, size).end > size) return false;
  const FilePointer file(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
  std::size_t found = 0;
  while (file) {
    matvar_t* variable = Mat_VarReadNextInfo(file.get());
    if (variable == nullptr) break;
    Mat_VarFree(variable);
    ++found;
  }
  return found == variables;
}

thread_local bool inflate_failed = false;  // the library tells it in no other way

}  // namespace

Result<void> write_mat(const Trace& trace, const std::filesystem::path& path) {
  FORCEGATE_TRY(const std::filesystem::path target, output_path(path));
  const std::filesystem::path temporary = target.string() + ".part";
  FilePointer file(
      Mat_CreateVer(temporary.c_str(), kHeader, MAT_FT_MAT5));
  const auto failed = [&] {
    file.reset();
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    return fail(ErrorCode::io, "the MAT file cannot be written", path.string(),
                "is the disk full, and does the folder exist?");
  };
  if (!file) return failed();
  std::size_t variables = 0;
  const auto vector = [&](const std::string& name, const std::vector<double>& v) {
    ++variables;
    return put(file.get(), variable_name(name), MAT_C_DOUBLE, MAT_T_DOUBLE, v.size(), 1, v.data());
  };
  bool good = true;
  for (std::size_t k = 0; k < trace.time_bases.size(); ++k)
    good = good && vector(k == 0 ? "t_s" : "t_" + std::to_string(k + 1) + "_s", trace.time_bases[k].t_s);
  for (const Channel& c : trace.channels) {
    const std::string suffix = c.time_base == 0 ? "" : "_at_" + std::to_string(c.time_base + 1);
    good = good && vector(header_of(c.name, c.unit) + suffix, c.value);
    if (!has_counts_beside(c)) continue;
    ++variables;
    good = good && put(file.get(), variable_name(c.name + "_counts" + suffix), MAT_C_INT32, MAT_T_INT32,
                       c.raw.size(), 1, c.raw.data());
  }
  const std::string meta =
      nlohmann::json(trace.provenance).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  good = good && put(file.get(), "provenance", MAT_C_CHAR, MAT_T_UINT8, 1, meta.size(), meta.data());
  ++variables;
  if (!good || Mat_Close(file.release()) != 0 || !holds(temporary, variables)) return failed();
  std::error_code code;
  std::filesystem::rename(temporary, target, code);
  if (code) return failed();
  return {};
}

Result<TraceFile> read_mat(const std::filesystem::path& path, const CsvOptions& options) {
  std::error_code failed;
  if (!std::filesystem::exists(path, failed))
    return fail(ErrorCode::io, "there is no such file", path.string(), "check the name");
  if (const std::uint64_t size = std::filesystem::file_size(path, failed); !failed) {
    const Claim claim = claimed_end(path, size);
    const char* const kAgain = "copy it again from where it was recorded";
    if (claim.broken > 0)
      return fail(ErrorCode::parse, "the MAT file is damaged: no variable begins at byte " + std::to_string(claim.broken), path.string(), kAgain);
    if (claim.end > size)
      return fail(ErrorCode::parse, "the MAT file is cut short: it has " + std::to_string(size) + " of at least " + std::to_string(claim.end) + " bytes", path.string(), kAgain);
  }
  inflate_failed = false;
  Mat_LogInitFunc("forcegate", [](int, char* message) {
    if (message != nullptr && std::strstr(message, "nflate") != nullptr) inflate_failed = true;
  });
  const FilePointer file(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
  if (!file)
    return fail(ErrorCode::parse, "this is not a MAT file of version 4, 5 or 7.3", path.string(),
                "save it with -v7");

  const double missing_count = has_former_header(file.get()) ? -1.0 : kMissingCount;
  CsvTable table;
  table.header_line = 0;
  std::map<std::string, std::string> provenance;
  std::vector<std::string> left_out;
  while (const VariablePointer variable{Mat_VarReadNext(file.get())}) {
    const std::string name = variable->name ? printable_utf8(variable->name) : "";
    if (inflate_failed) break;
    if (name == "provenance" && variable->class_type == MAT_C_CHAR && variable->data &&
        variable->data_size == 1) {
      const auto json = nlohmann::json::parse(
          std::string(static_cast<const char*>(variable->data), variable->nbytes), nullptr, false);
      if (json.is_object())
        for (const auto& [key, value] : json.items())
          if (value.is_string()) provenance[key] = value.get<std::string>();
      continue;
    }
    CsvColumn column;
    column.header = name;
    if (!column_of(*variable, column.value)) {
      left_out.push_back(name + " (" + why_no_column(*variable) + ")");
      continue;
    }
    if (variable->class_type == MAT_C_INT32) std::ranges::replace(column.value, missing_count, kMissing);
    for (double& v : column.value)
      if (!std::isfinite(v)) v = kMissing, ++column.missing;
    table.columns.push_back(std::move(column));
  }
  if (inflate_failed)
    return fail(ErrorCode::parse, "the MAT file is damaged: a variable cannot be unpacked", path.string(), "copy it again from where it was recorded");
  if (table.columns.empty())
    return fail(ErrorCode::parse, "the MAT file holds no real numeric vector" + (left_out.empty() ? std::string() : ", only " + some_of(left_out)), path.string(),
                "store each signal as a vector variable, for instance t_s, F_ref_N, U_V");
  FORCEGATE_CHECK_OK(keep_one_length(table, left_out, path.string(), options));
  if (!left_out.empty()) table.notes.push_back("variables left out: " + join(left_out, ", "));
  FORCEGATE_TRY(TraceFile out,
                trace_of_table(std::move(table), path.string(), path.stem().string(), options));
  out.trace.provenance = std::move(provenance);
  return out;
}

}  // namespace forcegate
