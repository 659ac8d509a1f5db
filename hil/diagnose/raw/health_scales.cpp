#include "hil/diagnose/raw/health_scales.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "hil/base/evenly_chosen.h"
#include "hil/base/parallel.h"
#include "hil/base/quantile.h"
#include "hil/diagnose/raw/force_and_output.h"
#include "hil/diagnose/raw/record_scales.h"
#include "hil/diagnose/raw/sample_noise.h"
#include "hil/diagnose/raw/short_spikes.h"

namespace forcegate::diagnose {

namespace {

// Some samples of each record, evenly spread over those that have both.
struct Selection {
  std::vector<double> F_N, U_V;
};

Selection some_of_all_records(const Campaign& campaign) {
  constexpr std::size_t kOfRecord = 3000;
  Selection out;
  for (const Record& record : campaign.records) {
    const Channel *f = record.trace.find("F_ref"), *u = record.trace.find("U");
    if (f == nullptr || u == nullptr) continue;
    const std::size_t n = std::min(f->value.size(), u->value.size());
    EvenlyChosen choice(n, kOfRecord);
    for (std::size_t i = 0; i < n; ++i)
      if (std::isfinite(f->value[i]) && std::isfinite(u->value[i]) && choice.next()) {
        out.F_N.push_back(f->value[i]);
        out.U_V.push_back(u->value[i]);
      }
  }
  return out;
}

std::string unit_of_output(const Campaign& campaign, const std::string& otherwise) {
  for (const Record& record : campaign.records) {
    const Channel* u = record.trace.find("U");
    if (u != nullptr && !u->unit.empty() && (u->unit != "1" || u->quantity == "ratio")) return u->unit;
  }
  return otherwise;
}

double span_of(const std::vector<double>& values) {
  constexpr double kTail = 0.001, kLeast = 1e-12;
  return std::max(kLeast, quantile(values, 1.0 - kTail) - quantile(values, kTail));
}

bool thrown_in_all(const Campaign& campaign, const HealthScales& scales, unsigned threads) {
  std::vector<std::vector<Jump>> of_record(campaign.records.size());
  std::vector<double> quiet_V(campaign.records.size(), 0.0);
  parallel_for(campaign.records.size(), threads, [&](std::size_t k) {
    const std::optional<ForceAndOutput> samples = ForceAndOutput::of(campaign.records[k].trace);
    if (!samples) return;
    quiet_V[k] = quiet_step_V(*samples, white_noise(samples->U_V()), scales.step_V, scales);
    of_record[k] = excursions(samples->t_s(), samples->F_N(), samples->U_V(),
                              {.quiet_V = quiet_V[k], .gain_V_per_N = std::abs(scales.gain_V_per_N)});
  });
  std::vector<Jump> all;
  for (const std::vector<Jump>& one : of_record) all.insert(all.end(), one.begin(), one.end());
  return !quiet_V.empty() && thrown_at_random(all, std::ranges::max(quiet_V));
}

}  // namespace

HealthScales health_scales(const Campaign& campaign, unsigned threads) {
  constexpr std::size_t kFewest = 8;
  HealthScales out;
  out.unit = unit_of_output(campaign, out.unit);
  const auto [F_N, U_V] = some_of_all_records(campaign);
  if (F_N.size() < kFewest) return out;
  out.range_N = span_of(F_N);
  out.U_range_V = span_of(U_V);
  out.gain_V_per_N = joint_squares(F_N, U_V).gain_V_per_N().value_or(1.0);
  out.step_N = value_step(F_N);
  out.step_V = value_step(U_V);
  out.thrown = thrown_in_all(campaign, out, threads);
  return out;
}

}  // namespace forcegate::diagnose
