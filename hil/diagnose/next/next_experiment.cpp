#include "hil/diagnose/next/next_experiment.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/next/rival_odds.h"

namespace forcegate::diagnose {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kMostRivals = 4;
const double kSettled = std::log(1000.0), kOpen = std::log(50.0), kNearly = std::log(2.0);
const double kWorthPlaying = std::log(1.2);

struct Segment {
  const char* name;
  const char* stimulus;
  double minutes;
  bool dynamic;
  std::map<std::string, double> numbers;
  double (*force)(double t, double low, double high);  ///< N
  double temperature_C;  ///< ramp over the segment, when the rig can heat
};

double triangle(double t, double period, double low, double high) {
  const double phase = std::fmod(t / period, 1.0);
  return low + (high - low) * (phase < 0.5 ? 2.0 * phase : 2.0 - 2.0 * phase);
}
double sine(double t, double f, double low, double high) {
  return 0.5 * (low + high) - 0.5 * (high - low) * std::cos(2.0 * std::numbers::pi * f * t);
}
double edge(double t, double at, double from, double to) { return t < at ? from : to + (from - to) * std::exp(-(t - at) / 0.02); }

// Twenty pieces of rig time; each holds the base law down in its own way.
const std::vector<Segment>& segments() {
  static const std::vector<Segment> kSegments = {
      {"rest", "rest", 2.0, false, {}, [](double, double lo, double) { return lo; }, 0.0},
      {"hold for 10 s", "step", 0.5, false, {{"hold_s", 10}}, [](double t, double lo, double hi) { return t > 10 && t < 20 ? hi : lo; }, 0.0},
      {"hold for 100 s, then unload", "step", 4.0, false, {{"hold_s", 100}}, [](double t, double lo, double hi) { return t > 10 && t < 110 ? hi : lo; }, 0.0},
      {"hold for 10 min, then unload", "step", 16.0, false, {{"hold_s", 600}}, [](double t, double lo, double hi) { return t > 10 && t < 610 ? hi : lo; }, 0.0},
      {"holds at two levels", "staircase", 8.0, false, {{"hold_s", 120}}, [](double t, double lo, double hi) { return t < 120 ? lo : t < 240 ? 0.5 * (lo + hi) : t < 360 ? hi : lo; }, 0.0},
      {"slow triangle", "ramp", 4.0, false, {{"period_s", 120}}, [](double t, double lo, double hi) { return triangle(t, 120.0, lo, hi); }, 0.0},
      {"triangle", "ramp", 1.0, false, {{"period_s", 12}}, [](double t, double lo, double hi) { return triangle(t, 12.0, lo, hi); }, 0.0},
      {"fast triangle", "ramp", 0.5, false, {{"period_s", 1.2}}, [](double t, double lo, double hi) { return triangle(t, 1.2, lo, hi); }, 0.0},
      {"triangles at two speeds", "ramp", 3.0, false, {{"period_s", 120}, {"second_period_s", 6}}, [](double t, double lo, double hi) { return t < 120 ? triangle(t, 120.0, lo, hi) : triangle(t - 120, 6.0, lo, hi); }, 0.0},
      {"shrinking minor loops", "staircase", 3.0, false, {{"loops", 8}}, [](double t, double lo, double hi) { const double k = 1.0 - std::min(0.9, std::floor(t / 20.0) * 0.11), m = 0.5 * (lo + hi); return triangle(t, 20.0, m - 0.5 * k * (hi - lo), m + 0.5 * k * (hi - lo)); }, 0.0},
      {"chirp", "chirp", 2.0, false, {{"f_start_Hz", 0.05}, {"f_end_Hz", 5}}, [](double t, double lo, double hi) { return sine(1.0, 0.05 * 120.0 / std::log(100.0) * (std::pow(100.0, t / 120.0) - 1.0), lo, hi); }, 0.0},
      {"sines at 0.2 and 4 Hz", "multisine", 2.0, false, {{"f1_Hz", 0.2}, {"f2_Hz", 4}}, [](double t, double lo, double hi) { return sine(t, t < 60 ? 0.2 : 4.0, lo, hi); }, 0.0},
      {"fast edges", "step", 0.5, false, {{"edge_ms", 20}}, [](double t, double lo, double hi) { const double p = std::fmod(t, 4.0); return p < 2.0 ? edge(p, 0.5, lo, hi) : edge(p, 2.5, hi, lo); }, 0.0},
      {"fast edges at low and high load", "step", 1.0, false, {{"edge_ms", 20}}, [](double t, double lo, double hi) { const double p = std::fmod(t, 4.0), m = t < 30 ? lo : hi - 0.25 * (hi - lo), h = m + 0.25 * (hi - lo); return p < 2.0 ? edge(p, 0.5, m, h) : edge(p, 2.5, h, m); }, 0.0},
      {"fast edges at both ends of a long hold", "step", 16.0, false, {{"hold_s", 900}}, [](double t, double lo, double hi) { const double p = std::fmod(t, 4.0); return t < 30 || t > 930 ? (p < 2.0 ? edge(p, 0.5, lo, hi) : edge(p, 2.5, hi, lo)) : lo; }, 0.0},
      {"touch and release", "ramp", 1.0, false, {{"F_top_N", 0.5}}, [](double t, double lo, double hi) { (void)lo; return std::max(0.0, triangle(t, 15.0, -0.05 * hi, 0.12 * hi)); }, 0.0},
      {"small sine near zero", "sine", 1.0, false, {{"f_Hz", 0.5}}, [](double t, double lo, double hi) { return sine(t, 0.5, lo, lo + 0.15 * (hi - lo)); }, 0.0},
      {"heat at constant load", "rest", 15.0, false, {{"ramp_C", 10}}, [](double, double lo, double hi) { return 0.5 * (lo + hi); }, 10.0},
      {"repeat of the first ramp", "ramp", 2.0, false, {{"period_s", 60}}, [](double t, double lo, double hi) { return triangle(t, 60.0, lo, hi); }, 0.0},
      {"sine, then a jump of frequency", "jump", 6.0, true, {{"f1_Hz", 0.5}, {"f2_Hz", 2}}, [](double t, double lo, double hi) { return sine(t, t < 180 ? 0.5 : 2.0, lo, hi); }, 0.0},
  };
  return kSegments;
}

RecordInput simulate(const Workspace& w, const Segment& s) {
  RecordInput r;
  r.name = s.name;
  const double low = w.input.lowest_N + 0.05 * w.input.range_N, high = w.input.lowest_N + 0.95 * w.input.range_N;
  const double fast = 0.005;
  const auto per_row = std::max(4, static_cast<int>(std::ceil(60.0 * s.minutes / fast / 6000.0)));
  const auto n_rows = static_cast<std::size_t>(60.0 * s.minutes / fast / per_row);
  r.row_step_s = fast * per_row;
  r.duration_s = 60.0 * s.minutes;
  r.dynamic = s.dynamic;
  for (std::size_t i = 0; i <= n_rows; ++i) r.row_begin.push_back(static_cast<std::uint32_t>(i * static_cast<std::size_t>(per_row)));
  for (std::size_t i = 0; i < n_rows; ++i) {
    double F = 0.0, t = 0.0;
    for (int k = 0; k < per_row; ++k) {
      const double at = fast * static_cast<double>(i * static_cast<std::size_t>(per_row) + static_cast<std::size_t>(k));
      r.fast_t_s.push_back(at);
      r.fast_F_N.push_back(s.force(at, low, high));
      F += r.fast_F_N.back();
      t += at;
    }
    r.F_N.push_back(F / per_row);
    r.t_s.push_back(t / per_row);
  }
  r.U_V = r.F_N;
  for (double& u : r.U_V) u *= w.gain_V_per_N;
  r.ok.assign(n_rows, 1);
  r.rate_N_per_s.assign(n_rows, 0.0);
  r.travel_N.assign(n_rows, 0.0);
  for (std::size_t i = 1; i < n_rows; ++i) {
    r.rate_N_per_s[i] = (r.F_N[i] - r.F_N[i - 1]) / r.row_step_s;
    r.travel_N[i] = r.travel_N[i - 1] + std::abs(r.F_N[i] - r.F_N[i - 1]);
  }
  const RecordInput& last = w.input.records.back();
  r.index = r.recording = w.input.records.size();
  r.start_s = last.start_s + last.duration_s + 600.0;
  r.travel_before_N = w.input.travel_total_N;
  r.drive_mean_V = last.drive_mean_V;
  if (w.input.has_temp) {
    const double T = last.temp_C.empty() ? 23.0 : last.temp_C.back();
    for (std::size_t i = 0; i < n_rows; ++i)
      r.temp_C.push_back(T + s.temperature_C * static_cast<double>(i) / static_cast<double>(n_rows));
  }
  if (w.input.has_theta)
    for (std::size_t i = 0; i < n_rows; ++i) {
      r.theta_rad.push_back((r.rate_N_per_s[i] < 0.0 ? -1.0 : 1.0) *
                            std::acos(std::clamp(1.0 - 2.0 * (r.F_N[i] - low) / std::max(1e-9, high - low), -1.0, 1.0)));
      r.sin_theta.push_back(std::sin(r.theta_rad.back()));
      r.cos_theta.push_back(std::cos(r.theta_rad.back()));
    }
  r.F_min_N = s.dynamic ? low : 0.0;
  r.f_Hz = s.dynamic ? 0.5 : 0.0;
  r.A_N = 0.5 * (high - low);
  set_decay(r, w.law);
  return r;
}

// Squared length of a that b and the base cannot imitate, in units of the noise.
struct Pair {
  double aa = 0.0, ab = 0.0, bb = 0.0;
  void add(const Pair& o) {
    aa += o.aa;
    ab += o.ab;
    bb += o.bb;
  }
  double cosine() const { return aa > 0.0 && bb > 0.0 ? ab / std::sqrt(aa * bb) : 1.0; }
  double separation() const { return aa - (bb > 0.0 ? ab * ab / bb : 0.0); }
};

Pair project(const VectorXd& a, const VectorXd& b, const RecordInput& r, double noise) {
  MatrixXd X(a.size(), 2);
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    X(i, 0) = r.base_force_N(static_cast<std::size_t>(i));
    X(i, 1) = 1.0;
  }
  MatrixXd G = X.transpose() * X;
  G.diagonal().array() += 1e-9 * G.trace();
  const Eigen::LDLT<MatrixXd> solve(G);
  const VectorXd pa = a - X * solve.solve(X.transpose() * a), pb = b - X * solve.solve(X.transpose() * b);
  // a segment counts for its seconds, not for its rows
  const double weight = std::min(kMostSamples, r.duration_s) / static_cast<double>(a.size()) / (noise * noise);
  return {pa.squaredNorm() * weight, pa.dot(pb) * weight, pb.squaredNorm() * weight};
}

struct Rival {
  const EffectKind* kind;
  const EffectForm* form;
  std::vector<double> shape;
  VectorXd strength;
};

VectorXd signature(const Workspace& w, const RecordInput& r, const Rival& rival) {
  MatrixXd columns = MatrixXd::Zero(static_cast<Eigen::Index>(r.rows()), static_cast<Eigen::Index>(rival.form->strength.size()));
  rival.form->columns(w.input, r, rival.shape, columns);
  return columns * rival.strength;
}

// Findings that the diagnosis could not part, each group in the order of the findings.
std::vector<std::string> sharing_a_place(const Workspace& w, const Diagnosis& d) {
  std::vector<std::string> out;
  for (const Finding& f : d.findings) {
    const EffectKind* kind = kind_of(w, f.effect);
    if (kind == nullptr || kind->channel != EffectChannel::output || out.size() == kMostRivals) continue;
    if (std::any_of(d.findings.begin(), d.findings.end(), [&](const Finding& o) { return compete_for_one_place(d, f.effect, o.effect); }))
      out.push_back(f.effect);
  }
  return out;
}

bool is_named(const Diagnosis& d, const std::string& effect) {
  return std::any_of(d.findings.begin(), d.findings.end(), [&](const Finding& f) { return f.effect == effect; });
}

// Two effects that the answer names neither of are no question of it. What stands among the findings for other reasons is a rival only where the evidence leaves the two open as well.
std::optional<RivalOdds> odds_now(const Diagnosis& d, const Rival& a, const Rival& b) {
  const std::string &first = a.kind->name, &second = b.kind->name;
  if (!is_named(d, first) && !is_named(d, second)) return std::nullopt;
  const std::optional<RivalOdds> now = rival_odds(d, first, second);
  if (!now || !now->stated || compete_for_one_place(d, first, second)) return now;
  return std::abs(evidence_between(d, first, second)) <= kSettled ? now : std::nullopt;
}

NextExperiment best_segments(const Workspace& w, const Diagnosis& d) {
  NextExperiment out;
  if (w.output.problem.records.empty()) return out;
  // rivals: those that share a place among the findings, and the best of the ranking that these data leave open, at least two
  std::vector<Rival> rivals;
  std::vector<std::string> open = sharing_a_place(w, d);
  const double top = d.ranking.empty() ? 0.0 : d.ranking.front().score;
  for (const RankedEffect& r : d.ranking) {
    const EffectKind* kind = kind_of(w, r.effect);
    if (kind == nullptr || kind->channel != EffectChannel::output || !r.note.empty()) continue;
    if (std::find(open.begin(), open.end(), r.effect) != open.end()) continue;
    if (open.size() < 2 || (open.size() < kMostRivals && r.score > 0.6 * top && r.score > 3.0)) open.push_back(r.effect);
  }
  const ScreenResult screened = screen(w.output, {}, {}, nullptr, 1);
  for (const std::string& name : open)
    for (const FamilyScore& family : screened.families) {
      if (family.kind->name != name) continue;
      const Variant& v = w.output.variants[static_cast<std::size_t>(family.best.variant)];
      const Candidate& c = w.output.candidates[static_cast<std::size_t>(v.candidate)];
      Rival rival{c.kind, c.form, c.shape, VectorXd::Zero(c.count)};
      for (std::size_t b = 0; b < v.columns.size(); ++b)
        rival.strength[v.columns[b] - c.first] = family.best.fit.coefficient[w.output.problem.n_fixed + static_cast<Eigen::Index>(b)];
      rivals.push_back(std::move(rival));
    }
  if (rivals.size() < 2) return out;

  double noise = 0.0;
  for (double v : w.noise_V) noise += v * v;
  noise = std::sqrt(noise / static_cast<double>(w.noise_V.size())) / std::max(1e-9, std::abs(w.gain_V_per_N));
  const std::size_t n_pairs = rivals.size() * (rivals.size() - 1) / 2;
  std::vector<std::vector<Pair>> of_segment;
  for (const Segment& s : segments()) {
    const RecordInput r = simulate(w, s);
    std::vector<VectorXd> sign;
    for (const Rival& rival : rivals) sign.push_back(signature(w, r, rival));
    std::vector<Pair> pairs;
    for (std::size_t a = 0; a < rivals.size(); ++a)
      for (std::size_t b = a + 1; b < rivals.size(); ++b) pairs.push_back(project(sign[a], sign[b], r, noise));
    of_segment.push_back(std::move(pairs));
  }
  std::vector<Pair> have(n_pairs);
  std::vector<char> used(of_segment.size(), 0);
  std::size_t pair_of[2] = {0, 1};
  for (int step = 0; step < 4; ++step) {
    // the pair that is least separated by what is known and planned; of those nearly so, the one that the findings name first
    std::size_t worst = 0, index = 0;
    double least = 1e300;
    for (std::size_t a = 0; a < rivals.size(); ++a)
      for (std::size_t b = a + 1; b < rivals.size(); ++b, ++index) {
        const std::optional<RivalOdds> now = odds_now(d, rivals[a], rivals[b]);
        if (!now) continue;
        const double known = std::abs(now->log_odds) + 0.5 * have[index].separation();
        if (known < least - kNearly) {
          least = known;
          worst = index;
          pair_of[0] = a;
          pair_of[1] = b;
        }
      }
    if (least > kOpen) break;
    std::size_t best = of_segment.size();
    double rate = 0.0;
    for (std::size_t s = 0; s < of_segment.size(); ++s) {
      if (used[s] != 0) continue;
      Pair with = have[worst];
      with.add(of_segment[s][worst]);
      // beyond odds of a thousand more evidence is worth nothing
      const double added = 0.5 * (with.separation() - have[worst].separation());
      const double gain = std::min(least + added, kSettled) - least;
      if (gain < kWorthPlaying) continue;
      const double per_minute = gain / (segments()[s].minutes + 0.5);
      if (per_minute > rate) {
        rate = per_minute;
        best = s;
      }
    }
    if (best == of_segment.size()) break;
    used[best] = 1;
    const Segment& s = segments()[best];
    ExperimentSegment chosen;
    chosen.name = s.name;
    chosen.stimulus = s.stimulus;
    chosen.numbers = s.numbers;
    chosen.minutes = s.minutes;
    chosen.separates = rivals[pair_of[0]].kind->name + " / " + rivals[pair_of[1]].kind->name;
    chosen.cosine_before = step == 0 || have[worst].aa == 0.0 ? 1.0 : have[worst].cosine();
    const RivalOdds now = *odds_now(d, rivals[pair_of[0]], rivals[pair_of[1]]);
    chosen.odds_stated = now.stated;
    chosen.odds_before = std::exp(std::min(20.0, least));
    for (std::size_t p = 0; p < n_pairs; ++p) have[p].add(of_segment[best][p]);
    chosen.cosine_after = have[worst].cosine();
    chosen.odds_after = std::exp(std::min(20.0, std::abs(now.log_odds) + 0.5 * have[worst].separation()));
    const RecordInput played = simulate(w, s);
    chosen.t_s = played.fast_t_s;
    chosen.force_N = played.fast_F_N;
    chosen.heats = s.temperature_C != 0.0;
    out.minutes += s.minutes;
    out.segments.push_back(std::move(chosen));
  }
  if (!out.segments.empty()) {
    const ExperimentSegment& s = out.segments.front();
    out.sentence = fmt::format("{} ({:.2g} min) separates {}: odds {} to 1 now{}, {} to 1 expected", s.name, s.minutes, s.separates,
                               odds_text(s.odds_before), s.odds_stated ? "" : " by the evidence", odds_text(s.odds_after));
  }
  return out;
}

}  // namespace

NextExperiment propose_experiment(const Workspace& w, const Diagnosis& d) {
  NextExperiment out = best_segments(w, d);
  if (!out.segments.empty() || d.not_separable.empty()) return out;
  const std::vector<std::string>& rivals = d.not_separable.front();
  out.sentence = "none of the short segments that a rig can play parts " + join(rivals, " or ");
  if (const EffectKind* kind = kind_of(w, rivals.front())) out.sentence += "; what would: " + kind->separates;
  return out;
}

}  // namespace forcegate::diagnose
