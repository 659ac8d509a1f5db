#include "hil/app/export/compensator_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <tuple>

#include "hil/app/export/built_header.h"
#include "hil/app/export/recorded_output.h"
#include "hil/base/evenly_chosen.h"
#include "hil/base/text.h"
#include "hil/model/rows.h"

namespace forcegate {
namespace {

constexpr double kFloorMemory_s = 120.0;
constexpr double kTrackerStep_s = 0.1;

std::vector<double> resample(const RecordInput& r, const std::vector<double>& x, double rate_Hz,
                             std::size_t n) {
  std::vector<double> out;
  if (x.empty()) return out;
  out.resize(n);
  std::size_t j = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / rate_Hz;
    while (j + 2 < r.rows() && r.t_s[j + 1] <= t) ++j;
    const double share = std::clamp((t - r.t_s[j]) / (r.t_s[j + 1] - r.t_s[j]), 0.0, 1.0);
    out[i] = x[j] + share * (x[j + 1] - x[j]);
  }
  return out;
}

// 1 where both rows around an instant hold samples and no gap lies between them; what bridges a gap is an input, no measurement.
std::vector<std::uint8_t> judged_instants(const RecordInput& r, double rate_Hz, std::size_t n) {
  constexpr double kGap = 4.0;  // rows
  std::vector<std::uint8_t> out(n, 0);
  std::size_t j = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / rate_Hz;
    while (j + 2 < r.rows() && r.t_s[j + 1] <= t) ++j;
    out[i] = r.ok[j] != 0 && r.ok[j + 1] != 0 && r.t_s[j + 1] - r.t_s[j] <= kGap * r.row_step_s ? 1 : 0;
  }
  return out;
}

// The recorded force at these instants.
std::vector<double> force_at(const RecordInput& r, const std::vector<double>& t_s) {
  std::vector<double> out;
  out.reserve(t_s.size());
  std::size_t j = 0;
  for (const double t : t_s) {
    while (j + 2 < r.fast_t_s.size() && r.fast_t_s[j + 1] <= t) ++j;
    const double share = std::clamp((t - r.fast_t_s[j]) / (r.fast_t_s[j + 1] - r.fast_t_s[j]), 0.0, 1.0);
    out.push_back(r.fast_F_N[j] + share * (r.fast_F_N[j + 1] - r.fast_F_N[j]));
  }
  return out;
}

struct AtRate {
  RecordInput rows;
  std::vector<double> read_N;  ///< force when each output was read: a mean over rows stands between the samples
};

// The record at the rate of the compensator, on the samples where that is theirs: rows and full rate are the same, and its output is what the samples say.
AtRate at_rate(const Campaign& campaign, const RecordInput& r, double rate_Hz, double most_s) {
  RecordInput out = r;
  const double seconds = std::min(most_s, r.t_s.back() - r.t_s.front());
  const auto n = static_cast<std::size_t>(seconds * rate_Hz);
  out.row_step_s = 1.0 / rate_Hz;
  out.F_N = resample(r, r.F_N, rate_Hz, n);
  out.temp_C = resample(r, r.temp_C, rate_Hz, n);
  out.humidity = resample(r, r.humidity, rate_Hz, n);
  out.theta_rad = resample(r, r.theta_rad, rate_Hz, n);
  out.drive_V = resample(r, r.drive_V, rate_Hz, n);
  out.travel_N = resample(r, r.travel_N, rate_Hz, n);
  out.C_F.clear();
  out.F_cmd_N.clear();
  out.rig_force_N.clear();
  out.ok = judged_instants(r, rate_Hz, n);
  out.t_s.resize(n);
  out.rate_N_per_s.assign(n, 0.0);
  out.row_begin.resize(n + 1);
  for (std::size_t i = 0; i < n; ++i) {
    out.t_s[i] = static_cast<double>(i) / rate_Hz;
    out.row_begin[i] = static_cast<std::uint32_t>(i);
    if (i == 1) out.rate_N_per_s[i] = rate_Hz * (out.F_N[i] - out.F_N[i - 1]);
    if (i > 1) out.rate_N_per_s[i] = rate_Hz * (1.5 * out.F_N[i] - 2.0 * out.F_N[i - 1] + 0.5 * out.F_N[i - 2]);
  }
  out.row_begin[n] = static_cast<std::uint32_t>(n);
  std::vector<double> read_s;
  out.U_V = recorded_output(campaign, r, out.t_s, &read_s);
  std::vector<double> read_N = out.U_V.empty() ? out.F_N : force_at(r, read_s);
  if (out.U_V.empty()) out.U_V = resample(r, r.U_V, rate_Hz, n);
  out.fast_t_s = out.t_s;
  out.fast_F_N = out.F_N;
  return {std::move(out), std::move(read_N)};
}

// Lowest u of the last two minutes of cycling, as the reference firmware tracks U_min.
std::vector<float> tracked_floor(const RecordInput& r, const std::vector<float>& u, double rate_Hz) {
  std::vector<float> out(u.size());
  std::deque<std::pair<std::size_t, float>> least;
  const auto memory = static_cast<std::size_t>(kFloorMemory_s * rate_Hz),
             step = static_cast<std::size_t>(std::max(1.0, kTrackerStep_s * rate_Hz));
  float bucket = 0.0f;
  for (std::size_t i = 0; i < u.size(); ++i) {
    const bool cycling = r.dynamic && r.t_s[i] >= r.onset_s;
    bucket = i % step == 0 ? u[i] : std::min(bucket, u[i]);
    if (cycling && i % step == step - 1) {
      while (!least.empty() && least.back().second >= bucket) least.pop_back();
      least.emplace_back(i, bucket);
      while (least.front().first + memory < i) least.pop_front();
    }
    out[i] = least.empty() ? u[i] : std::min(u[i], least.front().second);
  }
  return out;
}

// Sums for the best straight line from x to F.
struct Line {
  double n = 0, x = 0, F = 0, xx = 0, xF = 0;
  void add(double xi, double Fi, double weight) {
    n += weight, x += weight * xi, F += weight * Fi, xx += weight * xi * xi, xF += weight * xi * Fi;
  }
  std::pair<double, double> fit() const {
    const double v = xx / n - x * x / (n * n), slope = v > 0.0 ? (xF / n - x * F / (n * n)) / v : 1.0;
    return {slope, F / n - slope * x / n};
  }
};

struct Thinned {
  std::vector<float> F, plain, compensated, shrink;
  // As a law is fitted, and calibrated on slow sweeps: by the output, records weighing the same. Counted in newtons, what a decayed record is off
  // would bend the line of all of them.
  void add_to(Line& line, const std::vector<float>& x) const {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const auto D = static_cast<double>(shrink[i]);
      line.add(static_cast<double>(x[i]), static_cast<double>(F[i]), D * D / static_cast<double>(x.size()));
    }
  }
};

// Of the converter, in the output's unit.
struct Step {
  double size = 0.0;
  std::string assumed;
};

Step step_of(const BenchFacts& bench, const std::string& unit) {
  constexpr int kBits = 16;
  constexpr double kRange_V = 10.0;
  if (unit == "counts") return {1.0, ""};
  if (unit != "V") return {};
  const bool has_bits = bench.adc_bits > 0, has_range = std::isfinite(bench.voltage_max_V);
  const double low_V = has_range && std::isfinite(bench.voltage_min_V) ? bench.voltage_min_V : 0.0, range_V = has_range ? bench.voltage_max_V - low_V : kRange_V;
  const int bits = has_bits ? bench.adc_bits : kBits;
  Step out{range_V / (std::ldexp(1.0, bits) - 1.0), ""};
  if (!has_bits || !has_range)
    out.assumed = fmt::format("an LSB is here that of {} bits over {} V; the campaign does not say {}: write {} into \"bench\" of campaign.json", bits, shortest(range_V),
                              has_range  ? "how many bits the converter has"
                              : has_bits ? "what range the converter has"
                                         : "what converter it is",
                              has_range  ? "adc_bits"
                              : has_bits ? "voltage_range_V"
                                         : "adc_bits and voltage_range_V");
  return out;
}

double rms_about(std::pair<double, double> line, const std::vector<float>& x, const std::vector<float>& F) {
  double sum = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    sum += std::pow(line.first * static_cast<double>(x[i]) + line.second - static_cast<double>(F[i]), 2);
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, x.size())));
}

// What a record is played with, and against what its answers are held.
struct Replay {
  const Model& model;
  const Compensator& compensator;
  const BuiltHeader& built;
  const Campaign& campaign;
  const CampaignInFrame& in_frame;
  double rate_Hz, most_s;
};

struct Replayed {
  ReplayedRecord item;
  Thinned at;  ///< instants that were measured
};

Result<Replayed> replayed(const Replay& with, const RecordInput& rows) {
  if (with.compensator.needs_temperature && rows.temp_C.empty()) {
    const auto of = std::ranges::find(with.campaign.records, rows.name, &Record::name);
    return fail(ErrorCode::config, "the model needs a temperature (" + join(with.compensator.effects, "; ") + "), and this record has none",
                of != with.campaign.records.end() ? of->place() : rows.name,
                "replay the header on records with a column temp_C; without --check it is written all the same");
  }
  const double rate_Hz = with.rate_Hz, G = with.model.law.gain_N_per_V, F0 = with.model.law.offset_N;
  auto [r, read_N] = at_rate(with.campaign, rows, rate_Hz, with.most_s);
  set_decay(r, with.model.law);
  r.recording = with.in_frame.input().records.front().recording;  // no history: the firmware is switched on where the record begins
  FORCEGATE_TRY(const std::vector<double> U, model_output_V(with.model, with.in_frame, r));
  const std::size_t n = r.rows();
  std::vector<float> u(n), shrink(n), low(n, static_cast<float>(r.F_min_N)), T(n, 0.0f), recorded(n);
  for (std::size_t i = 0; i < n; ++i) {
    u[i] = static_cast<float>(G * U[i] + F0);
    recorded[i] = static_cast<float>(G * r.U_V[i] + F0);
    shrink[i] = static_cast<float>(r.decay[i]);
    if (!r.temp_C.empty()) T[i] = static_cast<float>(r.temp_C[i]);
  }
  Replayed out;
  ReplayedRecord& item = out.item;
  item.record = r.name;
  const auto judged = static_cast<std::size_t>(std::count(r.ok.begin(), r.ok.end(), std::uint8_t{1}));
  item.seconds = static_cast<double>(judged) / rate_Hz;
  item.left_out_s = static_cast<double>(n - judged) / rate_Hz;
  item.cut_s = std::max(0.0, rows.t_s.back() - rows.t_s.front() - with.most_s);
  const std::vector<float> inverse = with.built.run(u, shrink, low, true, T);
  for (std::size_t i = 0; i < n; ++i)
    if (const double apart = std::fabs(static_cast<double>(inverse[i]) - r.F_N[i]); r.ok[i] != 0 && !std::isnan(item.largest_N) && !(apart <= item.largest_N))
      item.largest_N = apart, item.largest_at_N = r.F_N[i];
  if (!std::isfinite(item.largest_N))
    return fail(ErrorCode::config, "the compensator gives no number", r.name);

  const std::vector<float> floor = tracked_floor(r, recorded, rate_Hz);
  const std::vector<float> found = with.built.run(recorded, shrink, floor, false, T);
  constexpr std::size_t kMostKept = 50'000;
  const auto settled = static_cast<std::size_t>(std::max(1.0, 0.05 * rate_Hz));
  EvenlyChosen choice(n, kMostKept);
  for (std::size_t i = settled; i < n; ++i) {
    if (!choice.next() || r.ok[i] == 0) continue;
    const double above = static_cast<double>(recorded[i] - floor[i]);
    out.at.F.push_back(static_cast<float>(read_N[i]));
    out.at.plain.push_back(above > 0.0 ? static_cast<float>(static_cast<double>(floor[i]) + above / static_cast<double>(shrink[i])) : recorded[i]);
    out.at.compensated.push_back(found[i]);
    out.at.shrink.push_back(shrink[i]);
  }
  return out;
}

// About the line of all records, as it stands, and about the record's own line.
void take_errors(const Thinned& at, const Line& plain_line, const Line& compensated_line, ReplayedRecord& item) {
  item.plain_rms_N = rms_about(plain_line.fit(), at.plain, at.F);
  item.compensated_rms_N = rms_about(compensated_line.fit(), at.compensated, at.F);
  item.raw_plain_rms_N = rms_about({1.0, 0.0}, at.plain, at.F);
  item.raw_compensated_rms_N = rms_about({1.0, 0.0}, at.compensated, at.F);
  Line own_plain, own_compensated;
  at.add_to(own_plain, at.plain);
  at.add_to(own_compensated, at.compensated);
  item.own_plain_rms_N = rms_about(own_plain.fit(), at.plain, at.F);
  item.own_compensated_rms_N = rms_about(own_compensated.fit(), at.compensated, at.F);
}

// Over all records, each weighing the same.
double rms_of(const std::vector<ReplayedRecord>& records, double ReplayedRecord::*error) {
  double sum = 0.0;
  for (const ReplayedRecord& r : records) sum += r.*error * r.*error / static_cast<double>(records.size());
  return std::sqrt(sum);
}

}  // namespace

Result<CompensatorCheck> check_compensator(const Model& model, const Compensator& compensator, double rate_Hz,
                                           const Campaign& campaign, double most_s) {
  FORCEGATE_TRY(const std::unique_ptr<BuiltHeader> built, BuiltHeader::build(compensator.header));
  FORCEGATE_TRY(CampaignInput own, make_campaign_input(campaign));
  const CampaignInFrame in_frame(model.frame, std::move(own));
  CompensatorCheck out;
  out.compiler = "cc -std=c11 -O2 -ffp-contract=off";
  const Step step = step_of(campaign.bench, model.output_unit);
  out.lsb_N = std::fabs(model.law.gain_N_per_V) * step.size;
  out.assumed = step.assumed;
  std::vector<Thinned> kept;
  Line plain_line, compensated_line;
  for (const RecordInput& rows : in_frame.input().records) {
    if (rows.rows() < 16) continue;
    FORCEGATE_TRY(Replayed one, replayed({model, compensator, *built, campaign, in_frame, rate_Hz, most_s}, rows));
    if (one.at.F.empty()) continue;  // no instant of it was measured
    one.at.add_to(plain_line, one.at.plain);
    one.at.add_to(compensated_line, one.at.compensated);
    kept.push_back(std::move(one.at));
    out.largest_N = std::max(out.largest_N, one.item.largest_N);
    out.records.push_back(std::move(one.item));
  }
  if (kept.empty()) return fail(ErrorCode::config, "the campaign has no record to replay", campaign.name);
  double low_N = 1e300, high_N = -1e300;
  for (std::size_t k = 0; k < kept.size(); ++k) {
    take_errors(kept[k], plain_line, compensated_line, out.records[k]);
    const auto [least, most] = std::ranges::minmax(kept[k].F);
    low_N = std::min(low_N, static_cast<double>(least)), high_N = std::max(high_N, static_cast<double>(most));
  }
  out.span_N = high_N - low_N;
  std::tie(out.line_gain, out.line_zero_N) = compensated_line.fit();
  out.plain_rms_N = rms_of(out.records, &ReplayedRecord::plain_rms_N);
  out.compensated_rms_N = rms_of(out.records, &ReplayedRecord::compensated_rms_N);
  out.raw_plain_rms_N = rms_of(out.records, &ReplayedRecord::raw_plain_rms_N);
  out.raw_compensated_rms_N = rms_of(out.records, &ReplayedRecord::raw_compensated_rms_N);
  return out;
}

}  // namespace forcegate
