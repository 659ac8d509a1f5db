#pragma once
// A run as the gate would give it, made up with formulas: for tests of everything that renders a result.

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "hil/base/rng.h"
#include "hil/interface/run_result.h"

namespace forcegate::sample {

enum class Variant { accept, reject, no_decision, rig_fault };

inline Check check(std::string id, std::string case_id, std::string title, double value, std::string unit,
                   double u, std::uint64_t n, Limit limit, Verdict verdict, std::string evidence) {
  return {std::move(id),
          std::move(case_id),
          std::move(title),
          value,
          std::move(unit),
          u,
          2.0 * u,
          n,
          std::move(limit),
          verdict,
          verdict == Verdict::fail ? Blame::firmware : Blame::none,
          true,
          std::move(evidence)};
}

struct CaseSpec {
  std::string id, loop, stimulus;
  double f_Hz, amplitude_N, mean_N;
  double error_gain;  ///< 0.02: maxima 2 % too low
  double loss;        ///< share that the raw sensor loses
  std::uint64_t seed;
};

/// One record of `duration_s` at 1 kHz: ATI with 0.025 N steps, firmware that compensates all but error_gain.
inline CaseResult make_case(const CaseSpec& s, double duration_s = 1200.0, double window_rate_Hz = 1000.0) {
  CaseResult c;
  c.id = s.id;
  c.title = "Sine " + std::to_string(s.f_Hz).substr(0, 4) + " Hz, " +
            (s.loop == "closed" ? "force control" : "open loop");
  c.lane = "block";
  c.loop = s.loop;
  c.stimulus = s.stimulus;
  c.facts = {s.mean_N, s.amplitude_N, s.f_Hz, 5.0, s.mean_N - s.amplitude_N, s.mean_N + s.amplitude_N, true};
  c.parameter_source = "Lebosse 2011, Table II";
  c.duration_s = duration_s;
  c.samples = static_cast<std::uint64_t>(duration_s * 1000.0);
  c.specimen = "q50";
  c.seed = s.seed;
  c.calibration.gain_N_per_V = 0.4871;
  c.calibration.offset_N = 0.0123;
  c.calibration.b_scale = 1.07;
  c.calibration.q_scale = 0.94;
  c.calibration.level = CalibrationLevel::identified;
  c.calibration.id = "q50-identified";
  c.digest = std::string(48, 'a') + "0123456789abcdef";
  c.lag_s = 0.0042;
  c.u_lag_s = 0.0003;
  c.link.samples = c.samples;
  c.window_reason = "worst maximum";

  Rng rng(s.seed, "sample/" + s.id);
  const double b = 0.0019 * s.f_Hz + 0.0056, pi = 3.14159265358979323846;
  const auto setpoint = [&](double t) { return s.mean_N - s.amplitude_N * std::cos(2.0 * pi * s.f_Hz * t); };
  const auto raw_ratio = [&](double t) { return 1.0 - s.loss * (1.0 - std::exp(-b * t)); };
  const double low = s.mean_N - s.amplitude_N;
  const auto raw = [&](double t) { return low + (setpoint(t) - low) * raw_ratio(t); };
  const auto ati = [&](double t) { return std::round((setpoint(t) + 0.008 * rng.normal()) / 0.025) * 0.025; };
  const auto firmware = [&](double t) {
    return low + (setpoint(t) - low) * (1.0 - s.error_gain * (1.0 - std::exp(-3.0 * b * t))) +
           0.004 * rng.normal();
  };
  const auto traces = [&](double from, double to, double rate) {
    std::vector<PlotTrace> out{
        {"set-point", "N", {}, {}}, {"ATI", "N", {}, {}}, {"firmware", "N", {}, {}}, {"raw", "N", {}, {}}};
    for (long i = 0; i <= std::lround((to - from) * rate); ++i) {
      const double t = from + static_cast<double>(i) / rate;
      const double values[] = {setpoint(t), ati(t), firmware(t), raw(t)};
      for (std::size_t k = 0; k < 4; ++k) {
        out[k].t_s.push_back(static_cast<float>(t));
        out[k].value.push_back(static_cast<float>(values[k]));
      }
    }
    return out;
  };
  const double window = std::min(5.0 / s.f_Hz, duration_s);
  c.window = traces(duration_s - window, duration_s, std::min(window_rate_Hz, 10000.0 / window));
  c.overview = traces(0.0, duration_s, std::min(1.0, 1200.0 / duration_s) * 3.37);
  ExtremaSeries maxima{"maxima", {}, {}, {}, {}}, minima{"minima", {}, {}, {}, {}};
  for (double t = 20.0; t < duration_s; t += 1.0 / s.f_Hz) {
    for (ExtremaSeries* e : {&maxima, &minima}) {
      const double at = t + (e == &maxima ? 0.5 : 1.0) / s.f_Hz;
      if (at > duration_s) continue;
      e->t_s.push_back(static_cast<float>(at));
      e->expected_N.push_back(static_cast<float>(ati(at)));
      e->actual_N.push_back(static_cast<float>(firmware(at)));
      e->raw_N.push_back(static_cast<float>(raw(at) + 0.004 * rng.normal()));
    }
  }
  c.extrema = {maxima, minima};
  const double volt = 1.0 / c.calibration.gain_N_per_V;
  c.decay = {true,
             2.0 * s.amplitude_N * s.loss * volt,
             b,
             2.0 * s.amplitude_N * (1.0 - s.loss) * volt,
             (low - c.calibration.offset_N) * volt,
             0.012,
             0.00021,
             0.004,
             0.009,
             100.0 * s.loss * (1.0 - std::exp(-b * duration_s)),
             maxima.t_s.size()};
  return c;
}

inline RunResult run(Variant variant, double duration_s = 1200.0) {
  RunResult r;
  r.tool_version = "0.1.0";
  r.command_line = "forcegate gate reference-m4f.block.elf --plan nightly --seed 7";
  r.started_at = "2026-01-02T03:04:05Z";
  r.plan_name = "nightly";
  r.plan_sha256 = "4f" + std::string(62, '2');
  r.seed = 7;
  r.firmware_path = variant == Variant::reject ? "compensation_off-m4f.block.elf" : "reference-m4f.block.elf";
  r.firmware_sha256 = "9c1e" + std::string(60, '7');
  r.firmware = {1,        0,  "mps2-an386", "3fe1c0ffee3fe1c0ffee3fe1c0ffee3fe1c0ffee", "lebosse-eq7/1",
                0xC0FFEE, 16, 1000.0};
  r.rig.name = "emulated";
  r.rig.id = "seed:7";
  r.rig.version = "1";
  r.rig.emulated = r.rig.can_move = true;
  r.rig.reference_noise_N = 0.008;
  r.rig.reference_u_rel = 0.002;
  r.rig.geometry.eccentricity_mm = 8.4;
  r.rig.geometry.preload_mm = 4.4;
  r.rig.details = {{"ati", "Nano17 twin, calibration 2026-01"}, {"motor", "velocity drive twin"}};
  r.decision_rule = "value + U <= limit passes, value - U > limit rejects (Holm, 1 %), U = 2 u";
  r.environment = {{"compiler", "GCC 12.2.0"}, {"qemu", "qemu-system-arm 7.2"}};
  r.notes = {"Calibration level identified: b and q = c/a come from an earlier record of each specimen."};

  const bool bad = variant == Variant::reject;
  const double gain = bad ? 0.31 : 0.021;
  const Limit maxima{Limit::Kind::upper, 4.5, "Lebosse 2011, IV-B2"},
      minima{Limit::Kind::upper, 7.5, "Lebosse 2011, IV-B2"};
  const Limit derived{Limit::Kind::upper, 5.2, "derived: p99 of n=300, 2026-01-02, rig emulated/1"};
  const Limit lsb{Limit::Kind::upper, 0.5, "declared algorithm, eq. (7)"},
      none_lost{Limit::Kind::equal, 0.0, "link protocol"};
  const double frequencies[] = {0.1, 0.5, 1.0};
  for (int k = 0; k < 3; ++k) {
    const double f = frequencies[k];
    CaseResult c =
        make_case({"sine_" + std::to_string(f).substr(0, 4) + "Hz_1.5N/q50", k == 1 ? "closed" : "open",
                   "sine f_Hz=" + std::to_string(f).substr(0, 3) + " A_N=1.05 m_N=2.15", f, 1.05, 2.15,
                   gain * (0.8 + 0.3 * k), 0.62, 40u + static_cast<unsigned>(k)},
                  duration_s);
    const double mre = bad ? 22.0 + 5.0 * k : 1.9 + 0.8 * k;
    c.checks = {check("coverage", c.id, "Samples that arrived", static_cast<double>(c.samples), "1", 0.0,
                      c.samples, {Limit::Kind::equal, static_cast<double>(c.samples), "plan"}, Verdict::pass,
                      "All samples arrived in order."),
                check("conformance", c.id, "Largest departure from the declared algorithm",
                      bad ? 912.0 : 0.31, "LSB", 0.0, c.samples, lsb, bad ? Verdict::fail : Verdict::pass,
                      bad ? "The image leaves eq. (7) as soon as cycling begins."
                          : "The image computes what it declares."),
                check("mre_maxima", c.id, "Mean relative error of the maxima, firmware against ATI", mre, "%",
                      0.21 + 0.04 * k, 590, derived, bad ? Verdict::fail : Verdict::pass,
                      bad ? "The maxima fall with the raw sensor: no compensation is seen."
                          : "The maxima stay where the ATI has them."),
                check("mre_minima", c.id, "Mean relative error of the minima, firmware against ATI",
                      1.2 + 0.1 * k, "%", 0.3, 590, derived, Verdict::pass, "The minima hold."),
                check("frames_lost", c.id, "Frames lost on the link", 0.0, "1", 0.0, 18750, none_lost,
                      Verdict::pass, "")};
    r.cases.push_back(std::move(c));
  }
  r.checks = {check("panel_mre_maxima", "", "Panel mean, relative error of the maxima, ATI against set-point",
                    bad ? 27.31 : 2.94, "%", 0.32, 9, maxima, bad ? Verdict::fail : Verdict::pass,
                    bad ? "All nine specimens are outside."
                        : "All nine specimens are inside; the paper's one lies at the 81st percentile."),
              check("panel_mre_minima", "", "Panel mean, relative error of the minima, ATI against set-point",
                    2.05, "%", 0.41, 9, minima, Verdict::pass, ""),
              check("self_check_spring", "", "Spring witness against ATI", 0.8, "%", 0.2, 3,
                    {Limit::Kind::upper, 2.0, "rig emulated/1"}, Verdict::pass, "The rig is sound.")};
  switch (variant) {
    case Variant::accept:
      r.cases[2].checks[2].value = 5.02;
      r.cases[2].checks[2].verdict = Verdict::marginal;
      r.decision = {
          DecisionKind::accept, Blame::none,
          "all 18 required checks passed; nearest: mre_maxima in sine_1.00Hz_1.5N/q50 at 0.97 of its limit",
          false, 0};
      break;
    case Variant::reject:
      r.decision = {DecisionKind::reject, Blame::firmware,
                    "maxima: panel mean 27.3(3) %, limit 4.5 % (Lebosse 2011, IV-B2)", false, 1};
      break;
    case Variant::no_decision:
      r.cases[1].checks[2] =
          check("mre_maxima", r.cases[1].id, r.cases[1].checks[2].title, 5.11, "%", 0.22, 31, derived,
                Verdict::inconclusive, "31 cycles are too few to tell 5.1 % from 5.2 %.");
      r.cases[2].checks[1].verdict = Verdict::not_run;
      r.cases[2].checks[1].value = std::numeric_limits<double>::quiet_NaN();
      r.cases[2].checks[1].required = false;
      r.cases[2].checks[1].evidence = "The image declares an algorithm that is not known here.";
      r.decision = {DecisionKind::no_decision, Blame::user,
                    "mre_maxima in sine_0.50Hz_1.5N/q50 is inconclusive after the cap of 2 repeats", false,
                    3};
      break;
    case Variant::rig_fault:
      for (Check& c : r.cases[0].checks) {
        c.verdict = Verdict::rig_error;
        c.blame = Blame::reference;
        c.value = std::numeric_limits<double>::quiet_NaN();
        c.u = std::numeric_limits<double>::quiet_NaN();
        c.evidence = "The ATI reported overload in 812 of 1 200 000 samples.";
      }
      r.cases[0].note = "ATI overload from 311.204 s on";
      r.cases[0].window.clear();
      r.cases[0].overview.clear();
      r.cases[0].extrema.clear();
      r.cases[0].decay = {};
      r.checks[2].verdict = Verdict::rig_error;
      r.checks[2].value = 7.4;
      r.checks[2].blame = Blame::reference;
      r.decision = {
          DecisionKind::no_decision, Blame::reference,
          "the ATI reports overload while the spring witness sees 2.1 N: the reference must be looked at",
          false, 4};
      break;
  }
  return r;
}

/// The variant with texts as a hostile firmware or file would send them in every field that comes from
/// outside.
inline RunResult hostile() {
  RunResult r = run(Variant::reject, 60.0);
  const std::string evil =
      std::string("<script>alert(1)</script>\"'&]]>|`@all\x01\x1b[31m\xff\xC2\x85::error::\n%0A");
  r.firmware.board = r.firmware.build_id = r.firmware.algorithm_id = evil;
  r.firmware_path = r.plan_name = r.command_line = r.decision.reason = evil;
  r.rig.details["serial" + evil] = evil;
  r.environment["x" + evil] = evil;
  r.notes.push_back(evil);
  r.cases[0].id = r.cases[0].title = r.cases[0].stimulus = r.cases[0].note = r.cases[0].specimen = evil;
  r.cases[0].window_reason = r.cases[0].trace_file = evil;
  for (Check& c : r.cases[0].checks) c.id = c.title = c.unit = c.evidence = c.limit.source = evil;
  return r;
}

}  // namespace forcegate::sample
