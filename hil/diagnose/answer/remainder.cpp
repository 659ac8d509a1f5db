#include "hil/diagnose/answer/remainder.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "hil/base/quantile.h"
#include "hil/diagnose/answer/before_changes.h"
#include "hil/diagnose/answer/coloured_noise.h"
#include "hil/diagnose/answer/unresolved_edges.h"
#include "hil/diagnose/raw/folded_hum.h"

namespace forcegate::diagnose {

namespace {

// Structure counts when it is visible beside the noise, large enough to matter, and not one record's whim.
bool is_structure(const Structure& s, double noise_rms) {
  return s.rms > 0.0015 && s.rms > 0.7 * noise_rms && s.share > 0.35 && s.records * 3 >= s.of_records &&
         s.records >= 2;
}

// What the model leaves more of than the instruments may.
struct AboveNoise {
  std::vector<RecordAbove> records;  // far above it, the farthest first
  bool all = false;  // all together, or the typical one, or several very far: records whose noise is large must not hide what the others show
};

AboveNoise far_above_noise(const ResidualChannel& channel, const std::vector<std::vector<double>>& residual) {
  constexpr double kFar = kFarAboveNoise, kVeryFar = 5.0;
  constexpr int kSeveral = 2;
  AboveNoise out;
  int very_far = 0;
  double left = 0.0, noise = 0.0, log_ratio = 0.0, records = 0.0;
  for (std::size_t i = 0; i < residual.size(); ++i) {
    if (residual[i].empty()) continue;
    const RecordGram& record = channel.problem.records[i];
    double square = 0.0;
    for (const double e : residual[i]) square += e * e;
    const double own = square / (static_cast<double>(residual[i].size()) * channel.scale * channel.scale),
                 allowed = record.allowed_variance + record.smoothed_variance;
    left += own;
    noise += allowed;
    log_ratio += std::log(std::max(1e-9, own / allowed));
    records += 1.0;
    if (own > kFar * kFar * allowed) out.records.push_back({channel.record_of[i], std::sqrt(own / allowed), std::sqrt(own)});
    very_far += own > kVeryFar * kVeryFar * allowed ? 1 : 0;
  }
  std::ranges::stable_sort(out.records, std::ranges::greater{}, &RecordAbove::times);
  out.all = !out.records.empty() && (very_far >= kSeveral || left > kFar * kFar * noise || log_ratio > records * std::log(kFar * kFar));
  return out;
}

// The rows that leave most: among spikes, where the force is fast, some are missed, and they are no structure.
void drop_rare(std::vector<std::vector<double>>& residual) {
  constexpr double kRare = 0.05;
  for (std::vector<double>& e : residual) {
    std::vector<double> size;
    for (const double v : e) size.push_back(std::abs(v));
    const double most = quantile(std::move(size), 1.0 - kRare);
    std::erase_if(e, [&](double v) { return std::abs(v) > most; });
  }
}

bool has_spikes(const Workspace& w) {
  return std::ranges::any_of(w.raw_claims, [](const HealthClaim& c) { return c.effect == "outliers"; });
}

}  // namespace

Structure structure_of(const ResidualChannel& channel, const std::vector<std::vector<double>>& residual) {
  Structure out;
  double sum = 0.0, total = 0.0;
  for (std::size_t k = 0; k < residual.size(); ++k) {
    if (residual[k].size() < 100) continue;
    ++out.of_records;
    double square = 0.0;
    for (double e : residual[k]) square += e * e;
    square /= static_cast<double>(residual[k].size());
    const RecordGram& record = channel.problem.records[k];
    const double scale2 = channel.scale * channel.scale, noise2 = (record.allowed_variance + record.smoothed_variance) * scale2;
    // neighbours in time that agree, or more than the noise can make
    const double smooth = std::max(0.0, autocorrelated_share({residual[k]}, 5)) * square;
    const double excess = std::max(0.0, square - 1.3 * noise2);
    const double structure = std::min(std::max(smooth, 0.7 * excess), excess);
    sum += structure / scale2;
    total += square / scale2;
    if (structure > 0.3 * noise2 && std::sqrt(structure / scale2) > 5e-4) ++out.records;
  }
  if (out.of_records == 0) return out;
  out.rms = std::sqrt(sum / static_cast<double>(out.of_records));
  out.share = total > 0.0 ? sum / total : 0.0;
  return out;
}

Remainder remainder_of(const Workspace& w, const Selection& selection, unsigned threads) {
  constexpr double kNearlyAll = 0.8;
  constexpr double kLarge = 0.01;  // how a swept record decays differs from law to law by some tenths of a per cent
  constexpr double kPlainly = 6.0, kNotSmall = 0.003;  // times the noise: a decay with a course of its own leaves less; of the span
  Remainder out;
  out.noise_rms = allowed_rms(w.output);
  out.explained = selection.excess_before > 0.0 ? 1.0 - selection.excess_after / selection.excess_before : 1.0;
  const auto residual = residual_rows(w.output, selection.final);
  out.of_hum = records_of_folded_hum(w, w.output);
  const auto learnable = [&](const std::vector<std::vector<double>>& e) {
    std::vector<std::vector<double>> kept = without_unresolved_edges(w.input, w.output, e);
    for (std::size_t k = 0; k < kept.size(); ++k)
      if (out.of_hum[k] != 0) kept[k].clear();
    if (has_spikes(w)) drop_rare(kept);
    return kept;
  };
  const auto resolved = learnable(residual);
  const auto above_noise = [&](const std::vector<std::vector<double>>& e) {
    return far_above_noise(w.output, learnable(before_changes_of_frequency(w.input, w.output, e)));
  };
  const Structure left = structure_of(w.output, resolved);
  out.structure_rms = left.rms;
  out.smooth = is_structure(left, out.noise_rms);
  out.maps = residual_maps(w, residual, threads);
  out.coloured = is_coloured_noise(w.input, w.output, residual, out.maps);
  out.of_claimed = residual_rows(w.output, selection.claimed);
  if (!out.coloured) {
    AboveNoise above = above_noise(residual);
    out.records_far_above = std::move(above.records);
    out.far_above = above.all;
    if (!w.input.single && !out.records_far_above.empty()) {
      const RecordAbove& farthest = out.records_far_above.front();
      out.one_far_off = (above.all && farthest.rms > kLarge) || (farthest.times > kPlainly && farthest.rms > kNotSmall);
    }
  }
  const bool far_beside_claims = !out.coloured && above_noise(out.of_claimed).all;
  out.beside_claims = (out.structured() && out.explained < kNearlyAll) || far_beside_claims;
  return out;
}

bool follows_force(const ResidualChannel& output, const MixedFit& fit) {
  constexpr double kLeast = 0.1;
  constexpr Eigen::Index kZero = 1;  // column of Z
  const MixedProblem& p = output.problem;
  double left = 0.0, square = 0.0, mean = 0.0;
  for (std::size_t k = 0; k < p.records.size(); ++k) {
    left += fit.adapted[k];
    square += p.records[k].gram(p.y_index(), p.y_index());
    mean += p.records[k].gram(kZero, p.y_index());
  }
  const auto n = static_cast<double>(p.records.size());
  const double variance = square - mean * mean / n;
  return left <= (1.0 - kLeast) * variance || !(variance > 0.0);
}

std::vector<std::string> depends_on(const std::vector<ResidualMap>& maps) {
  // whatever moves the output and nothing else stands in the output too, and a little of it goes with the value there
  constexpr double kLeastShare = 0.04, kOfItself = 0.2;
  std::vector<std::string> out;
  double top = 0.0;
  for (const ResidualMap& map : maps)
    if (map.coordinate != "output") top = std::max(top, map.share);
  const bool is_alone = top < kLeastShare;
  if (!maps.empty()) top = std::max(top, maps.front().share);
  for (const ResidualMap& map : maps) {
    if (map.coordinate == "output" && is_alone && map.share < kOfItself) continue;
    if (map.share < std::max(kLeastShare, 0.35 * top)) break;
    if (std::find(out.begin(), out.end(), map.group) == out.end()) out.push_back(map.group);
    if (out.size() == 3) break;
  }
  if (out.empty()) out.push_back("time");
  return out;
}

}  // namespace forcegate::diagnose
