#include "hil/characterize/laws.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "hil/base/portable_math.h"
#include "hil/gate/statistics.h"

namespace forcegate::characterize {
namespace {

constexpr int kGrid = 200;

struct Item {
  double f, A, a, b, ratio;
};

// c/a = 1/(1 + k A^2) by Newton on the sum of squares; a starting point from the mean of (a/c - 1)/A^2.
double fit_k(const std::vector<Item>& items) {
  double k = 0.0;
  for (const Item& i : items) k += (1.0 / i.ratio - 1.0) / (i.A * i.A) / static_cast<double>(items.size());
  for (int step = 0; step < 50; ++step) {
    double gradient = 0.0, curvature = 0.0;
    for (const Item& i : items) {
      const double d = 1.0 + k * i.A * i.A, slope = -i.A * i.A / (d * d);
      gradient += slope * (1.0 / d - i.ratio);
      curvature += slope * slope;
    }
    const double move = gradient / curvature;
    k = std::max(1e-3, k - move);
    if (std::abs(move) < 1e-12) break;
  }
  return k;
}

bool solve(const std::vector<Item>& items, Laws& out) {
  double s2 = 0, s3 = 0, s4 = 0, sa1 = 0, sa2 = 0, n = 0, sf = 0, sff = 0, sb = 0, sfb = 0;
  for (const Item& i : items) {
    const double A2 = i.A * i.A;
    s2 += A2, s3 += A2 * i.A, s4 += A2 * A2, sa1 += i.a * i.A, sa2 += i.a * A2;
    n += 1, sf += i.f, sff += i.f * i.f, sb += i.b, sfb += i.f * i.b;
  }
  const double det_a = s4 * s2 - s3 * s3, det_b = n * sff - sf * sf;
  if (items.size() < 3 || !(det_a > 1e-9 * s4 * s2) || !(det_b > 1e-9 * n * sff)) return false;
  out.a2_V_per_N2 = (sa2 * s2 - sa1 * s3) / det_a;
  out.a1_V_per_N = (sa1 * s4 - sa2 * s3) / det_a;
  out.b1_s_per_s = (n * sfb - sf * sb) / det_b;
  out.b0_per_s = (sb - out.b1_s_per_s * sf) / n;
  out.k_per_N2 = fit_k(items);
  return true;
}

}  // namespace

Result<Laws> fit_laws(std::span<const DecayRecord> records, std::span<const std::string> specimen) {
  std::map<std::string, std::vector<Item>> by_specimen;
  std::vector<Item> all;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const DecayRecord& r = records[i];
    if (!r.fitted || !(r.fit.a_V > 0.0) || !(r.fit.c_V > 0.0)) continue;
    const Item item{r.f_Hz, r.A_N, r.fit.a_V, r.fit.b_per_s, r.fit.c_V / r.fit.a_V};
    all.push_back(item);
    by_specimen[specimen[i]].push_back(item);
  }
  Laws laws;
  if (!solve(all, laws))
    return fail(ErrorCode::parse, "the records do not determine the laws (5)", {},
                "the series needs at least three decays, several amplitudes and several frequencies");
  laws.records = all.size();
  laws.specimens = by_specimen.size();
  const double g = static_cast<double>(by_specimen.size());
  if (by_specimen.size() < 3) return laws;
  double sums[5] = {}, squares[5] = {};
  for (const auto& [name, own] : by_specimen) {
    std::vector<Item> others;
    for (const auto& [other, items] : by_specimen)
      if (other != name) others.insert(others.end(), items.begin(), items.end());
    Laws without;
    if (!solve(others, without)) return laws;
    const double v[5] = {without.a2_V_per_N2, without.a1_V_per_N, without.b1_s_per_s, without.b0_per_s,
                         without.k_per_N2};
    for (int k = 0; k < 5; ++k) sums[k] += v[k], squares[k] += v[k] * v[k];
  }
  const auto se = [&](int k) {
    return std::sqrt(std::max(0.0, (g - 1.0) * (squares[k] / g - sums[k] * sums[k] / (g * g))));
  };
  laws.se_a2 = se(0), laws.se_a1 = se(1), laws.se_b1 = se(2), laws.se_b0 = se(3), laws.se_k = se(4);
  return laws;
}

LawErrors errors_of_laws(const Laws& laws, const DecayRecord& r, const Calibration& calibration) {
  const double a = laws.a_V(r.A_N), b = laws.b_per_s(r.f_Hz), c = a * laws.ratio(r.A_N);
  const double u_min_V = (r.m_N - r.A_N - calibration.offset_N) / calibration.gain_N_per_V;  // eq. (4)
  LawErrors e;
  e.a_pct = 100.0 * std::abs(a / r.fit.a_V - 1.0);
  e.b_pct = 100.0 * std::abs(b / r.fit.b_per_s - 1.0);
  e.c_pct = 100.0 * std::abs(c / r.fit.c_V - 1.0);
  for (int i = 0; i < kGrid; ++i) {
    const double t = r.duration_s * (i + 0.5) / kGrid;
    const double fitted = r.u_min_V + r.fit.a_V * portable::exp(-r.fit.b_per_s * t) + r.fit.c_V;
    const double model = u_min_V + a * portable::exp(-b * t) + c;
    e.mre_pct += 100.0 * std::abs(fitted - model) / fitted / kGrid;
  }
  return e;
}

LawStudy study_laws(std::span<const SessionSheet> sheets, const std::vector<std::string>& identification) {
  LawStudy out;
  const auto identifies = [&](const std::string& specimen) {
    return std::find(identification.begin(), identification.end(), specimen) != identification.end();
  };
  std::vector<DecayRecord> series;
  std::vector<std::string> owner, sets;
  for (const SessionSheet& s : sheets)
    for (const DecayRecord& r : s.decays) {
      if (std::find(sets.begin(), sets.end(), r.set) == sets.end()) sets.push_back(r.set);
      if (r.set == "series" && identifies(s.specimen)) series.push_back(r), owner.push_back(s.specimen);
    }
  const auto fitted = fit_laws(series, owner);
  if (!fitted) {
    out.why_not = fitted.error().text;
    return out;
  }
  out.fitted = *fitted;
  out.available = true;
  for (const std::string& set : sets)
    for (const bool own : {true, false}) {
      LawScore score;
      score.set = set;
      score.group = own ? "identification" : "validation";
      std::map<std::string, std::vector<LawErrors>> by_specimen;
      for (const SessionSheet& s : sheets) {
        if (identifies(s.specimen) != own) continue;
        for (const DecayRecord& r : s.decays) {
          if (r.set != set) continue;
          if (!r.fitted || !(r.fit.a_V > 0.0) || !(r.fit.c_V > 0.0)) {
            ++score.left_out;
            continue;
          }
          by_specimen[s.specimen].push_back(errors_of_laws(out.fitted, r, s.calibration));
          ++score.records;
        }
      }
      std::vector<double> a, b, c, mre;
      for (const auto& [name, errors] : by_specimen) {
        LawErrors mean;
        const double n = static_cast<double>(errors.size());
        for (const LawErrors& e : errors)
          mean.a_pct += e.a_pct / n, mean.b_pct += e.b_pct / n, mean.c_pct += e.c_pct / n,
              mean.mre_pct += e.mre_pct / n;
        a.push_back(mean.a_pct), b.push_back(mean.b_pct), c.push_back(mean.c_pct),
            mre.push_back(mean.mre_pct);
      }
      if (a.empty()) continue;
      score.specimens = a.size();
      score.mean = {moments(a).mean, moments(b).mean, moments(c).mean, moments(mre).mean};
      score.sd = {moments(a).sd, moments(b).sd, moments(c).sd, moments(mre).sd};
      out.scores.push_back(std::move(score));
    }
  return out;
}

}  // namespace forcegate::characterize
