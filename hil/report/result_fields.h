#pragma once
// The fields of a result in the order of the file: one list, walked by the writer and by the reader, so that
// the two cannot differ. An archive has operator()(name, value) for numbers, texts, vectors, maps and the
// structs below, and choice(name, value) for an enumeration that has words (to_string).

#include "hil/interface/run_result.h"

namespace forcegate::result_fields {

template <class A>
void walk(A& a, Limit& v) {
  a.choice("kind", v.kind);
  a("value", v.value);
  a("source", v.source);
}

template <class A>
void walk(A& a, Check& v) {
  a("id", v.id);
  a("case_id", v.case_id);
  a("title", v.title);
  a("value", v.value);
  a("unit", v.unit);
  a("u", v.u);
  a.optional("expanded_u", v.expanded_u);
  a("n", v.n);
  a("limit", v.limit);
  a.choice("verdict", v.verdict);
  a.choice("blame", v.blame);
  a("required", v.required);
  a("evidence", v.evidence);
}

template <class A>
void walk(A& a, Decision& v) {
  a.choice("kind", v.kind);
  a.choice("blame", v.blame);
  a("reason", v.reason);
  a("safety_stop", v.safety_stop);
  a("exit_code", v.exit_code);
}

template <class A>
void walk(A& a, Calibration& v) {
  a("gain_N_per_V", v.gain_N_per_V);
  a("offset_N", v.offset_N);
  a("adc_bits", v.adc_bits);
  a("v_range_V", v.v_range_V);
  a("b_scale", v.b_scale);
  a("q_scale", v.q_scale);
  a.choice("level", v.level);
  a("id", v.id);
}

template <class A>
void walk(A& a, DutInfo& v) {
  a("protocol_major", v.protocol_major);
  a("protocol_minor", v.protocol_minor);
  a("board", v.board);
  a("build_id", v.build_id);
  a("algorithm_id", v.algorithm_id);
  a("nonce", v.nonce);
  a("adc_bits", v.adc_bits);
  a("rate_Hz", v.rate_Hz);
}

template <class A>
void walk(A& a, DutCounters& v) {
  a("samples", v.samples);
  a("frames_dropped", v.frames_dropped);
  a("frames_bad", v.frames_bad);
  a("indices_lost", v.indices_lost);
  a("overruns", v.overruns);
  a("naks", v.naks);
}

template <class A>
void walk(A& a, RigGeometry& v) {
  a("spring_N_per_mm", v.spring_N_per_mm);
  a("eccentricity_mm", v.eccentricity_mm);
  a("preload_mm", v.preload_mm);
  a("theta_min_rad", v.theta_min_rad);
  a("theta_max_rad", v.theta_max_rad);
  a("velocity_max_rad_per_s", v.velocity_max_rad_per_s);
}

template <class A>
void walk(A& a, RigInfo& v) {
  a("name", v.name);
  a("id", v.id);
  a("version", v.version);
  a("rate_Hz", v.rate_Hz);
  a("adc_bits", v.adc_bits);
  a("v_range_V", v.v_range_V);
  a("force_max_N", v.force_max_N);
  a("reference_resolution_N", v.reference_resolution_N);
  a("reference_noise_N", v.reference_noise_N);
  a("reference_u_rel", v.reference_u_rel);
  a.optional("reference_u_time_s", v.reference_u_time_s);
  a("geometry", v.geometry);
  a("can_move", v.can_move);
  a("emulated", v.emulated);
  a("details", v.details);
}

template <class A>
void walk(A& a, StimulusFacts& v) {
  a("mean_N", v.mean_N);
  a("amplitude_N", v.amplitude_N);
  a("lowest_frequency_Hz", v.lowest_frequency_Hz);
  a("excitation_start_s", v.excitation_start_s);
  a("minimum_N", v.minimum_N);
  a("maximum_N", v.maximum_N);
  a("dynamic", v.dynamic);
}

template <class A>
void walk(A& a, ExtremaSeries& v) {
  a("name", v.name);
  a("t_s", v.t_s);
  a("expected_N", v.expected_N);
  a("actual_N", v.actual_N);
  a("raw_N", v.raw_N);
}

template <class A>
void walk(A& a, DecayFit& v) {
  a("valid", v.valid);
  a("a_V", v.a_V);
  a("b_per_s", v.b_per_s);
  a("c_V", v.c_V);
  a("u_min_V", v.u_min_V);
  a("u_a_V", v.u_a_V);
  a("u_b_per_s", v.u_b_per_s);
  a("u_c_V", v.u_c_V);
  a("rmse_V", v.rmse_V);
  a("loss_pct", v.loss_pct);
  a("n", v.n);
}

template <class A>
void walk(A& a, PlotTrace& v) {
  a("name", v.name);
  a("unit", v.unit);
  a("t_s", v.t_s);
  a("value", v.value);
}

template <class A>
void walk(A& a, CaseResult& v) {
  a("id", v.id);
  a("title", v.title);
  a("lane", v.lane);
  a("loop", v.loop);
  a("stimulus", v.stimulus);
  a("facts", v.facts);
  a("parameter_source", v.parameter_source);
  a("duration_s", v.duration_s);
  a("samples", v.samples);
  a("specimen", v.specimen);
  a("seed", v.seed);
  a("calibration", v.calibration);
  a("checks", v.checks);
  a("extrema", v.extrema);
  a("decay", v.decay);
  a("overview", v.overview);
  a("window", v.window);
  a("window_reason", v.window_reason);
  a("lag_s", v.lag_s);
  a("u_lag_s", v.u_lag_s);
  a("link", v.link);
  a("digest", v.digest);
  a("attempts", v.attempts);
  a("trace_file", v.trace_file);
  a("note", v.note);
}

template <class A>
void walk(A& a, RunResult& v) {
  a("format", v.format);
  a("tool_version", v.tool_version);
  a("command_line", v.command_line);
  a("started_at", v.started_at);
  a("plan_name", v.plan_name);
  a("plan_sha256", v.plan_sha256);
  a("seed", v.seed);
  a("firmware_path", v.firmware_path);
  a("firmware_sha256", v.firmware_sha256);
  a("firmware", v.firmware);
  a("rig", v.rig);
  a("decision_rule", v.decision_rule);
  a("decision", v.decision);
  a("checks", v.checks);
  a("cases", v.cases);
  a("environment", v.environment);
  a("notes", v.notes);
}

}  // namespace forcegate::result_fields
