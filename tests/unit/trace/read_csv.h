#pragma once

#include <gtest/gtest.h>

#include <string_view>
#include <utility>

#include "hil/trace/csv.h"

namespace forcegate {

// A text as the file x.csv would be read; empty, and a failure, where it cannot be.
inline TraceFile read(std::string_view text, const CsvOptions& options = {}) {
  auto file = parse_csv(text, "x.csv", options);
  EXPECT_TRUE(file) << (file ? "" : file.error().to_text());
  return file ? std::move(*file) : TraceFile{};
}

}  // namespace forcegate
