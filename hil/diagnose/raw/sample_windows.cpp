#include "hil/diagnose/raw/sample_windows.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "hil/trace/static_line.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kPoints = 700, kFewest = 160;

struct Samples {
  const std::vector<double>&t_s, &F_N, &U_V;
  std::size_t size() const { return t_s.size(); }
};

// Only where force and output share a clock.
const std::vector<double>* time_of(const Record& record) {
  const Channel *f = record.trace.find("F_ref"), *u = record.trace.find("U");
  if (f == nullptr || u == nullptr) return nullptr;
  const std::vector<double>& t = record.trace.time_bases[f->time_base].t_s;
  return f->value.size() == t.size() && u->value.size() == t.size() ? &t : nullptr;
}

std::string unit_of(const Record& record, std::string_view channel, const std::string& otherwise) {
  const std::string& unit = record.trace.find(channel)->unit;
  return unit.empty() || unit == "1" ? otherwise : unit;
}

// U at a force by the line through the good samples from first to end; with the slope of all records where the force stands still there.
std::function<double(double)> line_through(const Samples& s, const std::vector<std::uint8_t>& bad, std::size_t first, std::size_t end,
                                           const HealthScales& scales) {
  constexpr double kLeast = 0.02;  // of the span, RMS
  StaticLine line;
  for (std::size_t i = first; i < end; ++i)
    if (bad[i] == 0 && std::isfinite(s.F_N[i]) && std::isfinite(s.U_V[i])) line.push(s.U_V[i], s.F_N[i]);
  if (!(line.n() > 0.0)) return [](double) { return kMissing; };
  const double least_N = kLeast * scales.range_N;
  const double slope = line.variance_N2() > least_N * least_N ? line.covariance_VN() / line.variance_N2() : scales.gain_V_per_N;
  return [slope, mean_N = line.mean_N(), mean_V = line.mean_V()](double F_N) { return mean_V + slope * (F_N - mean_N); };
}

// Start of the `width` samples that hold most of that kind, which are moved into their middle.
std::size_t densest(const std::vector<std::uint8_t>& bad, BadSample kind, std::size_t width) {
  const auto is = [&](std::size_t i) { return bad[i] == static_cast<std::uint8_t>(kind) ? 1 : 0; };
  int count = 0, most = -1;
  std::size_t at = 0;
  for (std::size_t i = 0; i < bad.size(); ++i) {
    count += is(i) - (i >= width ? is(i - width) : 0);
    if (i + 1 >= width && count > most) most = count, at = i + 1 - width;
  }
  std::size_t low = bad.size(), high = 0;
  for (std::size_t i = at; i < std::min(bad.size(), at + width); ++i)
    if (is(i) != 0) low = std::min(low, i), high = i;
  const std::size_t middle = (low + high) / 2;
  return std::min(middle - std::min(middle, width / 2), bad.size() - width);
}

std::size_t longest_run(const std::vector<std::uint8_t>& bad, BadSample kind) {
  std::size_t run = 0, longest = 0;
  for (const std::uint8_t b : bad) {
    run = b == static_cast<std::uint8_t>(kind) ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return longest;
}

CutOut cut_out(const Record& record, const Samples& s, const RecordHealth& health, BadSample kind, std::size_t count, const HealthScales& scales) {
  constexpr std::size_t kRuns = 5;  // as long as that many of the longest run
  const std::size_t n = s.size(), width = std::min(n, std::max(kFewest, kRuns * longest_run(health.bad, kind)));
  const std::size_t first = densest(health.bad, kind, width), stride = std::max<std::size_t>(1, width / kPoints);
  const auto line = line_through(s, health.bad, first, first + width, scales);
  CutOut out;
  out.weight = static_cast<double>(count);
  SampleWindow& w = out.window;
  w.record = record.name;
  w.quantity = "output";
  w.unit = unit_of(record, "U", "V");
  w.beside_name = "as the force says";
  for (std::size_t i = first; i < first + width; ++i) {
    const bool named = health.bad[i] == static_cast<std::uint8_t>(kind);
    const double said = line(s.F_N[i]);
    if (named) {
      w.named_t_s.push_back(s.t_s[i]);
      w.named.push_back(std::isfinite(s.U_V[i]) ? s.U_V[i] : said);
    }
    if (!named && (i - first) % stride != 0) continue;
    w.t_s.push_back(s.t_s[i]);
    w.recorded.push_back(s.U_V[i]);
    w.beside.push_back(said);
  }
  return out;
}

}  // namespace

std::vector<CutOut> cut_out_bad_samples(const Record& record, const RecordHealth& health, const HealthScales& scales) {
  std::vector<CutOut> out;
  const std::vector<double>* t = time_of(record);
  if (t == nullptr || health.bad.size() != t->size()) return out;
  const Samples s{*t, record.trace.find("F_ref")->value, record.trace.find("U")->value};
  const auto add = [&](BadSample kind, std::vector<std::string> effects) {
    const auto count = static_cast<std::size_t>(std::ranges::count(health.bad, static_cast<std::uint8_t>(kind)));
    if (count == 0) return;
    out.push_back(cut_out(record, s, health, kind, count, scales));
    out.back().effects = std::move(effects);
  };
  add(BadSample::missing, {"dropouts"});
  add(BadSample::zero, {"dropouts", "outliers"});
  add(BadSample::outlier, {"outliers"});
  add(BadSample::bit, {"adc_codes"});
  add(BadSample::held, {"adc_codes", "dropouts"});
  add(BadSample::rail, {"clipping", "adc_codes"});
  return out;
}

CutOut cut_out_hum(const Record& without, const std::vector<double>& before_V, double line_Hz, double weight) {
  constexpr double kPeriods = 12.0;
  CutOut out;
  const std::vector<double>* t = time_of(without);
  if (t == nullptr || before_V.size() != t->size() || !(line_Hz > 0.0)) return out;
  out.effects = {"hum"};
  out.weight = weight;
  SampleWindow& w = out.window;
  w.record = without.name;
  w.quantity = "output";
  w.unit = unit_of(without, "U", "V");
  w.beside_name = "with the line taken off";
  const std::vector<double>& after_V = without.trace.find("U")->value;
  const std::size_t first = t->size() / 2;
  for (std::size_t i = first; i < t->size() && w.t_s.size() < kPoints && (*t)[i] < (*t)[first] + kPeriods / line_Hz; ++i) {
    w.t_s.push_back((*t)[i]);
    w.recorded.push_back(before_V[i]);
    w.beside.push_back(after_V[i]);
  }
  return out;
}

CutOut cut_out_reference_noise(const Record& smoothed, const std::vector<double>& before_N, double weight) {
  CutOut out;
  const std::vector<double>* t = time_of(smoothed);
  if (t == nullptr || before_N.size() != t->size() || t->size() < kFewest) return out;
  out.effects = {"reference_noise"};
  out.weight = weight;
  const std::vector<double>& after_N = smoothed.trace.find("F_ref")->value;
  // where the reference steps most, an eighth of what the force moves by taken off: the steps of a movement are no noise
  constexpr double kMoved = 0.125;
  std::size_t first = 0;
  double most = -INFINITY;
  for (std::size_t at = 0; at + kFewest <= t->size(); at += kFewest / 2) {
    double low = INFINITY, high = -INFINITY, square = 0.0;
    std::size_t there = 0;
    for (std::size_t i = at; i < at + kFewest; ++i) {
      if (!std::isfinite(before_N[i]) || !std::isfinite(after_N[i])) continue;
      ++there;
      if (i > at && std::isfinite(before_N[i - 1])) square += 0.5 * (before_N[i] - before_N[i - 1]) * (before_N[i] - before_N[i - 1]);
      low = std::min(low, after_N[i]), high = std::max(high, after_N[i]);
    }
    if (2 * there < kFewest) continue;
    if (const double plain_N = std::sqrt(square / static_cast<double>(there)) - kMoved * (high - low); plain_N > most) most = plain_N, first = at;
  }
  if (!std::isfinite(most)) return out;
  SampleWindow& w = out.window;
  w.record = smoothed.name;
  w.quantity = "reference force";
  w.unit = "N";
  w.beside_name = "smoothed within its noise";
  const auto cut = [&](const std::vector<double>& x) {
    const auto begin = x.begin() + static_cast<std::ptrdiff_t>(first);
    return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(kFewest));
  };
  w.t_s = cut(*t);
  w.recorded = cut(before_N);
  w.beside = cut(after_N);
  return out;
}

void add_sample_windows(const std::vector<CutOut>& cuts, std::vector<HealthClaim>& claims) {
  for (HealthClaim& claim : claims) {
    const CutOut* heaviest = nullptr;
    for (const CutOut& cut : cuts)
      if (std::ranges::find(cut.effects, claim.effect) != cut.effects.end() && (heaviest == nullptr || cut.weight > heaviest->weight)) heaviest = &cut;
    if (heaviest != nullptr) claim.samples.push_back(heaviest->window);
  }
}

}  // namespace forcegate::diagnose
