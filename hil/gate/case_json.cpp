#include "hil/gate/case_json.h"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "hil/base/text.h"

namespace forcegate {
namespace {

using Json = nlohmann::json;

// One list of fields per type serves both directions: Put writes a member into an object, Get reads it back.
struct Put {
  Json& object;
  template <class T>
  void operator()(const char* name, T& value);
};
struct Get {
  const Json& object;
  template <class T>
  void operator()(const char* name, T& value);
};

template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, Error> {
  f("code", v.code), f("text", v.text), f("where", v.where), f("hint", v.hint);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, CaseFailure> {
  f("stage", v.stage), f("error", v.error), f("blame", v.blame), f("sample", v.sample);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, Calibration> {
  f("gain", v.gain_N_per_V), f("offset", v.offset_N), f("bits", v.adc_bits), f("range", v.v_range_V);
  f("b", v.b_scale), f("q", v.q_scale), f("level", v.level), f("id", v.id);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, StimulusSpec> {
  f("name", v.name), f("numbers", v.numbers), f("lists", v.lists), f("texts", v.texts), f("seed", v.seed);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, PlanCase> {
  f("name", v.name), f("title", v.title), f("source", v.source), f("stimulus", v.stimulus), f("loop", v.loop);
  f("lane", v.lane), f("prelude", v.prelude_s);
  f("controller", v.controller), f("checks", v.checks), f("specimens", v.specimens),
      f("rest", v.rest_before_s);
  f("prominence", v.prominence_N), f("half_width", v.half_width_s), f("tail", v.tail_s),
      f("maxima", v.maxima_pct);
  f("minima", v.minima_pct), f("limit_source", v.limit_source), f("where", v.where);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, PlanIdentification> {
  f("stimulus", v.stimulus), f("source", v.source);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, PlanCalibration> {
  f("level", v.level), f("low", v.sweep_low_N), f("high", v.sweep_high_N), f("sweep_s", v.sweep_s);
  f("sweeps", v.sweeps), f("rest", v.rest_s), f("identification", v.identification);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, SafetyLimits> {
  f("force", v.force_max_N), f("velocity", v.velocity_max_rad_per_s), f("lost", v.reference_lost_samples);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, CaseJob> {
  f("kind", v.kind), f("id", v.id), f("index", v.index), f("rig", v.rig), f("rig_options", v.rig_options);
  f("lane", v.lane), f("lane_options", v.lane_options), f("image", v.image), f("nonce", v.nonce);
  f("planned", v.planned), f("specimen", v.specimen), f("seed", v.seed), f("session", v.session);
  f("record", v.record), f("attempt", v.attempt), f("calibration", v.calibration),
      f("calibrate", v.calibrate), f("safety", v.safety);
  f("faults", v.faults), f("keep", v.keep_path), f("curves", v.curves), f("given", v.calibration_given);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, RigGeometry> {
  f("k", v.spring_N_per_mm), f("e", v.eccentricity_mm), f("preload", v.preload_mm), f("low", v.theta_min_rad);
  f("high", v.theta_max_rad), f("velocity", v.velocity_max_rad_per_s);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, RigInfo> {
  f("name", v.name), f("id", v.id), f("version", v.version), f("rate", v.rate_Hz), f("bits", v.adc_bits);
  f("range", v.v_range_V), f("force", v.force_max_N), f("resolution", v.reference_resolution_N);
  f("noise", v.reference_noise_N), f("u_rel", v.reference_u_rel), f("geometry", v.geometry);
  f("can_move", v.can_move), f("emulated", v.emulated), f("details", v.details), f("u_time", v.reference_u_time_s);
  f("force_rate", v.force_rate_max_N_per_s);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, DutInfo> {
  f("major", v.protocol_major), f("minor", v.protocol_minor), f("board", v.board), f("build", v.build_id);
  f("algorithm", v.algorithm_id), f("nonce", v.nonce), f("bits", v.adc_bits), f("rate", v.rate_Hz);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, DutCounters> {
  f("samples", v.samples), f("dropped", v.frames_dropped), f("bad", v.frames_bad), f("lost", v.indices_lost);
  f("overruns", v.overruns), f("naks", v.naks);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, DutResources> {
  f("worst", v.instructions_worst), f("mean", v.instructions_mean), f("worst_at", v.worst_at_s),
      f("late", v.late);
  f("stack", v.stack_bytes), f("ram", v.ram_bytes), f("flash", v.flash_bytes), f("heap", v.heap_growth_bytes);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, PreludeFacts> {
  f("samples", v.samples), f("nan", v.not_finite), f("largest", v.largest_N), f("known", v.conformance_known);
  f("value", v.conformance), f("limit", v.conformance_limit), f("unit", v.conformance_unit);
  f("source", v.conformance_source), f("evidence", v.conformance_evidence);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, StimulusFacts> {
  f("mean", v.mean_N), f("amplitude", v.amplitude_N), f("f", v.lowest_frequency_Hz),
      f("start", v.excitation_start_s);
  f("low", v.minimum_N), f("high", v.maximum_N), f("dynamic", v.dynamic);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, RigObservation> {
  f("samples", v.samples), f("first", v.first_t_s), f("last", v.last_t_s), f("backward", v.time_not_monotone);
  f("gaps", v.time_gaps), f("worst_step", v.worst_step_s), f("lost", v.lost),
      f("saturated", v.reference_saturated);
  f("fault", v.reference_fault), f("nan", v.reference_not_finite), f("motor", v.motor_fault),
      f("stop", v.travel_stop);
  f("rail", v.adc_rail), f("min", v.reference_min_N), f("max", v.reference_max_N),
      f("mean", v.reference_mean_N);
  f("noise", v.reference_noise_N), f("frozen", v.reference_frozen_s), f("sensor_dead", v.sensor_dead_s);
  f("wheel_still", v.theta_still_while_commanded_s), f("adc_min", v.adc_min), f("adc_max", v.adc_max);
  f("stuck", v.adc_bits_stuck), f("spring_n", v.spring_samples), f("spring_bias", v.spring_bias_N);
  f("spring_worst", v.spring_worst_bias_N), f("spring_slope", v.spring_slope),
      f("spring_rms", v.spring_rms_N);
  f("reference_lag", v.reference_lag_s), f("following", v.following_rad), f("zero_start", v.zero_start_N);
  f("zero_end", v.zero_end_N), f("reference_stale", v.reference_stale_s), f("sensor_stale", v.sensor_stale_s);
  f("worst_gap", v.worst_gap_s), f("sensor_blocks", v.sensor_blocks), f("sensor_odd", v.sensor_blocks_odd);
  f("sensor_jumps", v.sensor_jumps), f("sensor_lag", v.sensor_lag_s),
      f("command_step", v.command_step_rad), f("sensor_clipped", v.sensor_clipped_s);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, SafetyReport> {
  f("reason", v.reason), f("t", v.t_s), f("force", v.force_N), f("clipped", v.clipped_commands);
  f("travel", v.travel_samples), f("travel_first", v.travel_first_s);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, OutputFacts> {
  f("nan", v.not_finite), f("first_nan", v.first_not_finite_s), f("min", v.minimum_N), f("max", v.maximum_N);
  f("longest", v.learning_longest_s), f("end", v.learning_end_s), f("held", v.held), f("rail", v.input_rail);
  f("clamped", v.clamped), f("departure", v.departure_N), f("spike", v.spike_N), f("spike_t", v.spike_t_s);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, HoldFacts> {
  f("seconds", v.seconds), f("dut", v.dut_N), f("raw", v.raw_N), f("ati", v.ati_N);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, CasePair> {
  f("max", v.maximum), f("t", v.t_s), f("s", v.setpoint_N), f("a", v.ati_N), f("d", v.dut_N), f("r", v.raw_N);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, PlotTrace> {
  f("name", v.name), f("unit", v.unit), f("t", v.t_s), f("v", v.value);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, RecordWindow> {
  f("t0", v.t0_s), f("step", v.step_s), f("ati", v.ati_N), f("dut", v.dut_N);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, DecayFit> {
  f("valid", v.valid), f("a", v.a_V), f("b", v.b_per_s), f("c", v.c_V), f("u_min", v.u_min_V),
      f("u_a", v.u_a_V);
  f("u_b", v.u_b_per_s), f("u_c", v.u_c_V), f("rmse", v.rmse_V), f("loss", v.loss_pct), f("n", v.n);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, CaseRecord> {
  f("id", v.id), f("index", v.index), f("failure", v.failure), f("rig", v.rig), f("firmware", v.firmware);
  f("resources", v.resources), f("prelude", v.prelude);
  f("link", v.link), f("facts", v.facts), f("duration", v.duration_s), f("samples", v.samples);
  f("expected", v.expected_samples), f("expected_extrema", v.expected_extrema), f("observed", v.observed);
  f("safety", v.safety), f("output", v.output), f("hold", v.hold), f("pairs", v.pairs), f("lag", v.lag_s);
  f("u_lag", v.u_lag_s), f("raw_lag", v.raw_lag_s), f("early_raw", v.early_raw_N),
      f("early_ati", v.early_ati_N);
  f("conf_known", v.conformance_known), f("conf", v.conformance);
  f("conf_limit", v.conformance_limit), f("conf_unit", v.conformance_unit),
      f("conf_source", v.conformance_source);
  f("conf_evidence", v.conformance_evidence), f("conf_n", v.conformance_n), f("waveform", v.waveform),
      f("overview", v.overview), f("window", v.window);
  f("window_reason", v.window_reason), f("decay", v.decay), f("digest", v.digest), f("trace", v.trace_file);
  f("calibration", v.calibration), f("given", v.calibration_given), f("u_gain", v.u_gain_rel), f("u_offset", v.u_offset_N);
  f("cal_rmse", v.calibration_rmse_N), f("cal_text", v.calibration_text);
}

template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, DecisionRule> {
  f("name", v.name), f("alpha", v.alpha), f("coverage", v.coverage), f("looks", v.looks);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, PlanLimits> {
  f("derived", v.derived), f("goldens", v.goldens), f("learning_s", v.learning_s), f("lag_s", v.lag_s),
      f("output_max_N", v.output_max_N);
  f("hold_pct", v.hold_pct), f("minima_floor_N", v.minima_floor_N), f("increase_pct", v.increase_pct), f("spike_max_N", v.spike_max_N);
  f("excursion_max_N", v.excursion_max_N);
  f("instructions", v.instructions), f("stack", v.stack_bytes), f("ram", v.ram_bytes),
      f("flash", v.flash_bytes);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, PlanUncertainty> {
  f("reference_rel", v.reference_rel), f("alignment_rel", v.alignment_rel);
  f("record_repeat_pct", v.record_repeat_pct);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, SelfCheckLimits> {
  f("zero_N", v.zero_N), f("spring_bias_N", v.spring_bias_N), f("spring_slope", v.spring_slope);
  f("spring_scatter_N", v.spring_scatter_N), f("following_rad", v.following_rad);
  f("reference_lag_s", v.reference_lag_s), f("noise_factor", v.noise_factor);
  f("reference_bad_share", v.reference_bad_share), f("lost_share", v.lost_share),
      f("stale_share", v.stale_share);
  f("frozen_s", v.frozen_s), f("wheel_still_s", v.wheel_still_s), f("sensor_dead_s", v.sensor_dead_s);
  f("sensor_odd_share", v.sensor_odd_share), f("gap_s", v.gap_s), f("clock_rel", v.clock_rel);
  f("jump_share", v.jump_share);
}
template <class F, class P>
constexpr void fields(F f, P& v) requires std::is_same_v<std::remove_const_t<P>, Plan> {
  f("name", v.name), f("doc", v.doc), f("sha256", v.sha256), f("seed", v.seed), f("rule", v.rule);
  f("attempts", v.retry.attempts), f("panel", v.panel), f("calibration", v.calibration),
      f("safety", v.safety), f("limits", v.limits);
  f("uncertainty", v.uncertainty), f("self_check", v.self_check), f("cases", v.cases);
}

template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};
template <class T>
struct IsMap : std::false_type {};
template <class K, class T>
struct IsMap<std::map<K, T>> : std::true_type {};
template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};

// A member that its list forgets comes back as its default, and nothing but a number tells: so the members are counted.
struct Anything {
  template <class T>
  operator T() const {
    std::abort();  // only asked whether it would do
  }
};
template <class T, class... Initializer>
consteval std::size_t members() {
  if constexpr (requires { T{Initializer{}..., Anything{}}; })
    return members<T, Initializer..., Anything>();
  else
    return sizeof...(Initializer);
}

struct Count {
  std::size_t& n;
  template <class T>
  constexpr void operator()(const char*, T&) {
    ++n;
  }
};
template <class T>
union Unmade {
  constexpr Unmade() : nothing() {}
  constexpr ~Unmade() {}
  char nothing;
  T object;
};
template <class T>
Unmade<T> unmade;
template <class T>
consteval std::size_t carried() {
  std::size_t n = 0;
  fields(Count{n}, unmade<T>.object);
  return n;
}

template <class T>
constexpr std::size_t kStaysBehind = 0;
template <>
constexpr std::size_t kStaysBehind<Plan> = 1;  // the path, of the machine that read it
template <>
constexpr std::size_t kStaysBehind<PlanLimits> = 1;  // the position in that file

template <class T>
Json put(const T& value) {
  if constexpr (std::is_enum_v<T>) {
    return static_cast<int>(value);
  } else if constexpr (std::is_floating_point_v<T>) {
    if (std::isfinite(value)) return value;
    return std::isnan(value) ? "nan" : value > 0 ? "inf" : "-inf";
  } else if constexpr (std::is_arithmetic_v<T>) {
    return value;
  } else if constexpr (std::is_same_v<T, std::string>) {
    return printable_utf8(value);
  } else if constexpr (IsOptional<T>::value) {
    return value ? put(*value) : Json();
  } else if constexpr (IsVector<T>::value) {
    Json list = Json::array();
    for (const auto& item : value) list.push_back(put(item));
    return list;
  } else if constexpr (IsMap<T>::value) {
    Json object = Json::object();
    for (const auto& [name, item] : value) object[name] = put(item);
    return object;
  } else {
    static_assert(carried<T>() + kStaysBehind<T> == members<T>(), "the list fields() of this type has not all of its members");
    Json object = Json::object();
    fields(Put{object}, value);
    return object;
  }
}

// Reads what put() wrote; throws Json::exception on anything else, caught in parse().
template <class T>
void get(const Json& from, T& value) {
  if constexpr (std::is_enum_v<T>) {
    value = static_cast<T>(from.get<int>());
  } else if constexpr (std::is_floating_point_v<T>) {
    if (from.is_string()) {
      const auto& text = from.get_ref<const std::string&>();
      value = text == "inf"    ? std::numeric_limits<T>::infinity()
              : text == "-inf" ? -std::numeric_limits<T>::infinity()
                               : std::numeric_limits<T>::quiet_NaN();
    } else {
      value = from.get<T>();
    }
  } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>) {
    value = from.get<T>();
  } else if constexpr (IsOptional<T>::value) {
    value.reset();
    if (from.is_null()) return;
    typename T::value_type item{};
    get(from, item);
    value = std::move(item);
  } else if constexpr (IsVector<T>::value) {
    value.clear();
    value.reserve(from.size());
    for (const Json& item : from) get(item, value.emplace_back());
  } else if constexpr (IsMap<T>::value) {
    value.clear();
    for (const auto& [name, item] : from.items()) get(item, value[name]);
  } else {
    fields(Get{from}, value);
  }
}

template <class T>
void Put::operator()(const char* name, T& value) {
  object[name] = put<std::remove_const_t<T>>(value);
}
template <class T>
void Get::operator()(const char* name, T& value) {
  // A field that an older bundle does not have keeps its default.
  if (const auto at = object.find(name); at != object.end()) get(*at, value);
}

template <class T>
Result<T> parse(std::string_view text, const char* what, const char* needed) {
  try {
    T value;
    const Json json = Json::parse(text);
    if (!json.is_object() || !json.contains(needed))
      return fail(ErrorCode::internal, std::string("the ") + what + " has no " + needed);
    get(json, value);
    return value;
  } catch (const Json::exception& e) {
    return fail(ErrorCode::internal,
                std::string("the ") + what + " cannot be read: " + printable_utf8(e.what()));
  }
}

}  // namespace

std::string to_json(const CaseJob& job) { return put(job).dump(); }
Result<CaseJob> job_from_json(std::string_view text) { return parse<CaseJob>(text, "job", "id"); }
std::string to_json(const CaseRecord& record) { return put(record).dump(); }
Result<CaseRecord> record_from_json(std::string_view text) { return parse<CaseRecord>(text, "record", "id"); }
std::string to_json(const Plan& plan) { return put(plan).dump(); }
Result<Plan> plan_from_json(std::string_view text) { return parse<Plan>(text, "plan", "cases"); }

}  // namespace forcegate
