#pragma once
// result.json: the stored form of a run (docs/schema/result.schema.json, docs/report.md).
// Keys in the order of result_fields.h, one indent of two spaces, arrays of numbers on one line. Numbers are
// the shortest decimals that read back to the same double (never more than 17 digits) or, for curves, float.
// NaN is written as null, infinities as the strings "inf" and "-inf". Equal results give equal bytes.

#include <filesystem>
#include <string>
#include <string_view>

#include "hil/base/result.h"
#include "hil/interface/run_result.h"

namespace forcegate {

std::string to_json(const RunResult& result);

/// Inverse of to_json. Errors (parse) name the place inside the document ("cases[3].checks[0].value"): not
/// JSON, another format number, a missing or unknown field, a value of the wrong kind. `name` is the `where`
/// of errors.
Result<RunResult> result_from_json(std::string_view json, const std::string& name = "result.json");

Result<RunResult> read_result(const std::filesystem::path& path);

}  // namespace forcegate
