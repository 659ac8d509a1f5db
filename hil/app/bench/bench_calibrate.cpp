#include "hil/app/bench/bench_calibrate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "hil/base/portable_math.h"
#include "hil/base/text.h"
#include "hil/gate/calibrate.h"
#include "hil/rig/bench_session.h"
#include "hil/rig/force_watch.h"
#include "hil/rig/slow_move.h"
#include "rigs/emulated/twins/client.h"

namespace forcegate {
namespace {

constexpr double kLook_s = 0.01;
constexpr double kSpeed_rad_per_s = 0.5;
constexpr double kUsableTravel = 0.95;
constexpr double kLow_rad = 0.1;

Result<void> go_on(const CalibrateRequest& q) {
  if (q.stop == nullptr || !q.stop->load()) return {};
  return fail(ErrorCode::cancelled, "interrupted", q.bench.string());
}

class Mean {
 public:
  void add(const std::vector<ReferenceReading>& seen) {
    for (const ReferenceReading& r : seen) {
      const auto force_N = static_cast<double>(r.force_N);
      ++n_;
      sum_ += force_N;
      squares_ += force_N * force_N;
    }
  }
  Result<CalibrationPoint> point(double x) const {
    if (n_ < 10) return fail(ErrorCode::timeout, "the reference gives too few readings", "reference", "check its cable");
    const auto n = static_cast<double>(n_);
    return CalibrationPoint{x, sum_ / n, std::sqrt(std::max(0.0, (squares_ - sum_ * sum_ / n) / (n - 1.0))), n_};
  }

 private:
  std::size_t n_ = 0;
  double sum_ = 0.0, squares_ = 0.0;
};

/// Lets a moment pass on a bench on which nothing moves; `seen`: the readings that have come meanwhile.
Result<void> look(BenchSession& s, const CalibrateRequest& q, std::vector<ReferenceReading>& seen) {
  FORCEGATE_CHECK_OK(go_on(q));
  FORCEGATE_CHECK_OK(s.world().advance_to(s.world().now_s() + kLook_s));
  seen.clear();
  return s.reference().poll(seen);
}

/// A load that has just been laid on may have knocked the reference: only what comes after it has settled counts, and there an invalid reading
/// ends it.
Result<CalibrationPoint> weigh(BenchSession& s, const CalibrateRequest& q, double force_N) {
  std::vector<ReferenceReading> seen;
  const double settled_s = s.world().now_s() + q.settle_s, until_s = settled_s + q.seconds;
  while (s.world().now_s() < settled_s) FORCEGATE_CHECK_OK(look(s, q, seen));
  Mean mean;
  while (s.world().now_s() < until_s) {
    FORCEGATE_CHECK_OK(look(s, q, seen));
    if (std::ranges::any_of(seen, [](const ReferenceReading& r) { return r.status != 0; }))
      return fail(ErrorCode::device, "the reference reports an overload or a fault", "reference", "take the load off and look at it");
    mean.add(seen);
  }
  return mean.point(force_N);
}

/// The spring's force where the armed wheel stands, under watch, after it has settled.
Result<CalibrationPoint> stand(BenchSession& s, const CalibrateRequest& q) {
  ForceWatch watch(s);
  Mean mean;
  MotorState state;
  const double settled_s = s.world().now_s() + q.settle_s, until_s = settled_s + q.seconds;
  while (s.world().now_s() < until_s) {
    FORCEGATE_CHECK_OK(go_on(q));
    const bool settled = s.world().now_s() >= settled_s;
    FORCEGATE_TRY(state, watch.look());
    if (settled) mean.add(watch.readings());
  }
  return mean.point(s.bench().geometry.eccentricity_mm * (1.0 - portable::cos(state.theta_rad)));
}

}  // namespace

Result<CalibrationLine> fit_calibration(std::vector<CalibrationPoint> points) {
  CalibrationLine line;
  const auto n = static_cast<double>(points.size());
  double sx = 0, sy = 0;
  for (const CalibrationPoint& p : points) sx += p.x, sy += p.y;
  double sxx = 0, sxy = 0;
  for (const CalibrationPoint& p : points) {
    sxx += (p.x - sx / n) * (p.x - sx / n);
    sxy += (p.x - sx / n) * (p.y - sy / n);
  }
  if (points.size() < 3 || !(sxx > 0.0))
    return fail(ErrorCode::usage, "a line needs three different points", {},
                "give more masses, or a longer travel");
  line.slope = sxy / sxx;
  line.intercept = sy / n - line.slope * sx / n;
  double squares = 0;
  for (const CalibrationPoint& p : points) {
    const double off = p.y - line.intercept - line.slope * p.x;
    squares += off * off;
    line.worst = std::max(line.worst, std::fabs(off));
  }
  line.residual = std::sqrt(squares / (n - 2.0));
  line.u_slope = line.residual / std::sqrt(sxx);
  line.u_intercept = line.residual * std::sqrt(1.0 / n + sx * sx / (n * n) / sxx);
  if (!(line.slope > 0.0) || line.residual > 0.2 * line.slope * std::sqrt(sxx / n))
    return fail(
        ErrorCode::device, "the readings do not follow the loads", "reference",
        "check axis and sign of the reference, and that the masses lie on it and nothing else touches it");
  line.points = std::move(points);
  return line;
}

Result<Calibrated> calibrate_reference(const CalibrateRequest& q, const Guide& guide) {
  FORCEGATE_TRY(BenchFile bench, read_bench(q.bench));
  if (!guide && !bench.twins)
    return fail(ErrorCode::usage, "somebody must lay the masses on", q.bench.string(),
                "leave out --yes: only twins load themselves");
  const double heaviest_N =
      *std::max_element(q.masses_g.begin(), q.masses_g.end()) * 1e-3 * q.gravity_m_per_s2;
  if (heaviest_N > bench.limits.force_max_N)
    return fail(ErrorCode::usage,
                fmt::format("the heaviest mass is {:.2f} N, the bench stands {:.2f} N", heaviest_N,
                            bench.limits.force_max_N),
                q.bench.string(), "leave it out");
  const bool twins = bench.twins;
  FORCEGATE_TRY(const auto s, BenchSession::make(std::move(bench), q.options));
  FORCEGATE_CHECK_OK(s->open());
  std::optional<emulated::TwinClient> hand;
  if (twins) {
    FORCEGATE_TRY(emulated::TwinClient connected,
                  emulated::TwinClient::connect(s->world().guard_option(), 5.0));
    hand.emplace(std::move(connected));
  }
  FORCEGATE_CHECK_OK(s->reference().start());
  std::vector<CalibrationPoint> points;
  for (const double mass_g : q.masses_g) {
    const double force_N = mass_g * 1e-3 * q.gravity_m_per_s2;
    if (guide)
      FORCEGATE_CHECK_OK(guide(mass_g > 0.0 ? fmt::format("lay {} g on the reference", shortest(mass_g))
                                            : "take everything off the reference"));
    if (hand) FORCEGATE_CHECK_OK(hand->say(fmt::format("load {:.17g}", force_N)));
    FORCEGATE_TRY(const CalibrationPoint point, weigh(*s, q, force_N));
    points.push_back(point);
  }
  if (hand) FORCEGATE_CHECK_OK(hand->say("load 0"));
  Calibrated out;
  out.what = "reference";
  FORCEGATE_TRY(out.line, fit_calibration(std::move(points)));
  const CalibrationLine& line = *out.line;
  out.u_rel = std::hypot(line.u_slope / line.slope, q.mass_u_rel);
  out.findings.push_back(fmt::format("the reference reads {} N for 1 N; {:.4f} N without a load",
                                     with_uncertainty(line.slope, line.slope * out.u_rel), line.intercept));
  out.findings.push_back(
      fmt::format("deviation from the line: {:.4f} N standard, {:.4f} N at most", line.residual, line.worst));
  if (const double counts = s->reference().facts().counts_per_force; counts > 0.0) {
    out.bench_lines.push_back(fmt::format("counts_per_force = {:.6g}      # in [reference]; was {:.6g}",
                                          counts * line.slope, counts));
  } else {
    out.findings.push_back(
        fmt::format("the scale of this sensor is its own: {:+.2f} % is for its maker to mend",
                    100.0 * (line.slope - 1.0)));
  }
  out.bench_lines.push_back(fmt::format("u_rel = {:.2g}      # in [reference]", out.u_rel));
  out.bench_lines.push_back(
      "reference = { id = \"...\", expires = \"...\" }      # in [calibration]: a new id, and when to do this again");
  return out;
}

double spring_top_rad(const RigGeometry& g, double force_max_N) {
  const double free_N = kUsableTravel * force_max_N - g.spring_N_per_mm * g.preload_mm;
  const double reach = std::clamp(free_N / (g.spring_N_per_mm * 2.0 * g.eccentricity_mm), 0.0, 1.0);
  return std::min(g.theta_max_rad, std::acos(1.0 - 2.0 * reach * kUsableTravel));
}

Result<Calibrated> calibrate_spring(const CalibrateRequest& q) {
  FORCEGATE_TRY(BenchFile bench, read_bench(q.bench));
  const RigGeometry g = bench.geometry;
  const double top_rad = spring_top_rad(g, bench.limits.force_max_N), low_rad = std::max(g.theta_min_rad, kLow_rad);
  if (!(top_rad > low_rad))
    return fail(ErrorCode::config,
                fmt::format("the force limit of {:.3g} N leaves no travel above the preload, which is {:.3g} N", bench.limits.force_max_N,
                            g.spring_N_per_mm * g.preload_mm),
                q.bench.string(), "mend force_max_N in [limits], or the preload on the wheel and in [geometry]");
  const double u_reference = bench.reference_u_rel;
  FORCEGATE_TRY(const auto s, BenchSession::make(std::move(bench), q.options));
  FORCEGATE_CHECK_OK(s->open());
  std::vector<CalibrationPoint> points;
  double gap_N = 0.0;
  for (std::size_t i = 0; i < 2 * q.steps; ++i) {
    const std::size_t step = i < q.steps ? i : 2 * q.steps - 1 - i;  // up, and the same angles down
    const double goal =
        low_rad + (top_rad - low_rad) * static_cast<double>(step) / static_cast<double>(q.steps - 1);
    FORCEGATE_CHECK_OK(move_slowly(*s, {goal, kSpeed_rad_per_s, 0.01, q.stop}));
    auto point = stand(*s, q);
    if (!point) return Unexpected(made_safe(*s, point.error()));
    points.push_back(*point);
  }
  FORCEGATE_CHECK_OK(move_slowly(*s, {low_rad, kSpeed_rad_per_s, 0.01, q.stop}));
  Calibrated out;
  out.what = "spring";
  FORCEGATE_TRY(out.line, fit_calibration(std::move(points)));
  const CalibrationLine& line = *out.line;
  for (std::size_t i = 0; i < q.steps; ++i) {
    const CalibrationPoint &up = line.points[i], &down = line.points[2 * q.steps - 1 - i];
    gap_N = std::max(gap_N, std::fabs(up.y - down.y - line.slope * (up.x - down.x)));
  }
  out.u_rel = std::hypot(line.u_slope / line.slope, u_reference);
  out.findings.push_back(fmt::format("the spring has {:.4f}({:.4f}) N/mm; the bench file says {:.4f}",
                                     line.slope, line.slope * out.u_rel, g.spring_N_per_mm));
  out.findings.push_back(fmt::format(
      "preload {:.3f} mm; deviation from the line {:.4f} N standard, {:.4f} N at most; up and down differ by {:.4f} N at most",
      line.intercept / line.slope, line.residual, line.worst, gap_N));
  out.bench_lines.push_back(fmt::format("spring_N_per_mm = {:.4f}      # in [geometry]", line.slope));
  out.bench_lines.push_back(
      fmt::format("preload_mm = {:.3f}      # in [geometry]", std::max(0.0, line.intercept / line.slope)));
  out.bench_lines.push_back(
      "spring = { id = \"...\", expires = \"...\" }      # in [calibration]: a new id, and when to do this again");
  return out;
}

Result<Calibrated> calibrate_sensor(const CalibrateRequest& q) {
  const RigKind* kind = Registry<RigKind>::instance().find("bench");
  if (kind == nullptr) return fail(ErrorCode::internal, "this build has no bench");
  auto options = q.options;
  options["file"] = q.bench.string();
  FORCEGATE_TRY(const auto rig, kind->make(options));
  CaseJob job;
  job.kind = CaseJob::Kind::calibration;
  job.id = "calibration/" + q.specimen;
  job.specimen = q.specimen;
  job.calibrate.level = CalibrationLevel::statical;
  job.safety.force_max_N = rig->info().force_max_N;
  const CaseRecord record = run_calibration(job, *rig, q.stop);
  rig->park();
  if (record.failure) return Unexpected(record.failure->error);
  const Calibration& c = record.calibration;
  Calibrated out;
  out.what = "sensor";
  out.u_rel = record.u_gain_rel;
  out.findings.push_back(record.calibration_text);
  out.bench_lines = {"# " + printable_utf8(q.specimen) + ": forcegate gate FIRMWARE --cal THIS",
                     "format = 1",
                     "id = \"" + c.id + "\"",
                     "level = \"static\"",
                     "gain_N_per_V = " + shortest(c.gain_N_per_V),
                     "offset_N = " + shortest(c.offset_N),
                     fmt::format("adc_bits = {}", c.adc_bits),
                     "v_range_V = " + shortest(c.v_range_V)};
  return out;
}

}  // namespace forcegate
