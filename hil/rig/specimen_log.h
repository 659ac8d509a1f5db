#pragma once
// What a specimen has been through: an append-only text file, one line for the begin and one for the end of every record.
// The film remembers cycling for hours (Lebosse 2011, section IV), so that a record begins only after a rest.
//   # forcegate specimen log, format 1
//   2026-11-21T13:05:00Z  begin  q50  600      planned seconds
//   2026-11-21T13:15:02Z  end    q50  298      cycles of the wheel                      (separated by tabs)

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "hil/base/result.h"

namespace forcegate {

struct SpecimenHistory {
  std::uint64_t records = 0, cycles = 0;
  double last_use_s = 0.0;  ///< seconds since 1970; of a record without an end, its planned end
};

class SpecimenLog {
 public:
  explicit SpecimenLog(std::filesystem::path file) : file_(std::move(file)) {}

  /// Specimen -> history. A file that does not exist is empty; a last line cut off by a crash is passed over; any other
  /// line that is none is an error with its number.
  Result<std::map<std::string, SpecimenHistory>> read() const;
  /// Rest of a specimen until now_s; nullopt: never used. Negative rests (a clock set back) count as 0.
  Result<std::optional<double>> rest_s(const std::string& specimen, double now_s) const;

  Result<void> begin(const std::string& specimen, double now_s, double planned_s) const;
  Result<void> end(const std::string& specimen, double now_s, std::uint64_t cycles) const;
  const std::filesystem::path& file() const { return file_; }

 private:
  Result<void> append(const std::string& line) const;
  std::filesystem::path file_;
};

}  // namespace forcegate
