#include "hil/diagnose/raw/mains_line.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "hil/base/quantile.h"
#include "hil/diagnose/raw/line_peak.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kMostSegments = 12, kBlock = 256;
constexpr double kSegment_s = 4.0, kShortest_s = 2.0, kFewestSegments = 3.0;
// Slower rates than 16 Hz would make these samples longer than 8 s, and the grid of a quarter of a hertz too coarse for them.
constexpr std::size_t kFewestSamples = 128;
constexpr double kSlowest_Hz = 16.0;
// Noise alone puts the largest of three powers some two times above the median beside them: beyond four the force has a line of its own,
// and the output must have three times as much.
constexpr double kOfNoise = 4.0, kOfForce = 3.0;

// The same sample of every segment, side by side: their sums do not wait for each other.
using Side = std::array<double, kMostSegments>;

// Sums at one frequency over all segments, of the output and of the force as the output shows it.
struct Spectrum {
  explicit Spectrum(double angle) : phase(angle) {}
  void add(std::span<const Side> U, std::span<const Side> F) {
    for (std::size_t i = 0; i < U.size(); ++i) {
      for (std::size_t k = 0; k < kMostSegments; ++k) {
        re[k] += U[i][k] * phase.re;
        im[k] += U[i][k] * phase.im;
        force_re[k] += F[i][k] * phase.re;
        force_im[k] += F[i][k] * phase.im;
      }
      phase.step();
    }
  }
  double of_output(std::size_t k) const { return re[k] * re[k] + im[k] * im[k]; }
  double of_force(std::size_t k) const { return force_re[k] * force_re[k] + force_im[k] * force_im[k]; }
  double of_difference(std::size_t k) const {
    const double x = re[k] - force_re[k], y = im[k] - force_im[k];
    return x * x + y * y;
  }
  Rotation phase;
  Side re{}, im{}, force_re{}, force_im{};
};

struct Line {
  double mains_Hz, harmonic, frequency_Hz;  // of the first harmonic before, of the line itself after the sampling
  double halves;  // at half the rate the two halves of a line fall on each other
  std::vector<Spectrum> at, beside;
};

// A gap takes time and no samples: the line would be looked for beside its place.
double rate_between_gaps(const std::vector<double>& t) {
  const double mean = (t.back() - t.front()) / static_cast<double>(t.size() - 1);
  double time = 0.0, steps = 0.0;
  for (std::size_t i = 1; i < t.size(); ++i) {
    const double step = t[i] - t[i - 1];
    if (!(step < 1.6 * mean)) continue;
    time += step;
    steps += 1.0;
  }
  return time > 0.0 ? steps / time : 1.0 / mean;
}

// Samples that a short gap left out, put in on a straight line: without them the line's phase would jump there, and its parts cancel.
// False where there are none.
bool fill_short_gaps(const std::vector<double>& t, double rate_Hz, const std::vector<double>& F, const std::vector<double>& U, std::vector<double>& whole_F,
                     std::vector<double>& whole_U) {
  constexpr double kLongest_s = 0.25, kLeastSteps = 1.6;
  const auto missing = [&](std::size_t i) -> std::size_t {
    const double steps = (t[i] - t[i - 1]) * rate_Hz;
    return steps > kLeastSteps && steps < kLongest_s * rate_Hz ? static_cast<std::size_t>(std::lround(steps)) - 1 : 0;
  };
  std::size_t all = 0;
  for (std::size_t i = 1; i < t.size(); ++i) all += missing(i);
  if (all == 0 || all > t.size()) return false;
  whole_F.reserve(t.size() + all);
  whole_U.reserve(t.size() + all);
  for (std::size_t i = 0; i < t.size(); ++i) {
    const std::size_t between = i > 0 ? missing(i) : 0;
    for (std::size_t k = 1; k <= between; ++k) {
      const double x = static_cast<double>(k) / static_cast<double>(between + 1);
      whole_F.push_back(F[i - 1] + x * (F[i] - F[i - 1]));
      whole_U.push_back(U[i - 1] + x * (U[i] - U[i - 1]));
    }
    whole_F.push_back(F[i]);
    whole_U.push_back(U[i]);
  }
  return true;
}

// Those that can be told from the slow force and have neighbours to be compared with.
std::vector<Line> mains_lines(double rate_Hz) {
  std::vector<Line> out;
  for (const auto& [mains_Hz, harmonic] : {std::pair{50.0, 1.0}, {60.0, 1.0}, {50.0, 3.0}, {60.0, 3.0}, {100.0, 1.0}, {120.0, 1.0}}) {
    Line line{mains_Hz, harmonic, folded_Hz(harmonic * mains_Hz, rate_Hz), 2.0, {}, {}};
    const double f = line.frequency_Hz;
    if (f < kSlowestLine_Hz) continue;
    if (0.5 * rate_Hz - f < 0.5) line.halves = 1.0;
    const auto beside = [&](double by_Hz) {
      return Spectrum(2.0 * std::numbers::pi * (f + by_Hz) / rate_Hz);
    };
    for (const double by_Hz : {-0.25, 0.0, 0.25}) line.at.push_back(beside(by_Hz));
    for (const double by_Hz : {-3.0, -2.25, -1.5, 1.5, 2.25, 3.0})
      if (f + by_Hz > 1.0 && f + by_Hz < 0.5 * rate_Hz) line.beside.push_back(beside(by_Hz));
    if (line.beside.size() >= 2) out.push_back(std::move(line));
  }
  return out;
}

struct Powers {
  double at, beside;  // the largest at the line, the median beside it
};

Powers powers_of(const Line& line, double (Spectrum::*power)(std::size_t) const, std::size_t segment) {
  double at = 0.0;
  for (const Spectrum& s : line.at) at = std::max(at, (s.*power)(segment));
  std::vector<double> beside;
  for (const Spectrum& s : line.beside) beside.push_back((s.*power)(segment));
  return {at, quantile(beside, 0.5)};
}

// Grids keep to a twentieth of a hertz and the clocks of loggers to a thousandth.
constexpr double kOfMains = 0.002;

// The line itself, measured; nothing where it is not at the mains' own frequency, or a harmonic of something else's.
std::optional<double> measured_Hz(const Seen& seen, const Line& line, double rate_Hz) {
  const LinePeak peak = peak_beside(seen, line.frequency_Hz, rate_Hz);
  if (std::abs(peak.off_Hz) > kOfMains * line.harmonic * line.mains_Hz + peak.resolution_Hz) return std::nullopt;
  const double measured = line.frequency_Hz + peak.off_Hz, f_Hz = std::min(measured, rate_Hz - measured);
  if (is_harmonic_of_another(seen, f_Hz, line.mains_Hz, rate_Hz) || is_of_load(seen, f_Hz, rate_Hz)) return std::nullopt;
  return f_Hz;
}

// Segments of one length, spread over the samples.
struct Segments {
  std::size_t length = 0;
  std::vector<std::size_t> from;
};

// None where the samples are too few or too slow. A short record has shorter segments rather than fewer.
Segments segments_of(std::size_t n, double rate_Hz) {
  const double segment_s = std::clamp(static_cast<double>(n) / rate_Hz / kFewestSegments, kShortest_s, kSegment_s);
  Segments out{std::max(static_cast<std::size_t>(segment_s * rate_Hz), kFewestSamples), {}};
  if (rate_Hz < kSlowest_Hz || n < 2 * out.length) return out;
  const std::size_t count = std::min(kMostSegments, n / out.length);
  for (std::size_t k = 0; k < count; ++k)
    out.from.push_back(k * (n - out.length) / std::max<std::size_t>(1, count - 1));
  return out;
}

struct Windowed {
  double total = 0.0;               // of the window
  std::vector<std::size_t> whole;  // segments without a missing sample
};

// Sums of all lines over all segments under one window, a block of samples at a time.
Windowed sum_up(const Segments& segments, const std::vector<double>& F, const std::vector<double>& U, double gain, std::vector<Line>& lines) {
  Windowed out;
  Rotation hann(2.0 * std::numbers::pi / static_cast<double>(segments.length));
  std::array<bool, kMostSegments> broken{};
  std::array<Side, kBlock> u{}, f{};
  for (std::size_t begin = 0; begin < segments.length; begin += kBlock) {
    const std::size_t size = std::min(kBlock, segments.length - begin);
    for (std::size_t i = 0; i < size; ++i, hann.step()) {
      const double w = 0.5 - 0.5 * hann.re;
      out.total += w;
      for (std::size_t k = 0; k < segments.from.size(); ++k) {
        const std::size_t at = segments.from[k] + begin + i;
        broken[k] = broken[k] || !std::isfinite(U[at] - gain * F[at]);
        u[i][k] = w * U[at];
        f[i][k] = w * (gain * F[at]);
      }
    }
    for (Line& line : lines) {
      for (Spectrum& s : line.at) s.add({u.data(), size}, {f.data(), size});
      for (Spectrum& s : line.beside) s.add({u.data(), size}, {f.data(), size});
    }
  }
  for (std::size_t k = 0; k < segments.from.size(); ++k)
    if (!broken[k]) out.whole.push_back(k);
  return out;
}

struct Strength {
  double ratio = 0.0, amplitude = 0.0;  // medians over the segments
  bool alone = false;                   // the output alone shows it in most of them
};

Strength strength_of(const Line& line, const Windowed& window) {
  std::vector<double> ratio, amplitude;
  std::size_t alone = 0;
  for (const std::size_t k : window.whole) {
    // a noisy reference hides in U - a F what the output alone shows
    const Powers difference = powers_of(line, &Spectrum::of_difference, k), output = powers_of(line, &Spectrum::of_output, k),
                 force = powers_of(line, &Spectrum::of_force, k);
    const bool is_alone = output.beside < difference.beside;
    const Powers& seen = is_alone ? output : difference;
    alone += is_alone ? 1 : 0;
    const double of_force = std::max(0.0, force.at - kOfNoise * force.beside);
    ratio.push_back(seen.at / (seen.beside + kOfForce * of_force + 1e-18 * window.total * window.total));
    amplitude.push_back(line.halves * std::sqrt(seen.at) / window.total);
  }
  return {quantile(ratio, 0.5), quantile(amplitude, 0.5), 2 * alone > window.whole.size()};
}

// Of samples that follow each other at one rate.
MainsLine line_of(double rate, const std::vector<double>& F, const std::vector<double>& U, double gain) {
  MainsLine best;
  best.rate_Hz = rate;
  const Segments segments = segments_of(U.size(), rate);
  if (segments.from.empty()) return best;
  std::vector<Line> lines = mains_lines(rate);
  const Windowed window = sum_up(segments, F, U, gain, lines);
  if (window.whole.size() < 2) return best;
  for (const Line& line : lines) {
    const Strength s = strength_of(line, window);
    // the third harmonic stands for a first one that is not in sight
    const bool has_first = best.mains_Hz == line.mains_Hz && best.ratio > kPlainLine;
    if (!(s.ratio > best.ratio) || has_first) continue;
    if (!(s.ratio > kPlainLine)) {
      best = {s.amplitude, line.frequency_Hz, line.mains_Hz, rate, s.ratio};
      continue;
    }
    if (const std::optional<double> measured = measured_Hz({F, U, s.alone ? 0.0 : gain}, line, rate))
      best = {s.amplitude, *measured, line.mains_Hz, rate, s.ratio};
    else if (!(best.ratio > 1.0))
      best = {0.0, line.frequency_Hz, line.mains_Hz, rate, 1.0};
  }
  return best;
}

}  // namespace

double folded_Hz(double line_Hz, double rate_Hz) {
  const double folded = std::fmod(line_Hz, rate_Hz);
  return std::min(folded, rate_Hz - folded);
}

bool can_show_mains(double mains_Hz, double rate_Hz) {
  return rate_Hz > 0.0 && std::max(folded_Hz(mains_Hz, rate_Hz), folded_Hz(3.0 * mains_Hz, rate_Hz)) >= kSlowestLine_Hz;
}

bool may_be_of_mains(double line_Hz, double mains_Hz, double rate_Hz) {
  constexpr double kSame_Hz = 0.5;
  return rate_Hz > 0.0 &&
         (std::abs(line_Hz - folded_Hz(mains_Hz, rate_Hz)) < kSame_Hz || std::abs(line_Hz - folded_Hz(3.0 * mains_Hz, rate_Hz)) < kSame_Hz);
}

MainsLine find_mains_line(const std::vector<double>& t, const std::vector<double>& F,
                          const std::vector<double>& U, double gain) {
  MainsLine best;
  if (t.size() < 512 || !(t.back() > t.front())) return best;
  const double rate = rate_between_gaps(t);
  if (std::vector<double> whole_F, whole_U; fill_short_gaps(t, rate, F, U, whole_F, whole_U)) return line_of(rate, whole_F, whole_U, gain);
  return line_of(rate, F, U, gain);
}

}  // namespace forcegate::diagnose
