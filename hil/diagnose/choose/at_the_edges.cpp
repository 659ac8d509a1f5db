#include "hil/diagnose/choose/at_the_edges.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/base/parallel.h"
#include "hil/base/rng.h"
#include "hil/diagnose/choose/refine.h"
#include "hil/model/rows.h"
#include "hil/model/states.h"

namespace forcegate::diagnose {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kSamplesOfOne = 5.0;  // neighbours hang together, as rows do

bool shifts(const EffectKind& kind) { return kind.traits.timing && kind.traits.shift == TimeShift::first_shape; }

// A record whose rows are the samples of its edges; those of the windows are wanted.
RecordInput at_samples(const RecordInput& of, const Edges& edges, std::vector<double> F_N) {
  RecordInput out;
  out.index = of.index;
  out.recording = of.recording;
  out.dynamic = of.dynamic;
  out.onset_s = of.onset_s;
  out.f_Hz = of.f_Hz;
  out.A_N = of.A_N;
  out.F_min_N = of.F_min_N;
  out.duration_s = of.duration_s;
  out.t_s = out.fast_t_s = edges.t_s;
  out.F_N = out.fast_F_N = std::move(F_N);
  out.ok.assign(out.t_s.size(), 1);
  for (std::size_t k = 0; k <= out.t_s.size(); ++k) out.row_begin.push_back(static_cast<std::uint32_t>(k));
  for (const std::uint32_t sample : edges.sample) {
    const auto row = std::ranges::upper_bound(of.row_begin, sample) - of.row_begin.begin() - 1;
    out.decay.push_back(of.decay[std::min(static_cast<std::size_t>(std::max<std::ptrdiff_t>(row, 0)), of.decay.size() - 1)]);
  }
  for (const Edges::Window& window : edges.windows)
    for (std::size_t k = window.begin; k < window.end; ++k) out.wanted.push_back(static_cast<std::uint32_t>(k));
  set_rates(out);
  return out;
}

// Rows of the windows, each window about its own mean.
MatrixXd about_window_means(const MatrixXd& all, const Edges& edges) {
  Index rows = 0;
  for (const Edges::Window& w : edges.windows) rows += static_cast<Index>(w.end - w.begin);
  MatrixXd out(rows, all.cols());
  Index at = 0;
  for (const Edges::Window& w : edges.windows) {
    const auto length = static_cast<Index>(w.end - w.begin);
    const auto block = all.middleRows(static_cast<Index>(w.begin), length);
    out.middleRows(at, length) = block.rowwise() - block.colwise().mean();
    at += length;
  }
  return out;
}

struct Sums {
  MatrixXd signal, noise;  // (1 + columns + 1)^2 of base, columns and output; (1 + columns)^2 of what the reference's noise makes of them
};

/// What a form leaves of all windows, V^2: as it is, less what the noise of the reference leaves, and as it is at any strength.
struct Left {
  double as_it_is = std::numeric_limits<double>::infinity(), less_noise = as_it_is, at_any_strength = as_it_is;
};

class EdgesOfRecords {
 public:
  /// Of records whose samples are close enough for a shift by `shift_s`: how the force ran between two of them nobody saw, and what a straight line
  /// there leaves of a shift by less than half a step is as large as that by which a lag and a delay differ.
  EdgesOfRecords(const Workspace& w, double shift_s, unsigned threads) : w_(w), threads_(threads) {
    constexpr double kOfStep = 0.5;
    Rng noise(1, "noise of the reference at the edges");
    for (std::size_t k = 0; k < w.edges.size(); ++k) {
      const Edges& edges = w.edges[k];
      if (edges.empty() || !(shift_s > kOfStep * edges.step_s)) continue;
      edges_.push_back(&edges);
      clean_.push_back(at_samples(w.input.records[k], edges, edges.F_N));
      std::vector<double> noisy = edges.F_N;
      for (double& F : noisy) F += noise.normal(0.0, edges.noise_F_N);
      noisy_.push_back(at_samples(w.input.records[k], edges, std::move(noisy)));
      for (const Edges::Window& window : edges.windows) samples_ += static_cast<double>(window.end - window.begin);
    }
  }

  double samples() const { return samples_; }

  Left left_by(const EffectForm& form, const std::vector<double>& shape) const {
    std::vector<Sums> sums(edges_.size());
    parallel_for(edges_.size(), threads_, [&](std::size_t k) { sums[k] = sums_of(k, form, shape); });
    return fit(sums, form);
  }

 private:
  MatrixXd base_and_columns(const RecordInput& r, const EffectForm& form, const std::vector<double>& shape) const {
    const auto columns = static_cast<Index>(form.strength.size());
    MatrixXd room = MatrixXd::Zero(static_cast<Index>(r.rows()), columns), out(room.rows(), 1 + columns);
    form.columns(w_.input, r, shape, room);
    for (std::size_t i = 0; i < r.rows(); ++i) out(static_cast<Index>(i), 0) = r.decay[i] * r.F_N[i];
    out.rightCols(columns) = room;
    return out;
  }

  Sums sums_of(std::size_t k, const EffectForm& form, const std::vector<double>& shape) const {
    const Edges& edges = *edges_[k];
    const MatrixXd X = base_and_columns(clean_[k], form, shape);
    MatrixXd all(X.rows(), X.cols() + 1);
    all << X, Eigen::Map<const VectorXd>(edges.U_V.data(), X.rows());
    const MatrixXd of_signal = about_window_means(all, edges), of_noise = about_window_means(base_and_columns(noisy_[k], form, shape) - X, edges);
    return {of_signal.transpose() * of_signal, of_noise.transpose() * of_noise};
  }

  // Slopes of the records' own, strengths of all: least squares, the slopes eliminated. Strengths that are another effect in disguise are brought
  // back to what the form may have, the slopes after them.
  static Left fit(const std::vector<Sums>& sums, const EffectForm& form) {
    const auto n = static_cast<Index>(form.strength.size());
    MatrixXd P = MatrixXd::Zero(n, n);
    VectorXd q = VectorXd::Zero(n);
    for (const Sums& s : sums) {
      const auto cross = s.signal.row(0).segment(1, n);
      const double base = s.signal(0, 0);
      if (!(base > 0.0)) return {};
      P += s.signal.block(1, 1, n, n) - cross.transpose() * cross / base;
      q += s.signal.col(n + 1).segment(1, n) - cross.transpose() * s.signal(0, n + 1) / base;
    }
    P.diagonal().array() *= 1.0 + 1e-9;
    const Eigen::LDLT<MatrixXd> of_P(P);
    VectorXd c = of_P.solve(q);
    if (!c.allFinite()) return {};
    const auto slope = [&](const Sums& s) { return (s.signal(0, n + 1) - s.signal.row(0).segment(1, n).dot(c)) / s.signal(0, 0); };
    double mean = 0.0;
    for (const Sums& s : sums) mean += slope(s) / static_cast<double>(sums.size());
    const auto left = [&] {
      double out = 0.0;
      for (const Sums& s : sums) {
        VectorXd x(n + 2);
        x << slope(s), c, -1.0;
        out += x.dot(s.signal * x);
      }
      return out;
    };
    Left out;
    out.at_any_strength = left();
    const double share = c.sum() / mean, allowed = std::clamp(share, std::max(form.least, 0.0), form.most);
    if (!std::isfinite(share) || share <= 0.0) return out;
    c *= allowed / share;
    out.as_it_is = out.less_noise = left();
    for (const Sums& s : sums) {
      VectorXd x(n + 1);
      x << slope(s), c;
      out.less_noise -= x.dot(s.noise * x);
    }
    return out;
  }

  const Workspace& w_;
  unsigned threads_;
  std::vector<const Edges*> edges_;
  std::vector<RecordInput> clean_, noisy_;
  double samples_ = 0.0;
};

// What no form of the library is, and a lag all the same: the more poles share it, the nearer to a delay it comes.
EffectForm chain_of(int poles, const EffectKind& lag) {
  EffectForm out = *find_form(lag, "two_poles");
  out.columns = [poles](const CampaignInput&, const RecordInput& r, std::span<const double> shape, ColumnsRef column) {
    std::vector<double> x = r.fast_F_N;
    for (int pole = 0; pole < poles; ++pole) {
      LowPass film(shape[0] / poles, x.front());
      double before = x.front();
      for (std::size_t k = 1; k < x.size(); ++k) {
        const double now = x[k];
        x[k] = film.step(before, now, r.fast_t_s[k] - r.fast_t_s[k - 1]);
        before = now;
      }
    }
    for (std::size_t k = 0; k < x.size(); ++k) column(static_cast<Eigen::Index>(k), 0) = r.decay[k] * (x[k] - r.fast_F_N[k]);
  };
  return out;
}

std::vector<EffectForm> forms_of(const EffectKind& kind) {
  std::vector<EffectForm> out;
  for (const EffectForm& form : kind.forms)
    if (form.competes() && !form.bank && form.beside.empty()) out.push_back(form);
  // a delay of a part of the signal beside the rest is a lag of two steps
  if (kind.traits.known_form)
    for (EffectForm& form : out) form.least = form.most = 1.0;
  if (kind.name == "lag")
    for (const int poles : {3, 4}) out.push_back(chain_of(poles, kind));
  return out;
}

// Of all forms of a family that stand alone, at the best shape; each of the two measures at a shape of its own.
Left least_left(const EdgesOfRecords& edges, const CampaignInput& campaign, const EffectKind& kind) {
  Left out;
  const auto see = [&](const Left& left) {
    out.as_it_is = std::min(out.as_it_is, left.as_it_is);
    out.less_noise = std::min(out.less_noise, left.less_noise);
    out.at_any_strength = std::min(out.at_any_strength, left.at_any_strength);
  };
  for (const EffectForm& form : forms_of(kind)) {
    std::vector<double> best;
    Left least;
    for (const std::vector<double>& shape : form.grid(campaign)) {
      const Left left = edges.left_by(form, shape);
      see(left);
      if (left.less_noise < least.less_noise) least = left, best = shape;
    }
    if (!best.empty() && form.refine)
      climb(form, best, [&](const std::vector<double>& shape) {
        const Left left = edges.left_by(form, shape);
        see(left);
        return std::isfinite(left.less_noise) ? -left.less_noise : -1e300;
      });
  }
  return out;
}

std::vector<const EffectKind*> rivals_of(const ChosenEffect& chosen) {
  constexpr double kCompetes = 0.002;  // share of the place: a search sees hardly anything of an edge
  if (!shifts(*chosen.kind)) return {};
  std::vector<const EffectKind*> out = {chosen.kind};
  for (const auto& [name, share] : chosen.rivals)
    if (const EffectKind* kind = EffectRegistry::instance().find(name); kind != nullptr && shifts(*kind) && share > kCompetes) out.push_back(kind);
  return out;
}

}  // namespace

std::vector<std::string> beaten_at_the_edges(const Workspace& w, const Selection& selection, const SelectionRules& rules, unsigned threads) {
  constexpr double kNats = 12.0;
  if (rules.forms_are_rough || std::ranges::any_of(w.output.candidates, &Candidate::of_model)) return {};
  for (const ChosenEffect& chosen : selection.chosen) {
    const std::vector<const EffectKind*> kinds = rivals_of(chosen);
    if (kinds.size() < 2) continue;
    const EdgesOfRecords edges(w, candidate_of(w.output, chosen.variant).shape.front(), threads);
    if (!(edges.samples() > 0.0)) continue;
    std::vector<Left> left;
    for (const EffectKind* kind : kinds) left.push_back(least_left(edges, w.input, *kind));
    const auto best = std::ranges::min_element(left, {}, &Left::less_noise);
    if (!(best->as_it_is > 0.0) || !std::isfinite(best->as_it_is)) continue;
    const double nat = 2.0 * kSamplesOfOne * best->as_it_is / edges.samples();  // V^2
    // where none of them describes the edges, which one comes nearest says nothing
    const double any = std::ranges::min_element(left, {}, &Left::at_any_strength)->at_any_strength;
    if (best->as_it_is - any > kNats * nat) continue;
    std::vector<std::string> out;
    for (std::size_t k = 0; k < kinds.size(); ++k)
      if (std::min(left[k].less_noise - best->less_noise, left[k].as_it_is - best->as_it_is) > kNats * nat) out.push_back(kinds[k]->name);
    if (!out.empty()) return out;
  }
  return {};
}

}  // namespace forcegate::diagnose
