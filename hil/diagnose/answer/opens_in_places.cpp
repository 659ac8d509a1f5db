#include "hil/diagnose/answer/opens_in_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/base/quantile.h"
#include "hil/base/some_of.h"
#include "hil/diagnose/answer/load_direction.h"
#include "hil/trace/static_line.h"

namespace forcegate::diagnose {
namespace {

struct Opened {
  std::size_t times = 0;   // between two loads
  double deepest_N = 0.0;  // that the law goes below the zero
  double zero_N = 0.0, rows = 0.0;
  double before_N2 = 0.0, after_N2 = 0.0;  // sums over all rows of the record
};

// Runs of open rows with a closed contact before and after them.
std::size_t times_between_loads(const RecordInput& r, const std::vector<std::uint8_t>& open, double closed_N) {
  std::size_t out = 0;
  bool was_closed = false, open_since = false;
  for (std::size_t i = 0; i < r.rows(); ++i) {
    if (r.ok[i] == 0) continue;
    if (open[i] != 0) {
      open_since = was_closed;
      continue;
    }
    if (r.F_N[i] < closed_N) continue;
    out += open_since ? 1 : 0;
    open_since = false;
    was_closed = true;
  }
  return out;
}

// The closed contact's line of F over angle or command.
struct ClosedLine {
  double slope = 0.0, offset_N = 0.0;
  double left_N = 0.0;  // a typical row's distance, as a standard deviation
};

// Most rows tell it: where the contact closes again the wheel bounces.
std::optional<ClosedLine> closed_line(const RecordInput& r, const std::vector<double>& drive, double closed_N) {
  constexpr double kLine = 0.9, kOfMedian = 0.6745, kBounces = 3.0, kRounding = 1e-9;
  constexpr double kFewest = 50.0;
  constexpr int kRounds = 3;
  std::optional<ClosedLine> out;
  for (int round = 0; round < kRounds; ++round) {
    StaticLine line;
    std::vector<double> off_N;
    const auto off = [&](std::size_t i) { return std::abs(r.F_N[i] - out->offset_N - out->slope * drive[i]); };
    for (std::size_t i = 0; i < r.rows(); ++i)
      if (r.ok[i] != 0 && r.F_N[i] > closed_N && (!out || off(i) <= kBounces * out->left_N + kRounding * closed_N)) line.push(drive[i], r.F_N[i]);
    if (line.n() < kFewest || !(line.variance_V2() > 0.0) || !(line.covariance_VN() > 0.0) || std::pow(line.residual_N(), 2) > (1.0 - kLine) * line.variance_N2()) return std::nullopt;
    out = ClosedLine{line.gain_N_per_V(), line.offset_N()};
    for (std::size_t i = 0; i < r.rows(); ++i)
      if (r.ok[i] != 0 && r.F_N[i] > closed_N) off_N.push_back(off(i));
    out->left_N = quantile(std::move(off_N), 0.5) / kOfMedian;
  }
  return out;
}

constexpr double kClosed = 0.05;  // of the range

// What the closed contact's line makes of the drive at every row.
struct Law {
  std::vector<double> force_N;
  double left_N;
};

std::optional<Law> law_of(const RecordInput& r, double range_N) {
  // a command that runs through its range from row to row makes no law, and shows all the same where it goes below nothing
  const std::vector<double>& drive = r.rig_force_N.size() == r.rows() || !r.theta_rad.empty() ? r.rig_force_N : r.F_cmd_N;
  if (drive.size() != r.rows()) return std::nullopt;
  const std::optional<ClosedLine> closed = closed_line(r, drive, kClosed * range_N);
  if (!closed) return std::nullopt;
  Law out{{}, closed->left_N};
  for (const double d : drive) out.force_N.push_back(closed->offset_N + closed->slope * d);
  return out;
}

Opened opened(const RecordInput& r, double range_N) {
  constexpr double kMargin = 0.015, kZero = 0.03, kFlat = 0.02;  // of the range
  constexpr double kTimesLeft = 3.0, kSlope = 0.2;
  constexpr std::size_t kFewestOpen = 8, kFewestTimes = 2;
  const std::optional<Law> of_closed = law_of(r, range_N);
  if (!of_closed) return {};
  const std::vector<double>& law_N = of_closed->force_N;
  const double margin_N = std::max(kTimesLeft * of_closed->left_N, kMargin * range_N);

  std::vector<double> rest_N;
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (r.ok[i] != 0 && law_N[i] < -margin_N) rest_N.push_back(r.F_N[i]);
  if (rest_N.size() < kFewestOpen) return {};
  Opened out;
  out.zero_N = quantile(rest_N, 0.5);
  if (std::abs(out.zero_N) > kZero * range_N) return {};
  StaticLine at_rest;
  std::vector<std::uint8_t> open(r.rows(), 0);
  double off_N2 = 0.0;
  for (std::size_t i = 0; i < r.rows(); ++i) {
    if (r.ok[i] == 0) continue;
    const double law = law_N[i], off = r.F_N[i] - out.zero_N;
    out.rows += 1.0;
    out.before_N2 += (r.F_N[i] - law) * (r.F_N[i] - law);
    out.after_N2 += std::pow(r.F_N[i] - std::max(law, out.zero_N), 2);
    if (!(law < out.zero_N - margin_N)) continue;
    open[i] = 1;
    at_rest.push(law, r.F_N[i]);
    off_N2 += off * off;
    out.deepest_N = std::max(out.deepest_N, out.zero_N - law);
  }
  if (at_rest.n() < kFewestOpen || std::sqrt(off_N2 / at_rest.n()) > kFlat * range_N) return {};
  if (at_rest.variance_V2() > 0.0 && std::abs(at_rest.gain_N_per_V()) > kSlope) return {};
  out.times = times_between_loads(r, open, kClosed * range_N);
  return out.times < kFewestTimes ? Opened{} : out;
}

// The record's own closed contact tells the law: nothing in it is unseen.
EvidenceSeries picture_of(const RecordInput& r, double zero_N, double range_N, const std::string& against) {
  constexpr std::size_t kPoints = 700;
  const std::vector<double> law_N = law_of(r, range_N)->force_N, direction = load_direction(r, range_N);
  const bool over_time = against == "time";
  EvidenceSeries out;
  out.title = "F_ref less the rig's law against " + against + ", coloured by direction, in " + r.name;
  out.x_name = against;
  out.x_unit = over_time ? "s" : "N";
  out.y_unit = "N";
  for (std::size_t i = 0; i < r.rows(); i += std::max<std::size_t>(1, r.rows() / kPoints)) {
    if (r.ok[i] == 0) continue;
    out.x.push_back(over_time ? r.t_s[i] : law_N[i]);
    out.before.push_back(r.F_N[i] - law_N[i]);
    out.after.push_back(r.F_N[i] - std::max(law_N[i], zero_N));
    out.colour.push_back(direction[i]);
  }
  return out;
}

}  // namespace

std::optional<Finding> contact_that_opens(const Workspace& w, const std::vector<Finding>& findings) {
  constexpr double kProbability = 0.93;
  constexpr std::size_t kFewestTimes = 3;
  const EffectKind* kind = EffectRegistry::instance().find("contact_loss");
  if (!w.has_rig || kind == nullptr || std::ranges::any_of(findings, [&](const Finding& f) { return f.effect == kind->name && f.claimed(); })) return std::nullopt;
  std::vector<std::string> names;
  Opened all, deepest;
  const RecordInput* shown = nullptr;
  for (const RecordInput& r : w.input.records) {
    const Opened one = opened(r, w.input.range_N);
    if (one.times == 0) continue;
    names.push_back(r.name);
    if (one.deepest_N > deepest.deepest_N) deepest = one, shown = &r;
    all.times += one.times;
    all.zero_N += one.zero_N;
    all.rows += one.rows;
    all.before_N2 += one.before_N2;
    all.after_N2 += one.after_N2;
  }
  if (all.times < kFewestTimes) return std::nullopt;
  const auto n = static_cast<double>(names.size());
  Finding out = finding_about(*kind, w.rig);
  out.form = "in_places";
  out.probability = kProbability;
  out.parameters.push_back({"zero_N", all.zero_N / n, std::sqrt(all.after_N2 / all.rows), "N"});
  out.error_before = std::sqrt(all.before_N2 / all.rows);
  out.error_after = std::sqrt(all.after_N2 / all.rows);
  out.effect_rms = std::sqrt(std::max(0.0, out.error_before * out.error_before - out.error_after * out.error_after));
  out.records_improved = out.records_excited = static_cast<int>(names.size());
  out.evidence = fmt::format("in {} the force comes to stand at its zero {} times between two loads, while what {} makes of it goes on to {:.2g} N below: the contact opens",
                             w.input.single ? std::string("the recording") : some_of(names), all.times,
                             w.input.has_theta || w.input.has_spindle ? "the angle" : "the command", deepest.deepest_N);
  for (const char* against : {"force by the law", "time"}) out.series.push_back(picture_of(*shown, deepest.zero_N, w.input.range_N, against));
  return out;
}

}  // namespace forcegate::diagnose
