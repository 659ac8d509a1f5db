// What records are to each other: their order, mountings, the force done before each, the range of all.

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hil/base/evenly_chosen.h"
#include "hil/base/largest_first.h"
#include "hil/base/quantile.h"
#include "hil/base/some_of.h"
#include "hil/model/missing_facts.h"
#include "hil/model/row_step.h"
#include "hil/model/rows.h"
#include "hil/model/spindle.h"
#include "hil/model/travel.h"
#include "hil/trace/static_line.h"

namespace forcegate {

namespace {

struct Extremes {
  double low = 1e300, high = -1e300;
  double span() const { return std::max(0.0, high - low); }
};

// Lowest and highest mean of usable rows that follow each other: what lasts, however short beside the record, and no single spike.
Extremes lasting(const RecordInput& r, const std::vector<double>& x) {
  constexpr std::size_t kRows = 4;
  Extremes out;
  std::vector<double> last;  // usable ones
  double sum = 0.0;
  for (std::size_t i = 0; i < r.rows(); ++i) {
    if (r.ok[i] == 0) continue;
    last.push_back(x[i]);
    sum += x[i];
    if (last.size() > kRows) sum -= last[last.size() - 1 - kRows];
    if (last.size() < kRows) continue;
    out.low = std::min(out.low, sum / kRows);
    out.high = std::max(out.high, sum / kRows);
  }
  return out;
}

// Whether most of what the means of force and output over windows vary by is common to them, which noise of either is not.
bool output_follows(const RecordInput& r) {
  constexpr std::size_t kWindows = 24;
  constexpr double kCommon = 0.5;
  if (r.U_V.size() != r.rows()) return false;
  const auto usable = static_cast<std::size_t>(std::ranges::count_if(r.ok, [](std::uint8_t ok) { return ok != 0; }));
  PairMeans means(std::max<std::size_t>(1, usable / kWindows));
  StaticLine line;
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (r.ok[i] != 0 && means.push(r.U_V[i], r.F_N[i])) line.push(means.sensor_V(), means.force_N());
  return line.n() >= kWindows && line.covariance_VN() > 0.0 &&
         line.covariance_VN() * line.covariance_VN() > kCommon * line.variance_V2() * line.variance_N2();
}

// Its reading is resolution and noise only.
bool stands_still(const RecordInput& r, double range_N) {
  constexpr double kNoise = 0.02, kLasting = 0.1;  // of the range
  const auto [low_N, high_N] = quantiles(r.F_N, 0.005, 0.995);
  return high_N - low_N < kNoise * range_N && lasting(r, r.F_N).span() < kLasting * range_N && !output_follows(r);
}

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

void sort_by_start(std::vector<RecordInput>& records) {
  std::stable_sort(records.begin(), records.end(), [](const RecordInput& a, const RecordInput& b) { return a.start_s < b.start_s; });
}

// A logger's clock goes on from file to file: where none begins before another has ended, it is the campaign's. Clocks that begin anew
// in every file overlap.
bool take_clocks_as_starts(CampaignInput& campaign) {
  auto& records = campaign.records;
  if (records.size() < 2 || std::ranges::any_of(records, [](const RecordInput& r) { return std::isfinite(r.start_s); })) return false;
  std::vector<const RecordInput*> order;
  for (const RecordInput& r : records) order.push_back(&r);
  std::ranges::stable_sort(order, {}, &RecordInput::clock_start_s);
  for (std::size_t k = 1; k < order.size(); ++k)
    if (!(order[k]->clock_start_s >= order[k - 1]->clock_start_s + order[k - 1]->duration_s)) return false;
  const double first_s = order.front()->clock_start_s;
  for (RecordInput& r : records) r.start_s = r.clock_start_s - first_s;
  sort_by_start(records);
  campaign.notes.push_back("start times are not declared: the clocks of the records, which do not overlap, are taken for one");
  return true;
}

// Declared starts, or rests, or ten minutes between.
void lay_out_in_order(CampaignInput& campaign) {
  constexpr double kRest_s = 600.0;
  double clock_s = 0.0;
  for (RecordInput& r : campaign.records) {
    if (std::isfinite(r.start_s) && r.start_s >= clock_s)
      clock_s = r.start_s;
    else
      clock_s += std::isfinite(r.rest_before_s) ? r.rest_before_s : (clock_s > 0.0 ? kRest_s : 0.0);
    r.start_s = clock_s;
    clock_s += r.duration_s;
  }
}

// "r2 has no start_s, which other records have"; empty where none has any.
std::string without_times(const std::vector<RecordInput>& records) {
  for (const auto& [member, key] : {std::pair{&RecordInput::start_s, "start_s"}, std::pair{&RecordInput::rest_before_s, "rest_before_s"}}) {
    std::vector<std::string> names;
    for (const RecordInput& r : records)
      if (!std::isfinite(r.*member)) names.push_back(r.name);
    if (names.size() < records.size()) return some_of(names) + (names.size() > 1 ? " have no " : " has no ") + key + ", which other records have";
  }
  return {};
}

void set_start_times(CampaignInput& campaign) {
  auto& records = campaign.records;
  const auto every = [&](double RecordInput::*known) {
    return std::ranges::all_of(records, [&](const RecordInput& r) { return std::isfinite(r.*known); });
  };
  if (every(&RecordInput::start_s)) {
    sort_by_start(records);
    return;
  }
  const bool rests_known = every(&RecordInput::rest_before_s);
  if (!rests_known && take_clocks_as_starts(campaign)) return;
  const std::string silent = without_times(records);
  lay_out_in_order(campaign);
  if (!rests_known && records.size() > 1) {
    campaign.has_start_times = false;
    campaign.notes.push_back(
        silent.empty() ? "start times are not declared: records are taken in order with 10 min of rest between"
                       : silent + ": records are taken in order, with 10 min of rest where none is declared, "
                                  "and what goes with the campaign's time cannot be claimed");
  }
}

struct Rows {
  std::vector<double> F_N, U_V;
};

// Some thousands of usable rows of every record.
Rows thinned(const std::vector<RecordInput>& records) {
  Rows out;
  for (const RecordInput& r : records) {
    EvenlyChosen choice(r.rows(), 4000);
    for (std::size_t i = 0; i < r.rows(); ++i)
      if (r.ok[i] != 0 && choice.next()) {
        out.F_N.push_back(r.F_N[i]);
        out.U_V.push_back(r.U_V[i]);
      }
  }
  return out;
}

// A load that stood elsewhere for a moment only is in no quantile.
void widen_to_what_lasts(CampaignInput& campaign) {
  constexpr double kMostOfIt = 0.5;
  Extremes force, output;
  for (const RecordInput& r : campaign.records)
    for (const auto& [all, one] : {std::pair{&force, lasting(r, r.F_N)}, std::pair{&output, lasting(r, r.U_V)}}) {
      all->low = std::min(all->low, one.low);
      all->high = std::max(all->high, one.high);
    }
  if (campaign.range_N < kMostOfIt * force.span()) {
    campaign.lowest_N = force.low;
    campaign.range_N = force.span();
    campaign.U_range_V = std::max(campaign.U_range_V, output.span());
  }
}

void set_ranges(CampaignInput& campaign) {
  Rows rows = thinned(campaign.records);
  if (rows.F_N.empty()) return;
  const auto [low_N, high_N] = quantiles(std::move(rows.F_N), 0.001, 0.999);
  const auto [low_V, high_V] = quantiles(std::move(rows.U_V), 0.001, 0.999);
  campaign.lowest_N = low_N;
  campaign.range_N = std::max(1e-12, high_N - low_N);
  campaign.U_range_V = std::max(1e-12, high_V - low_V);
  widen_to_what_lasts(campaign);
}

// As a regressor the noise of a force that stands still would pull gains to zero.
void flatten_standing_forces(CampaignInput& campaign, unsigned threads) {
  parallel_for(campaign.records.size(), threads, [&](std::size_t k) {
    RecordInput& r = campaign.records[k];
    if (!stands_still(r, campaign.range_N)) return;
    const double middle =
        std::accumulate(r.F_N.begin(), r.F_N.end(), 0.0) / static_cast<double>(r.F_N.size());
    std::fill(r.F_N.begin(), r.F_N.end(), middle);
    std::fill(r.fast_F_N.begin(), r.fast_F_N.end(), middle);
    std::fill(r.rate_N_per_s.begin(), r.rate_N_per_s.end(), 0.0);
  });
}

// A column that effects of every record need is there where all have it, one that acts in its own record where any has it.
void note_columns(CampaignInput& campaign) {
  const auto& records = campaign.records;
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
}

bool drives_differ(const std::vector<RecordInput>& records) {
  double low_V = 1e300, high_V = -1e300;
  bool known = !records.empty();
  for (const RecordInput& r : records) {
    known &= std::isfinite(r.drive_mean_V);
    low_V = std::min(low_V, r.drive_mean_V);
    high_V = std::max(high_V, r.drive_mean_V);
  }
  return known && high_V - low_V > 0.02 * std::abs(high_V);
}

// The first record follows a rest without end.
void set_rests(std::vector<RecordInput>& records) {
  for (std::size_t k = 0; k < records.size(); ++k) {
    RecordInput& r = records[k];
    if (!std::isfinite(r.rest_before_s))
      r.rest_before_s =
          k == 0 ? 1e5 : std::max(0.0, r.start_s - records[k - 1].start_s - records[k - 1].duration_s);
  }
}

}  // namespace

void finish_campaign_input(CampaignInput& campaign, unsigned threads) {
  set_start_times(campaign);
  set_ranges(campaign);
  flatten_standing_forces(campaign, threads);
  for (std::size_t k = 0; k < campaign.records.size(); ++k) campaign.records[k].index = campaign.records[k].recording = k;
  set_rests(campaign.records);
  add_up_travel(campaign);
  number_mountings(campaign);
  note_columns(campaign);
  take_spindle(campaign);
  note_missing_facts(campaign);
  campaign.has_drive = drives_differ(campaign.records);
}

std::vector<std::size_t> sample_counts(const Campaign& campaign) {
  std::vector<std::size_t> out;
  for (const Record& record : campaign.records) out.push_back(record.trace.size());
  return out;
}

Result<CampaignInput> make_campaign_input(const Campaign& campaign, unsigned threads, const RowParts& parts,
                                          std::span<const std::vector<std::uint8_t>> bad) {
  CampaignInput out;
  out.name = campaign.name;
  out.bench = campaign.bench;
  out.in_counts = is_in_counts(campaign);
  std::vector<Result<RecordInput>> made(campaign.records.size());
  parallel_for_largest_first(sample_counts(campaign), threads, [&](std::size_t k) {
    const Record& record = campaign.records[k];
    made[k] = make_record_input(record, bad.empty() ? std::span<const std::uint8_t>() : bad[k], row_step_of(record, campaign.records.size()), parts);
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
