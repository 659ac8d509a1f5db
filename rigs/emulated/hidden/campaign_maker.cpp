#include "rigs/emulated/hidden/campaign_maker.h"

#include <algorithm>
#include <cmath>

#include "hil/base/text.h"
#include "rigs/emulated/hidden/detectability.h"
#include "rigs/emulated/hidden/difference.h"
#include "rigs/emulated/hidden/documentation.h"
#include "rigs/emulated/hidden/numeric.h"
#include "rigs/emulated/hidden/protocol.h"

namespace forcegate::hidden {
namespace {

constexpr Clocking kPreview{200.0, 50.0, false};
constexpr int kPreviewRuns = 9;

struct Band {
  double low_pct, high_pct, rival_factor;
};

Band band_of(Tier tier) {
  switch (tier) {
    case Tier::weak: return {0.15, 0.30, 0.7};
    case Tier::medium: return {0.40, 0.85, 1.5};
    default: return {1.2, 2.6, 3.0};
  }
}

/// Everything that a request fixes before an effect has a strength.
struct Stage {
  std::vector<const HiddenKind*> kinds;
  Conditions conditions;
  Climate climate;
  std::vector<RecordPlan> plans;
};

Result<Stage> set_stage(const CampaignRequest& request) {
  if (!(request.minutes >= 1.0 && request.minutes <= 60.0))
    return fail(ErrorCode::usage, "the long sines last between 1 and 60 minutes");
  Stage stage;
  ConditionNeeds needs;
  std::vector<std::string> required;
  for (const std::string& name : request.effects) {
    const HiddenKind* kind = Registry<HiddenKind>::instance().find(name);
    if (!kind) {
      const std::string near = nearest_name(name, Registry<HiddenKind>::instance().names());
      return fail(
          ErrorCode::usage, "there is no effect \"" + name + "\"", "",
          near.empty() ? "names are listed by `forcegate mystery --list`" : "did you mean \"" + near + "\"?");
    }
    stage.kinds.push_back(kind);
    needs.theta |= kind->needs_theta;
    needs.command |= kind->needs_command;
    needs.drive |= kind->needs_drive;
    needs.remounting |= kind->needs_remounting;
    needs.climate |= kind->needs_climate;
    needs.fast_reference |= kind->needs_fast_reference;
    for (const std::string& wanted : kind->needs_kinds) {
      const auto have = std::count(required.begin(), required.end(), wanted);
      const auto want = std::count(kind->needs_kinds.begin(), kind->needs_kinds.end(), wanted);
      if (have < want) required.push_back(wanted);
    }
  }
  stage.conditions = draw_conditions(request.seed, needs);
  stage.plans = draw_protocol(request.seed, stage.conditions, required, request.minutes);
  Rng rng(request.seed, "climate");
  const double span_s = stage.plans.back().start_s + stage.plans.back().duration_s;
  stage.climate = Climate(rng, stage.conditions.climate_swing_C, stage.conditions.climate_swing_pct, span_s);
  return stage;
}

std::unique_ptr<HiddenEffect> make_effect(const HiddenKind& kind, std::uint64_t seed, double strength) {
  Rng rng(seed, "effect/" + kind.name);
  auto effect = kind.make(rng);
  effect->set_strength(strength);
  return effect;
}

/// RMS in U of the scatter of gain and offset from record to record, % of span.
double repeatability_pct(const Conditions& c) {
  const double gain = 100.0 * c.sd_gain * 0.35, offset = c.sd_offset_pct;
  return std::sqrt(gain * gain + offset * offset);
}

double reference_noise_pct(const Conditions& c) {
  const double rounding = c.reference_step_N / std::sqrt(12.0);
  return 100.0 * std::sqrt(c.reference_noise_N * c.reference_noise_N + rounding * rounding) / c.force_max_N;
}

double target_pct(const HiddenKind& kind, const Conditions& c, Tier tier, Rng& rng) {
  const Band band = band_of(tier);
  double target = band.low_pct * portable::pow(band.high_pct / band.low_pct, rng.uniform());
  const double lift = rng.uniform(0.9, 1.3) * band.rival_factor;
  if (kind.rival == Rival::repeatability) target = std::max(target, lift * repeatability_pct(c));
  if (kind.rival == Rival::reference_noise) target = std::max(target, lift * reference_noise_pct(c));
  return std::min(target, 8.0);
}

/// Search on coarse previews until the size is within a tenth of the target: regula falsi in logarithms,
/// bisection where that leaves the bracket. Effects with a threshold (a rail, a gap) jump; then the nearest
/// size found counts.
double find_strength(const Stage& stage, const HiddenKind& kind, std::uint64_t seed, double target) {
  const auto clean = run_campaign(stage.conditions, stage.climate, stage.plans, {}, kPreview);
  const double span = span_of(clean, kind.measure);
  const auto size_at = [&](double s) {
    Effects effects;
    effects.push_back(make_effect(kind, seed, s));
    const auto with = run_campaign(stage.conditions, stage.climate, stage.plans, effects, kPreview);
    return 100.0 * difference(with, clean, kind.measure).rms / span;
  };
  double s = 1.0, best = 1.0, best_error = 1e300, low = 0.0, low_size = 0.0, high = 0.0, high_size = 0.0;
  for (int run = 0; run < kPreviewRuns; ++run) {
    const double size = size_at(s), error = std::abs(portable::log((size + 1e-6) / target));
    if (error < best_error) best = s, best_error = error;
    if (error < 0.1 || (s >= kind.strength_max && size < target)) break;
    if (size < target)
      low = s, low_size = size;
    else
      high = s, high_size = size;
    if (low > 0.0 && high > 0.0) {
      const double middle = std::sqrt(low * high);
      const double power =
          low_size > 0.0 ? portable::log(high_size / low_size) / portable::log(high / low) : 0.0;
      s = power > 0.0 ? low * portable::pow(target / low_size, 1.0 / power) : middle;
      if (run > 4 || !(s > 1.02 * low && s < 0.98 * high)) s = middle;
    } else {
      s *= size > 0.0 ? std::clamp(target / size, 0.02, 12.0) : 3.0;
    }
    s = std::min(s, kind.strength_max);
  }
  return best;
}

TruthEffect describe(const HiddenKind& kind, const HiddenEffect& effect, const Difference& voltage,
                     const Difference& force, const Truth& truth) {
  TruthEffect t;
  t.name = kind.name;
  t.side = kind.side;
  t.also_side = kind.also_side;
  t.form = effect.form();
  t.measure = kind.measure == Measure::voltage ? "voltage" : "force";
  t.foreign = kind.foreign;
  t.reducible = kind.reducible;
  t.strength = effect.strength();
  t.depends_on = kind.depends_on;
  const double per_V = 100.0 / truth.voltage_span_V, per_N = 100.0 / truth.force_span_N;
  t.rms_voltage_pct = voltage.plain_rms * per_V;
  t.rms_force_pct = force.plain_rms * per_N;
  const bool in_voltage = kind.measure == Measure::voltage;
  const Difference& own = in_voltage ? voltage : force;
  const double per_unit = in_voltage ? per_V : per_N;
  t.rms_pct = own.rms * per_unit;
  t.heldout_rms = own.heldout_rms;
  for (const double rms : own.record_rms) t.record_rms_pct.push_back(rms * per_unit);
  const double noise = in_voltage ? truth.voltage_noise_pct : truth.force_noise_pct;
  t.excited = t.rms_pct > std::max(0.2 * noise, 0.02);
  return t;
}

/// Whether a reader of the columns and of campaign.json can know what differed between the records.
bool is_recorded(Cause cause, const Conditions& c, const BenchNotes& notes) {
  const auto every = [&](auto member) {
    return std::all_of(notes.records.begin(), notes.records.end(), [&](const RecordNotes& r) { return (r.*member).has_value(); });
  };
  switch (cause) {
    case Cause::loading: return every(&RecordNotes::start_s) || every(&RecordNotes::rest_before_s);
    case Cause::temperature: return c.log_temperature;
    case Cause::humidity: return c.log_humidity;
    case Cause::drive: return every(&RecordNotes::drive_V);
    case Cause::mounting: return every(&RecordNotes::mounting);
  }
  return true;
}

std::map<std::string, std::string> describe(const Conditions& c) {
  return {{"decay_law", std::string(to_string(c.decay))},
          {"gain_N_per_V", shortest(c.gain_N_per_V)},
          {"offset_N", shortest(c.offset_N)},
          {"sd_b", shortest(c.sd_b)},
          {"sd_q", shortest(c.sd_q)},
          {"sd_gain", shortest(c.sd_gain)},
          {"sd_offset_pct", shortest(c.sd_offset_pct)},
          {"adc_bits", std::to_string(c.adc_bits)},
          {"voltage_noise_V", shortest(c.voltage_noise_V)},
          {"wander_V", shortest(c.wander_V)},
          {"wander_tau_s", shortest(c.wander_tau_s)},
          {"reference_noise_N", shortest(c.reference_noise_N)},
          {"reference_lag_s", shortest(c.reference_lag_s)},
          {"jitter_share", shortest(c.jitter_share)},
          {"reference_step_N", shortest(c.reference_step_N)},
          {"voltage_max_V", shortest(c.voltage_max_V)},
          {"session_share", shortest(c.session_share)},
          {"gaps_per_hour", shortest(c.gaps_per_hour)},
          {"climate_swing_C", shortest(c.climate_swing_C)}};
}

MadeCampaign perform(const CampaignRequest& request, const Stage& stage,
                     const std::vector<double>& strengths) {
  const auto effects_but = [&](std::size_t left_out) {
    Effects effects;
    for (std::size_t k = 0; k < stage.kinds.size(); ++k)
      if (k != left_out) effects.push_back(make_effect(*stage.kinds[k], request.seed, strengths[k]));
    return effects;
  };
  const auto run = [&](const Effects& effects, const Clocking& clocking) {
    return run_campaign(stage.conditions, stage.climate, stage.plans, effects, clocking);
  };
  MadeCampaign made;
  const Effects all = effects_but(stage.kinds.size());
  made.conditions = stage.conditions;
  made.records = run(all, {});
  Truth& truth = made.truth;
  const Conditions& c = stage.conditions;
  truth.campaign = request.name;
  truth.seed = request.seed;
  truth.tier = stage.kinds.empty() ? Tier::none : request.tier;
  truth.minutes = request.minutes;
  truth.conditions = describe(c);
  truth.voltage_span_V = span_of(made.records, Measure::voltage);
  truth.force_span_N = span_of(made.records, Measure::force);
  const double lsb_V = c.voltage_max_V / ((1 << c.adc_bits) - 1) / std::sqrt(12.0);
  truth.voltage_noise_pct =
      100.0 * std::sqrt(c.voltage_noise_V * c.voltage_noise_V + lsb_V * lsb_V) / truth.voltage_span_V;
  truth.force_noise_pct = reference_noise_pct(c);
  truth.repeatability_pct = repeatability_pct(c);
  const BenchNotes notes = write_down(request.seed, request.name, c, made.records);
  for (std::size_t k = 0; k < stage.kinds.size(); ++k) {
    const HiddenKind& kind = *stage.kinds[k];
    const auto without = run(effects_but(k), Clocking{800.0, 1e9, false});
    truth.effects.push_back(describe(kind, *all[k], difference(made.records, without, Measure::voltage),
                                     difference(made.records, without, Measure::force), truth));
    if (kind.rival != Rival::repeatability) continue;
    TruthEffect& told = truth.effects.back();
    told.between_records = true;
    told.detectability = detectability_between(made.records, without, c, kind.measure);
    told.excited = told.excited && told.detectability >= 2.0;
    told.cause_recorded = is_recorded(kind.cause, c, notes);
  }
  return made;
}

}  // namespace

std::vector<std::string> effect_names(bool foreign) {
  std::vector<std::string> names;
  for (const HiddenKind& kind : Registry<HiddenKind>::instance().all())
    if (kind.foreign == foreign) names.push_back(kind.name);
  return names;
}

Result<MadeCampaign> make_campaign(const CampaignRequest& request) {
  FORCEGATE_TRY(const Stage stage, set_stage(request));
  std::vector<double> strengths;
  for (const HiddenKind* kind : stage.kinds) {
    Rng rng(request.seed, "tier/" + kind->name);
    strengths.push_back(
        find_strength(stage, *kind, request.seed, target_pct(*kind, stage.conditions, request.tier, rng)));
  }
  return perform(request, stage, strengths);
}

Result<MadeCampaign> make_campaign_at(const CampaignRequest& request, const std::vector<double>& strengths) {
  FORCEGATE_TRY(const Stage stage, set_stage(request));
  if (strengths.size() != stage.kinds.size())
    return fail(ErrorCode::usage, "one strength for each effect is needed");
  return perform(request, stage, strengths);
}

Result<MadeCampaign> make_twin(const CampaignRequest& request) {
  FORCEGATE_TRY(Stage stage, set_stage(request));
  stage.kinds.clear();
  return perform(request, stage, {});
}

namespace {

// Behind what the plans hold already.
Result<RecordPlan> plan_of(const AskedForce& a, const Stage& stage, std::uint64_t seed) {
  if (a.t_s.size() < 2 || a.t_s.size() != a.force_N.size() || !std::is_sorted(a.t_s.begin(), a.t_s.end()))
    return fail(ErrorCode::usage, "a force to play needs at least two points in order of time");
  const RecordPlan& last = stage.plans.back();
  RecordPlan p;
  p.kind = a.kind;
  p.dynamic = a.f_min_Hz > 0.0;
  p.f_min_Hz = a.f_min_Hz;
  p.point_s = a.t_s;
  p.point_N = a.force_N;
  p.duration_s = a.t_s.back();
  p.rate_Hz = stage.conditions.slow_rate_Hz;
  p.rest_before_s = a.rest_before_s;
  p.start_s = std::round(last.start_s + last.duration_s + a.rest_before_s);
  p.low_N = *std::min_element(a.force_N.begin(), a.force_N.end());
  p.high_N = *std::max_element(a.force_N.begin(), a.force_N.end());
  p.drive_V = last.drive_V;
  p.mounting = last.mounting;
  const std::string number = std::to_string(a.number);
  p.seed = mix_seed(seed, "record/" + number);
  p.session_seed = mix_seed(seed, "session/asked/" + number);
  return p;
}

}  // namespace

Result<MadeCampaign> continue_campaign(const Truth& truth, const std::vector<AskedForce>& played, const std::vector<AskedForce>& asked) {
  CampaignRequest request;
  request.seed = truth.seed;
  request.name = truth.campaign;
  request.tier = truth.tier;
  request.minutes = truth.minutes;
  for (const TruthEffect& e : truth.effects) request.effects.push_back(e.name);
  FORCEGATE_TRY(Stage stage, set_stage(request));
  for (const std::vector<AskedForce>* forces : {&played, &asked})
    for (const AskedForce& force : *forces) {
      FORCEGATE_TRY(RecordPlan plan, plan_of(force, stage, truth.seed));
      stage.plans.push_back(std::move(plan));
    }
  std::vector<std::unique_ptr<HiddenEffect>> effects;
  for (std::size_t k = 0; k < stage.kinds.size(); ++k)
    effects.push_back(make_effect(*stage.kinds[k], truth.seed, truth.effects[k].strength));
  MadeCampaign made;
  made.conditions = stage.conditions;
  made.truth = truth;
  made.records = run_campaign(stage.conditions, stage.climate, stage.plans, effects, {});
  made.records.erase(made.records.begin(), made.records.end() - static_cast<std::ptrdiff_t>(asked.size()));
  return made;
}

Campaign to_campaign(MadeCampaign&& made) {
  const BenchNotes notes = write_down(made.truth.seed, made.truth.campaign, made.conditions, made.records);
  Campaign campaign;
  campaign.name = made.truth.campaign;
  campaign.sensor = notes.sensor;
  BenchFacts& bench = campaign.bench;
  bench.spring_N_per_mm = notes.spring_N_per_mm.value_or(kMissing);
  if (notes.voltage_range) bench.voltage_min_V = 0.0, bench.voltage_max_V = made.conditions.voltage_max_V;
  if (notes.force_range) bench.force_min_N = 0.0, bench.force_max_N = 5.0;
  bench.reference_resolution_N = notes.reference_resolution_N.value_or(kMissing);
  bench.reference_noise_N = notes.reference_noise_N.value_or(kMissing);
  bench.adc_bits = notes.adc_bits.value_or(0);
  if (notes.law) bench.law = "F = k (preload + eccentricity (1 - cos theta))";
  for (std::size_t i = 0; i < made.records.size(); ++i) {
    RecordData& data = made.records[i];
    const RecordNotes& said = notes.records[i];
    Record record;
    record.name = said.file.substr(0, said.file.find_last_of('.'));
    record.kind = said.kind;
    record.role_given = said.role.has_value();
    record.role = said.role == "heldout" ? RecordRole::heldout : RecordRole::fit;
    record.rate_Hz = said.rate_Hz;
    record.start_s = said.start_s;
    record.rest_before_s = said.rest_before_s;
    record.excitation_start_s = said.excitation_start_s;
    record.f_min_Hz = said.f_min_Hz;
    record.A_N = said.A_N;
    record.m_N = said.m_N;
    record.drive_V = said.drive_V;
    if (said.mounting) record.mounting = std::to_string(*said.mounting);
    record.eccentricity_mm = said.eccentricity_mm;
    record.preload_mm = said.preload_mm;
    record.dynamic = said.dynamic;
    record.trace.name = record.name;
    record.trace.time_bases.push_back({"rig", std::move(data.stamp_s), data.plan.rate_Hz, {}, false});
    const auto add = [&](const char* name, const char* unit, const char* quantity,
                         std::vector<double>& column) {
      if (column.empty()) return;
      record.trace.channels.push_back({name, unit, quantity, 0, std::move(column), {}});
    };
    add("F_ref", "N", "force", data.force_ref_N);
    add("U", "V", "voltage", data.voltage_V);
    add("theta", "rad", "angle", data.theta_rad);
    add("temp", "C", "temperature", data.temperature_C);
    for (double& humidity : data.humidity_pct) humidity *= 0.01;  // a channel holds a share
    add("humidity", "1", "ratio", data.humidity_pct);
    add("C", "F", "capacitance", data.capacitance_F);
    add("F_cmd", "N", "force", data.setpoint_N);
    campaign.records.push_back(std::move(record));
  }
  return campaign;
}

}  // namespace forcegate::hidden
