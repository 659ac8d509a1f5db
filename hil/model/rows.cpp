#include "hil/model/rows.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hil/base/largest_first.h"
#include "hil/model/states.h"

namespace forcegate {

namespace {

// The channel itself where it has that clock already; else `room`, filled along straight lines.
const std::vector<double>& on_clock(const Trace& trace, const Channel& channel, std::size_t clock,
                                    std::vector<double>& room) {
  if (channel.time_base == clock) return channel.value;
  const auto& from = trace.time_bases[channel.time_base].t_s;
  const auto& to = trace.time_bases[clock].t_s;
  std::vector<double>& out = room;
  out.assign(to.size(), kMissing);
  if (from.size() < 2) return out;
  std::size_t j = 0;
  for (std::size_t i = 0; i < to.size(); ++i) {
    while (j + 2 < from.size() && from[j + 1] <= to[i]) ++j;
    if (to[i] < from[j] || to[i] > from[j + 1]) continue;
    const double share = (to[i] - from[j]) / (from[j + 1] - from[j]);
    out[i] = channel.value[j] + share * (channel.value[j + 1] - channel.value[j]);
  }
  return out;
}

double median_step(const std::vector<double>& t) {
  std::vector<double> steps;
  const std::size_t stride = std::max<std::size_t>(1, t.size() / 5000);
  for (std::size_t i = 1; i < t.size(); i += stride) steps.push_back(t[i] - t[i - 1]);
  return steps.empty() ? 1.0 : quantile(std::move(steps), 0.5);
}

double first_finite(const std::vector<double>& x) {
  const auto found = std::ranges::find_if(x, [](double v) { return std::isfinite(v); });
  return found == x.end() ? 0.0 : *found;
}

// Missing forces are held, so that the states of plays and filters stay finite.
void hold(std::vector<double>& x, double last) {
  for (double& v : x) {
    if (std::isfinite(v)) last = v;
    v = last;
  }
}

struct RowMeans {
  const RecordInput& record;
  std::vector<double> operator()(const std::vector<double>& x) const {
    std::vector<double> out(record.rows());
    for (std::size_t r = 0; r < record.rows(); ++r) {
      double sum = 0.0, n = 0.0;
      for (std::uint32_t k = record.row_begin[r]; k < record.row_begin[r + 1]; ++k)
        if (std::isfinite(x[k])) {
          sum += x[k];
          n += 1.0;
        }
      out[r] = n > 0.0 ? sum / n : kMissing;
    }
    return out;
  }
};

void set_angle(const std::vector<double>& theta, const std::vector<double>& t, RecordInput& out) {
  double angle = first_finite(theta), before = std::cos(angle), late = before;
  LowPass pole(kLateAngle_s, before);
  out.sin_theta.reserve(out.rows());
  out.cos_theta.reserve(out.rows());
  out.late_cos_theta.reserve(out.rows());
  for (std::size_t r = 0; r < out.rows(); ++r) {
    double sum_sin = 0.0, sum_cos = 0.0, sum_late = 0.0;
    const std::uint32_t begin = out.row_begin[r], end = out.row_begin[r + 1];
    for (std::uint32_t k = begin; k < end; ++k) {
      if (std::isfinite(theta[k])) angle = theta[k];
      const double cosine = std::cos(angle);
      if (k > 0) late = pole.step(before, cosine, (t[k] - t[0]) - (t[k - 1] - t[0]));
      before = cosine;
      sum_sin += std::sin(angle);
      sum_cos += cosine;
      sum_late += late;
    }
    const double n = static_cast<double>(end - begin);
    out.sin_theta.push_back(sum_sin / n);
    out.cos_theta.push_back(sum_cos / n);
    out.late_cos_theta.push_back(sum_late / n);
  }
}

// The force is held over what is missing at its end too.
void set_full_rate(std::vector<double> t, std::vector<double> F, RecordInput& out) {
  const std::size_t used = out.row_begin.back();
  hold(F, first_finite(F));
  F.resize(used);
  t.resize(used);
  for (const double t0 = t.front(); double& v : t) v -= t0;
  out.fast_t_s = std::move(t);
  out.fast_F_N = std::move(F);
}

}  // namespace

double quantile(std::vector<double> values, double q) { return quantiles(std::move(values), q, q).front(); }

std::array<double, 2> quantiles(std::vector<double> values, double low_q, double high_q) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return {kMissing, kMissing};
  const auto place = [&](double q) {
    return values.begin() + static_cast<std::ptrdiff_t>(q * static_cast<double>(values.size() - 1) + 0.5);
  };
  const auto low = place(low_q), high = place(high_q);
  std::nth_element(values.begin(), low, values.end());
  if (high > low) std::nth_element(low + 1, high, values.end());
  return {*low, *high};
}

namespace {

Result<RecordInput> make_rows(const Record& record, std::span<const std::uint8_t> bad, double row_step_s,
                              bool angle) {
  const Trace& trace = record.trace;
  const Channel* F = trace.find("F_ref");
  const Channel* U = trace.find("U");
  if (F == nullptr || U == nullptr)
    return fail(ErrorCode::parse, std::string("the record has no channel ") + (F == nullptr ? "F_ref" : "U"),
                record.name, "name the columns F_ref_N and U_V, or map yours with --map OTHER=F_ref_N");
  const std::size_t clock = F->time_base;
  const auto& t = trace.time_bases[clock].t_s;
  if (t.size() < 16)
    return fail(ErrorCode::parse, "the record has only " + std::to_string(t.size()) + " samples", record.name,
                "at least 16 samples are needed");

  RecordInput out;
  out.name = record.name;
  out.kind = record.kind;
  out.heldout = record.role == RecordRole::heldout;
  const double step = median_step(t);
  const auto per_row = static_cast<std::uint32_t>(std::max(1.0, std::round(row_step_s / step)));
  out.row_step_s = step * per_row;
  const auto n_rows = static_cast<std::uint32_t>(t.size() / per_row);
  for (std::uint32_t r = 0; r <= n_rows; ++r) out.row_begin.push_back(r * per_row);

  const std::vector<double>& force = F->value;
  std::vector<double> room;
  const std::vector<double>& output = on_clock(trace, *U, clock, room);
  const double t0 = t.front();

  out.t_s.resize(n_rows);
  out.U_V.resize(n_rows);
  out.F_N.resize(n_rows);
  out.ok.assign(n_rows, 1);
  double last_F = first_finite(force);
  for (std::uint32_t r = 0; r < n_rows; ++r) {
    double sum_t = 0.0, sum_F = 0.0, sum_U = 0.0;
    const std::uint32_t begin = out.row_begin[r], end = out.row_begin[r + 1];
    for (std::uint32_t k = begin; k < end; ++k) {
      if (std::isfinite(force[k]))
        last_F = force[k];
      else
        out.ok[r] = 0;
      sum_t += t[k] - t0;
      sum_F += last_F;
      sum_U += output[k];
      if ((!bad.empty() && bad[k] != 0) || !std::isfinite(output[k])) out.ok[r] = 0;
    }
    const double n = per_row;
    out.t_s[r] = sum_t / n;
    out.F_N[r] = sum_F / n;
    out.U_V[r] = sum_U / n;
    if ((t[end - 1] - t0) - (t[begin] - t0) > 1.6 * out.row_step_s) out.ok[r] = 0;
    if (!std::isfinite(out.U_V[r])) out.U_V[r] = 0.0;
  }
  // a row next to a hole in the clock carries states of unknown age
  for (std::uint32_t r = 1; r < n_rows; ++r)
    if (out.t_s[r] - out.t_s[r - 1] > 4.0 * out.row_step_s) out.ok[r] = 0;

  const RowMeans mean{out};
  const auto channel = [&](const char* name) -> std::vector<double> {
    const Channel* c = trace.find(name);
    if (c == nullptr) return {};
    std::vector<double> rows = mean(on_clock(trace, *c, clock, room));
    if (std::none_of(rows.begin(), rows.end(), [](double v) { return std::isfinite(v); })) return {};
    hold(rows, first_finite(rows));
    return rows;
  };
  out.theta_rad = channel("theta");
  if (angle && !out.theta_rad.empty()) set_angle(on_clock(trace, *trace.find("theta"), clock, room), t, out);
  out.temp_C = channel("temp");
  out.humidity = channel("RH");
  if (out.humidity.empty()) out.humidity = channel("humidity");
  out.C_F = channel("C");
  out.F_cmd_N = channel("F_cmd");
  out.drive_V = channel("drive");

  out.rate_N_per_s.assign(n_rows, 0.0);
  for (std::uint32_t r = 1; r + 1 < n_rows; ++r)
    out.rate_N_per_s[r] = (out.F_N[r + 1] - out.F_N[r - 1]) / (out.t_s[r + 1] - out.t_s[r - 1]);

  out.duration_s = t.back() - t0;
  out.start_s = record.start_s.value_or(kMissing);
  out.rest_before_s = record.rest_before_s.value_or(kMissing);
  out.drive_mean_V = record.drive_V.value_or(out.drive_V.empty() ? kMissing : quantile(out.drive_V, 0.5));
  out.mounting_name = record.mounting;
  out.eccentricity_mm = record.eccentricity_mm.value_or(kMissing);
  out.preload_mm = record.preload_mm.value_or(kMissing);
  out.decay.assign(n_rows, 1.0);
  return out;
}

}  // namespace

Result<RecordInput> make_record_input(const Record& record, std::span<const std::uint8_t> bad,
                                      double row_step_s, const RowParts& parts) {
  FORCEGATE_TRY(RecordInput out, make_rows(record, bad, row_step_s, parts.angle));
  const Channel& F = *record.trace.find("F_ref");
  if (parts.full_rate) set_full_rate(record.trace.time_bases[F.time_base].t_s, F.value, out);
  return out;
}

Result<RecordInput> take_record_input(Record& record, std::span<const std::uint8_t> bad, double row_step_s,
                                      const RowParts& parts) {
  FORCEGATE_TRY(RecordInput out, make_rows(record, bad, row_step_s, parts.angle));
  Channel& F = *record.trace.find("F_ref");
  if (parts.full_rate)
    set_full_rate(std::move(record.trace.time_bases[F.time_base].t_s), std::move(F.value), out);
  return out;
}

namespace {

// A record that does not say belongs to the mounting of its neighbours where they agree, or where there is only one.
void number_mountings(CampaignInput& campaign) {
  auto& records = campaign.records;
  std::vector<std::string> names;
  for (const RecordInput& r : records) names.push_back(r.mounting_name);
  for (std::size_t k = 0; k < names.size(); ++k) {
    if (!names[k].empty()) continue;
    std::size_t next = k;
    while (next < names.size() && records[next].mounting_name.empty()) ++next;
    const std::string after = next < names.size() ? records[next].mounting_name : std::string(), before = k > 0 ? names[k - 1] : std::string();
    if (!after.empty() && !before.empty() && after != before) return;
    names[k] = before.empty() ? after : before;
    if (names[k].empty()) return;
  }
  std::vector<std::string> distinct;
  for (std::size_t k = 0; k < names.size(); ++k) {
    auto found = std::find(distinct.begin(), distinct.end(), names[k]);
    if (found == distinct.end()) found = distinct.insert(distinct.end(), names[k]);
    records[k].mounting = static_cast<int>(found - distinct.begin());
  }
  campaign.mountings = static_cast<int>(distinct.size());
}

}  // namespace

void finish_campaign_input(CampaignInput& campaign, unsigned threads) {
  auto& records = campaign.records;
  bool starts_known = true;
  for (const RecordInput& r : records) starts_known &= std::isfinite(r.start_s);
  if (starts_known) {
    std::stable_sort(records.begin(), records.end(),
                     [](const RecordInput& a, const RecordInput& b) { return a.start_s < b.start_s; });
  } else {
    double clock_s = 0.0;
    bool rests_known = true;
    for (RecordInput& r : records) {
      rests_known &= std::isfinite(r.rest_before_s);
      if (std::isfinite(r.start_s) && r.start_s >= clock_s)
        clock_s = r.start_s;
      else
        clock_s += std::isfinite(r.rest_before_s) ? r.rest_before_s : (clock_s > 0.0 ? 600.0 : 0.0);
      r.start_s = clock_s;
      clock_s += r.duration_s;
    }
    if (!rests_known && records.size() > 1)
      campaign.notes.push_back(
          "start times are not declared: records are taken in order with 10 min of rest between");
  }

  std::vector<double> F, U;
  for (const RecordInput& r : records) {
    const std::size_t stride = std::max<std::size_t>(1, r.rows() / 4000);
    for (std::size_t i = 0; i < r.rows(); i += stride)
      if (r.ok[i] != 0) {
        F.push_back(r.F_N[i]);
        U.push_back(r.U_V[i]);
      }
  }
  if (!F.empty()) {
    const auto [low_N, high_N] = quantiles(std::move(F), 0.001, 0.999);
    const auto [low_V, high_V] = quantiles(std::move(U), 0.001, 0.999);
    campaign.lowest_N = low_N;
    campaign.range_N = std::max(1e-12, high_N - low_N);
    campaign.U_range_V = std::max(1e-12, high_V - low_V);
  }

  // Where the force stands still its reading is resolution and noise only: as a regressor it would pull gains to zero.
  parallel_for(records.size(), threads, [&](std::size_t k) {
    RecordInput& r = records[k];
    const auto [low_N, high_N] = quantiles(r.F_N, 0.005, 0.995);
    if (!(high_N - low_N < 0.02 * campaign.range_N)) return;
    const double middle =
        std::accumulate(r.F_N.begin(), r.F_N.end(), 0.0) / static_cast<double>(r.F_N.size());
    std::fill(r.F_N.begin(), r.F_N.end(), middle);
    std::fill(r.fast_F_N.begin(), r.fast_F_N.end(), middle);
    std::fill(r.rate_N_per_s.begin(), r.rate_N_per_s.end(), 0.0);
  });

  double travel = 0.0;
  const auto every = [&](auto member) {
    return !records.empty() && std::all_of(records.begin(), records.end(),
                                           [&](const RecordInput& r) { return !(r.*member).empty(); });
  };
  const auto some = [&](auto member) {
    return std::any_of(records.begin(), records.end(),
                       [&](const RecordInput& r) { return !(r.*member).empty(); });
  };
  campaign.has_theta = some(&RecordInput::theta_rad);
  campaign.has_temp = every(&RecordInput::temp_C);
  campaign.has_humidity = every(&RecordInput::humidity);
  campaign.has_command = some(&RecordInput::F_cmd_N);
  campaign.has_capacitance = some(&RecordInput::C_F);
  double drive_low = 1e300, drive_high = -1e300;
  bool drive_known = !records.empty();
  for (std::size_t k = 0; k < records.size(); ++k) {
    RecordInput& r = records[k];
    r.index = r.recording = k;
    drive_known &= std::isfinite(r.drive_mean_V);
    drive_low = std::min(drive_low, r.drive_mean_V);
    drive_high = std::max(drive_high, r.drive_mean_V);
    if (!std::isfinite(r.rest_before_s))
      r.rest_before_s =
          k == 0 ? 1e5 : std::max(0.0, r.start_s - records[k - 1].start_s - records[k - 1].duration_s);
    r.travel_before_N = travel;
    r.travel_N.assign(r.rows(), 0.0);
    // travel of the force behind a play of 2 % of the span: noise does not wear anything
    double state = r.F_N.empty() ? 0.0 : r.F_N[0], sum = 0.0;
    const double radius = 0.02 * campaign.range_N;
    for (std::size_t i = 0; i < r.rows(); ++i) {
      const double next = std::clamp(state, r.F_N[i] - radius, r.F_N[i] + radius);
      sum += std::abs(next - state);
      state = next;
      r.travel_N[i] = sum;
    }
    travel += sum;
  }
  number_mountings(campaign);
  campaign.has_drive = drive_known && drive_high - drive_low > 0.02 * std::abs(drive_high);
  campaign.travel_total_N = std::max(travel, 1e-9);
}

std::vector<std::size_t> sample_counts(const Campaign& campaign) {
  std::vector<std::size_t> out;
  for (const Record& record : campaign.records) out.push_back(record.trace.size());
  return out;
}

Result<CampaignInput> make_campaign_input(const Campaign& campaign, unsigned threads, const RowParts& parts) {
  CampaignInput out;
  out.name = campaign.name;
  out.bench = campaign.bench;
  std::vector<Result<RecordInput>> made(campaign.records.size());
  parallel_for_largest_first(sample_counts(campaign), threads, [&](std::size_t k) {
    made[k] = make_record_input(campaign.records[k], {}, kRowStep_s, parts);
  });
  for (Result<RecordInput>& one : made) {
    FORCEGATE_TRY(RecordInput input, std::move(one));
    out.records.push_back(std::move(input));
  }
  finish_campaign_input(out, threads);
  parallel_for(out.records.size(), threads, [&](std::size_t k) {
    RecordInput& input = out.records[k];
    const Record* found = nullptr;
    for (const Record& record : campaign.records)
      if (record.name == input.name) found = &record;
    estimate_excitation(input, found, out.range_N);
    if (input.dynamic && input.dynamic_assumed && stands_mostly_still(input, out.range_N)) set_static(input);
  });
  return out;
}

}  // namespace forcegate
