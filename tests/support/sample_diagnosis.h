#pragma once
// A diagnosis as the engine would give it, made up with formulas: hysteresis found, creep suspected.

#include <cmath>

#include "hil/base/rng.h"
#include "hil/diagnose/diagnosis.h"

namespace forcegate::sample {

inline Diagnosis diagnosis() {
  using Answer = decltype(Diagnosis::verdict);
  Rng rng(5, "sample/diagnosis");
  const double pi = 3.14159265358979323846;
  Diagnosis d;
  d.campaign = "C07";
  d.model = "flexiforce 1";
  d.verdict = Answer::known;
  d.error_before = 0.0213;
  d.error_after = 0.0068;
  d.floor = 0.0049;
  d.expected_false = 0.02;
  d.force_range_N = 4.2;
  d.notes = {"No clock in C07_r03.csv: rate taken from campaign.json."};
  d.repeatability = {0.012, 0.004, 0.03, 0.02};

  Finding h;
  h.effect = "hysteresis";
  h.side = "sensor";
  h.probability = 0.97;
  h.form = "ten play operators";
  h.parameters = {{"loop width", 0.142, 0.006, "N"}, {"threshold", 0.31, 0.05, "N"}};
  h.error_before = 0.0213;
  h.error_after = 0.0068;
  h.effect_rms = 0.0198;
  h.records_improved = 9;
  h.records_excited = 9;
  h.evidence =
      "The output lags 30 mV behind while unloading, whatever the rate: the loop stays open on slow "
      "triangles.";
  h.confounded_with = {{"lag", 0.93, "triangles at three rates"},
                       {"backlash", 0.91, "reverse the wheel at constant force"}};
  EvidenceSeries loop{
      "C07_r05", "residual against force, coloured by direction", "force", "N", "V", {}, {}, {}, {}};
  for (int i = 0; i < 6000; ++i) {
    const double phase = 2.0 * pi * i / 500.0, F = 2.2 + 1.8 * std::sin(phase),
                 side = std::cos(phase) > 0 ? 1.0 : -1.0;
    loop.x.push_back(F);
    loop.colour.push_back(side);
    loop.before.push_back(-0.030 * side * (1.0 - std::pow((F - 2.2) / 1.8, 2)) + 0.004 * rng.normal());
    loop.after.push_back(0.004 * rng.normal());
  }
  EvidenceSeries hold{
      "C07_r02", "residual against time since the step", "time since change", "s", "V", {}, {}, {}, {}};
  for (int i = 0; i < 160; ++i) {
    hold.x.push_back(0.05 * std::pow(10.0, i / 40.0));
    hold.before.push_back(0.006 * std::log10(hold.x.back() / 0.05) + 0.001 * rng.normal());
    hold.after.push_back(0.001 * rng.normal());
  }
  EvidenceSeries spectrum{"C07_r05", "spectrum of the residual", "frequency", "Hz", "V", {}, {}, {}, {}};
  for (int i = 1; i < 400; ++i) {
    const double f = 0.25 * i;
    spectrum.x.push_back(f);
    spectrum.before.push_back(0.002 / (1 + f) + (i == 200 ? 0.003 : 0.0) + 1e-5 * (2 + rng.uniform()));
    spectrum.after.push_back(1e-5 * (2 + rng.uniform()) + (i == 200 ? 0.003 : 0.0));
  }
  h.series = {loop, hold, spectrum};
  Finding c;
  c.effect = "creep";
  c.side = "sensor";
  c.probability = 0.34;
  c.form = "two Prony terms";
  c.error_before = 0.0068;
  c.error_after = 0.0063;
  c.effect_rms = 0.002;
  c.evidence = "The residual drifts by 3 mV in a hold of 600 s, within the scatter of the records.";
  c.records_improved = 4;
  c.records_excited = 6;
  Finding lost;
  lost.effect = "dropouts";
  lost.side = "instrument";
  lost.probability = 0.95;
  lost.shown_in = ShownIn::samples;
  lost.form = "raw";
  lost.evidence = "0.4 % of the samples are held or zero where the force says otherwise";
  SampleWindow window{"C07_r05", "output", "V", "as the force says", {}, {}, {}, {}, {}};
  for (int i = 0; i < 160; ++i) {
    const double said = 2.2 + 1.8 * std::sin(0.05 * i);
    const bool held = i > 60 && i < 90;
    window.t_s.push_back(0.005 * i);
    window.beside.push_back(said);
    window.recorded.push_back(held ? 2.2 + 1.8 * std::sin(3.0) : said + 0.004 * rng.normal());
    if (held) window.named_t_s.push_back(window.t_s.back()), window.named.push_back(window.recorded.back());
  }
  lost.samples.push_back(std::move(window));
  d.findings = {h, c, lost};

  const char* names[] = {"hysteresis",          "lag",           "backlash", "creep", "thermal",
                         "static_nonlinearity", "slow_recovery", "rc"};
  for (int i = 0; i < 8; ++i) {
    RankedEffect r;
    r.effect = names[i];
    r.side = i == 2 ? "rig" : "sensor";
    r.score = 420.0 * std::pow(0.55, i) - 10.0;
    r.null_score = 6.0 + i;
    r.alone = 0.86 * std::pow(0.7, i);
    r.unique = i == 0 ? 0.71 : 0.02;
    r.probability = i == 0 ? 0.97 : 0.34 / (i * i + 1);
    if (i == 4) r.note = "needs temperature";
    d.ranking.push_back(r);
  }
  const struct {
    const char *name, *group, *unit, *sentence;
    double low, high, slope, share;
  } maps[] = {{"force while unloading", "history", "N", "+28 mV where force while unloading is about 2.2 N",
               0.4, 4.0, 0.028, 0.41},
              {"force while loading", "history", "N", "-27 mV where force while loading is about 2.1 N", 0.4,
               4.0, -0.027, 0.39},
              {"rate", "rate", "N/s", "-19 mV where rate is about 3.1 N/s", -4.0, 4.0, -0.02, 0.22},
              {"time since the last turn", "history", "log10 s",
               "-12 mV where time since the last turn is about 0.8 log10 s", 0.0, 2.8, 0.01, 0.12},
              {"temperature", "temperature", "degC", "no cell of temperature stands out of its scatter", 21.0,
               24.0, 0.001, -0.01},
              {"campaign time", "time", "s", "no cell of campaign time stands out of its scatter", 0.0,
               9000.0, 0.001, -0.02}};
  for (const auto& m : maps)
    for (const bool after : {false, true}) {
      ResidualMap map{
          m.name, m.group, m.unit, after ? 0.0 : m.share, {}, after ? "no cell stands out" : m.sentence};
      for (int i = 0; i < 16; ++i) {
        const double f = (i + 0.5) / 16.0,
                     shape = std::string(m.name).find("force") == 0 ? 4.0 * f * (1.0 - f) : 2.0 * f - 1.0;
        MapCell cell{m.low + f * (m.high - m.low),
                     (after ? 0.05 : 1.0) * m.slope * shape + 0.0008 * rng.normal(), 0.0009, 900,
                     i == 15 ? 1 : 11};
        map.cells.push_back(cell);
      }
      (after ? d.maps_after : d.maps).push_back(map);
    }
  const char* kinds[] = {"ramp",  "staircase", "sine", "sine", "multisine",
                         "sweep", "prbs",      "rest", "hold", "switch"};
  for (int i = 0; i < 10; ++i) {
    const double noise = 0.0045 + 0.0002 * i, before = i == 7 ? 0.0052 : 0.018 + 0.006 * rng.uniform();
    d.records.push_back({"C07_r0" + std::to_string(i), kinds[i], i % 3 == 0, before, noise * 1.2,
                         before * 1.4, noise * 1.6, noise, 1.0 - noise * noise / (before * before)});
    if (i > 1) continue;
    EvidenceSeries overlay{
        "C07_r0" + std::to_string(i), "measured and modelled", "time", "s", "V", {}, {}, {}, {}};
    for (int k = 0; k < 2000; ++k) {
      const double t = 0.03 * k, F = 2.2 - 1.8 * std::cos(0.5 * t);
      overlay.x.push_back(t);
      overlay.before.push_back(2.0 * F + 0.02 * std::sin(0.5 * t) + 0.004 * rng.normal());
      overlay.after.push_back(2.0 * F);
    }
    d.overlays.push_back(overlay);
  }
  ExperimentSegment s;
  s.name = "triangle at three rates";
  s.stimulus = "ramp";
  s.numbers = {{"A_N", 1.8}, {"rate_N_per_s", 0.05}};
  s.minutes = 6.5;
  s.separates = "hysteresis / lag";
  s.cosine_before = 0.93;
  s.cosine_after = 0.21;
  s.odds_before = 8.0;
  s.odds_after = 450.0;
  d.next_experiment = {{s}, 6.5, "Hysteresis keeps its loop when the triangle gets slower, a lag closes it."};
  return d;
}

}  // namespace forcegate::sample
