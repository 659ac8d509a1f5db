#include "hil/cli/verbs/bench_line.h"

#include <algorithm>

#include "hil/app/files/beside_program.h"
#include "hil/cli/parse.h"

namespace forcegate {
namespace {

bool has_twins(const std::string& file) {
  const std::vector<BenchRow> rows = list_benches({file});
  return !rows.empty() && rows.front().twins;
}

}  // namespace

std::string bench_words(const Invocation& in, const std::string& file) {
  return file_quoted(file) + (in.given("attach") ? " --attach " + file_quoted(in.text("attach")) : "");
}

std::string line_that_gates_on(const Invocation& in, const std::string& file, const std::string& calibration) {
  const std::string cal = calibration.empty() ? "" : " --cal " + file_quoted(calibration);
  if (!has_twins(file))
    return "gate your build with --rig " + file_quoted(file) + cal + " --arm when nobody reaches into the bench";
  const std::optional<std::string> image = shipped_image("reference.native.so");
  if (!image) return "gate a build of yours on it: forcegate gate FIRMWARE --rig " + file_quoted(file) + cal + " --plan PLAN";
  return "forcegate gate " + file_quoted(*image) + " --rig " + file_quoted(file) +
         (in.given("attach") ? " --rig-option " + shell_quoted("attach=" + in.text("attach")) : "") + " --plan twin" + cal;
}

std::optional<std::string> line_that_parks(const Invocation& in, const std::string& file) {
  if (!in.given("attach") && has_twins(file)) return std::nullopt;
  return "forcegate bench park " + bench_words(in, file);
}

std::string line_after_list(const std::vector<BenchRow>& benches) {
  const auto reads = [](const BenchRow& row) { return row.mistake.empty(); };
  auto row = std::ranges::find_if(benches, [&](const BenchRow& r) { return reads(r) && r.twins; });
  if (row == benches.end()) row = std::ranges::find_if(benches, reads);
  if (row == benches.end()) return "forcegate bench --help";
  return "forcegate bench doctor " + file_quoted(row->file);
}

}  // namespace forcegate
