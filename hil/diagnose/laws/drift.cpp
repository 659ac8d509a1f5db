#include "hil/diagnose/laws/drift.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/base/quantile.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kParts = 10;
double of_record(double record_s) { return record_s / 1000.0; }

constexpr std::array<DriftLaw, 5> kLaws{{
    {.name = "constant",
     .course = [](double, double) { return 0.0; },
     .primitive = [](double, double) { return 0.0; },
     .shape_low = nullptr,
     .shape_high = nullptr,
     .shape_name = nullptr,
     .shape_unit = nullptr,
     .per = "",
     .sentence = [](const DriftFit&, const std::string&, const std::string&) { return std::string("the output stays"); }},
    {.name = "line",
     .course = [](double s, double) { return s; },
     .primitive = [](double s, double) { return 0.5 * s * s; },
     .shape_low = nullptr,
     .shape_high = nullptr,
     .shape_name = nullptr,
     .shape_unit = nullptr,
     .per = "/s",
     .sentence = [](const DriftFit& f, const std::string& from, const std::string& unit) {
       return fmt::format("the output moves steadily{} by {:.3g} {}/s", from, f.size, unit);
     }},
    {.name = "exponential",
     .course = [](double s, double tau) { return -std::expm1(-(s / tau)); },
     .primitive = [](double s, double tau) { return s + tau * std::expm1(-(s / tau)); },
     .shape_low = of_record,
     .shape_high = [](double record_s) { return record_s * 10.0; },
     .shape_name = "tau_s",
     .shape_unit = "s",
     .per = "",
     .sentence = [](const DriftFit& f, const std::string& from, const std::string& unit) {
       return fmt::format("the output moves exponentially{} towards {:.4g} {} with one time constant of {:.3g} s", from, f.constant + f.size, unit, f.shape);
     }},
    {.name = "logarithm",
     .course = [](double s, double t1) { return std::log10(1.0 + s / t1); },
     .primitive = [](double s, double t1) {
       const double z = s / t1;
       return t1 * ((1.0 + z) * std::log1p(z) - z) / std::log(10.0);
     },
     .shape_low = of_record,
     // one that does not cover a decade of time within the record is no creep but any curve
     .shape_high = [](double record_s) { return record_s / 10.0; },
     .shape_name = "t1_s",
     .shape_unit = "s",
     .per = "",
     .sentence = [](const DriftFit& f, const std::string& from, const std::string& unit) {
       return fmt::format("the output creeps with the logarithm of time{}, {:.3g} {} a decade", from, f.size, unit);
     }},
    {.name = "power",
     .course = [](double s, double p) { return std::pow(s, p); },
     .primitive = [](double s, double p) { return std::pow(s, p + 1.0) / (p + 1.0); },
     .shape_low = [](double) { return 0.02; },
     .shape_high = [](double) { return 0.9; },
     .shape_name = "exponent",
     .shape_unit = "1",
     .per = "",
     .sentence = [](const DriftFit& f, const std::string& from, const std::string&) {
       return fmt::format("the output creeps as a power of time{}, exponent {:.2g}", from, f.shape);
     }},
}};

double course(const DriftFit& fit, double since_s) { return fit.law->course(std::max(0.0, since_s), fit.shape); }

// From the onset; before it the course stands.
double integral(const DriftFit& fit, double since_s) {
  return since_s <= 0.0 ? since_s * course(fit, 0.0) : fit.law->primitive(since_s, fit.shape);
}

// A law is averaged over a block as the output is: the beginning of creep is over before the first block ends.
double law_of_block(const DriftBlocks& b, std::size_t i, const DriftFit& fit) {
  const double begin_s = b.begin_s[i] - fit.onset_s, end_s = b.end_s[i] - fit.onset_s;
  if (!(end_s > begin_s)) return course(fit, begin_s);
  return (integral(fit, end_s) - integral(fit, begin_s)) / (end_s - begin_s);
}

// Least squares of c + a law(t) on the blocks that are kept; returns the squared error on all kept blocks.
double solve(const DriftBlocks& b, const std::vector<char>& kept, DriftFit& fit) {
  std::vector<double> x(b.y.size());
  double n = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, syy = 0.0;
  for (std::size_t i = 0; i < b.y.size(); ++i) {
    if (!kept[i]) continue;
    x[i] = law_of_block(b, i, fit);
    n += 1.0, sx += x[i], sy += b.y[i];
  }
  const double mx = sx / n, my = sy / n;
  for (std::size_t i = 0; i < b.y.size(); ++i) {
    if (!kept[i]) continue;
    const double dx = x[i] - mx, dy = b.y[i] - my;
    sxx += dx * dx, sxy += dx * dy, syy += dy * dy;
  }
  fit.size = sxx > 1e-300 ? sxy / sxx : 0.0;
  fit.constant = my - fit.size * mx;
  return std::max(0.0, syy - fit.size * sxy);
}

// Golden section in log(shape) around the best of a log grid, for each onset of a grid that is then refined.
DriftFit best_fit(const DriftBlocks& b, const std::vector<char>& kept, const DriftLaw& law) {
  const double length = b.length_s();
  DriftFit best;
  best.law = &law;
  best.shape = 1.0;
  double error = solve(b, kept, best);
  if (&law == &kLaws.front()) return best;
  if (law.shape_low != nullptr) error = 1e300;  // 1 may be beyond its bounds
  const auto shape_error = [&](double onset_s, double shape, DriftFit& fit) {
    fit.law = &law, fit.onset_s = onset_s, fit.shape = shape;
    return solve(b, kept, fit);
  };
  const auto best_shape = [&](double onset_s, DriftFit& out) {
    if (law.shape_low == nullptr) return shape_error(onset_s, 1.0, out);
    const double low = law.shape_low(length), high = law.shape_high(length);
    constexpr int kGrid = 16;
    double least = 1e300;
    int at = 0;
    for (int k = 0; k <= kGrid; ++k) {
      DriftFit fit;
      const double e = shape_error(onset_s, low * std::pow(high / low, k / static_cast<double>(kGrid)), fit);
      if (e < least) least = e, at = k;
    }
    double left = std::max(0, at - 1) / static_cast<double>(kGrid),
           right = std::min(kGrid, at + 1) / static_cast<double>(kGrid);
    const auto value = [&](double u, DriftFit& fit) {
      return shape_error(onset_s, low * std::pow(high / low, u), fit);
    };
    for (int step = 0; step < 14; ++step) {
      const double a = left + 0.382 * (right - left), c = left + 0.618 * (right - left);
      DriftFit fa, fc;
      if (value(a, fa) < value(c, fc))
        right = c;
      else
        left = a;
    }
    return value(0.5 * (left + right), out);
  };
  const auto try_onset = [&](double onset_s) {
    DriftFit fit;
    const double e = best_shape(onset_s, fit);
    if (e < error) error = e, best = fit;
  };
  double step = length / 24.0;
  try_onset(0.0);
  const DriftFit at_once = best;
  const double at_once_error = error;
  for (int k = 1; k < 12; ++k) try_onset(k * step);
  for (int round = 0; round < 4; ++round) {
    step /= 3.0;
    const double centre = best.onset_s;
    for (int k = -2; k <= 2; ++k)
      if (k != 0 && centre + k * step >= 0.0) try_onset(centre + k * step);
  }
  // a later onset must earn its freedom: nothing holds it where the beginning of the record is left out
  return at_once_error < 1.2 * error ? at_once : best;
}

double rms_over(const DriftBlocks& b, const DriftFit& fit, const std::vector<char>& use) {
  double sum = 0.0, n = 0.0;
  for (std::size_t i = 0; i < b.y.size(); ++i) {
    if (!use[i]) continue;
    const double e = b.y[i] - fit.constant - fit.size * law_of_block(b, i, fit);
    sum += e * e;
    n += 1.0;
  }
  return std::sqrt(sum / std::max(1.0, n));
}

// Standard error out of the values with each part left out (Efron and Tibshirani 1993, eq. 11.5).
double jackknife(const std::vector<double>& left_out) {
  const double n = static_cast<double>(left_out.size());
  double mean = 0.0, square = 0.0;
  for (const double v : left_out) mean += v / n;
  for (const double v : left_out) square += (v - mean) * (v - mean);
  return std::sqrt((n - 1.0) / n * square);
}

}  // namespace

const std::array<DriftLaw, 5>& drift_laws() { return kLaws; }

double value_at(const DriftFit& fit, double t_s) { return fit.constant + fit.size * course(fit, t_s - fit.onset_s); }

DriftBlocks drift_blocks(const std::vector<double>& t_s, const std::vector<double>& y) {
  std::vector<std::size_t> good;
  for (std::size_t i = 0; i < y.size(); ++i)
    if (std::isfinite(y[i])) good.push_back(i);
  DriftBlocks out;
  const std::size_t n = std::min(kDriftBlocks, good.size());
  for (std::size_t b = 0; b < n; ++b) {
    const std::size_t from = b * good.size() / n, to = (b + 1) * good.size() / n;
    double t = 0.0, sum = 0.0;
    for (std::size_t k = from; k < to; ++k) t += t_s[good[k]] - t_s[good.front()], sum += y[good[k]];
    const double first_s = t_s[good[from]] - t_s[good.front()], last_s = t_s[good[to - 1]] - t_s[good.front()];
    const double half_step_s = to - from > 1 ? 0.5 * (last_s - first_s) / static_cast<double>(to - from - 1) : 0.0;
    out.begin_s.push_back(first_s - half_step_s), out.end_s.push_back(last_s + half_step_s);
    out.t_s.push_back(t / static_cast<double>(to - from));
    out.y.push_back(sum / static_cast<double>(to - from));
  }
  return out;
}

Result<RecordDrift> fit_drift(const std::string& record, const std::vector<double>& t_s,
                              const std::vector<double>& y) {
  const DriftBlocks b = drift_blocks(t_s, y);
  if (b.y.size() < 40)
    return fail(ErrorCode::parse, "the record has only " + std::to_string(b.y.size()) + (b.y.size() == 1 ? " sample" : " samples"), record,
                "at least 40 are needed to tell one law of drift from another, and 200 of a recording with a force that is diagnosed alone");
  RecordDrift out;
  out.record = record;
  out.span = quantile(b.y, 0.999) - quantile(b.y, 0.001);
  out.noise = movement_of(b.y).noise;
  const std::vector<char> all(b.y.size(), 1);
  for (const DriftLaw& law : kLaws) {
    DriftFit fit = best_fit(b, all, law);
    fit.rms = rms_over(b, fit, all);
    double sum = 0.0;
    std::vector<double> sizes, shapes, onsets_s;
    for (std::size_t part = 0; part < kParts; ++part) {
      std::vector<char> kept(b.y.size(), 1), left(b.y.size(), 0);
      for (std::size_t i = part * b.y.size() / kParts; i < (part + 1) * b.y.size() / kParts; ++i)
        kept[i] = 0, left[i] = 1;
      const DriftFit without = best_fit(b, kept, law);
      sizes.push_back(without.size);
      shapes.push_back(without.shape);
      onsets_s.push_back(without.onset_s);
      const double rms = rms_over(b, without, left);
      sum += rms * rms;
    }
    fit.u_size = jackknife(sizes);
    fit.u_shape = jackknife(shapes);
    fit.u_onset_s = jackknife(onsets_s);
    fit.left_out_rms = std::sqrt(sum / kParts);
    out.fits.push_back(fit);
  }
  std::stable_sort(out.fits.begin(), out.fits.end(),
                   [](const DriftFit& a, const DriftFit& c) { return a.left_out_rms < c.left_out_rms; });
  return out;
}

}  // namespace forcegate::diagnose
