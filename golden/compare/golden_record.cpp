#include "golden/compare/golden_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "golden/compare/golden_digest.h"
#include "hil/base/read_number.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

constexpr std::size_t kKept = 80;

std::string tolerance_line(const char* curve, const TubeOptions& o) {
  return fmt::format("tolerance {} absolute {} relative {} scale {} time_s {} lag_limit_s {}\n", curve,
                     shortest(o.absolute), shortest(o.relative), shortest(o.scale), shortest(o.time_s),
                     shortest(o.lag_limit_s));
}

// Reads the lines of a golden one after the other and says where it stopped.
class Reader {
 public:
  Reader(std::string_view text, std::string name) : name_(std::move(name)) {
    for (std::string line : split(std::string(text), '\n')) {
      if (line.ends_with('\r')) line.pop_back();  // checked out with the line ends of Windows
      if (++lines_; !line.empty() && line[0] != '#') rows_.push_back({lines_, split(line, ' ')});
    }
  }
  bool more() const { return at_ < rows_.size(); }
  const std::vector<std::string>& words() const { return rows_[at_].second; }
  void next() { ++at_; }
  Unexpected bad(const std::string& what) const {
    const std::size_t line = more() ? rows_[at_].first : lines_;
    return fail(ErrorCode::parse, what, fmt::format("{}:{}", name_, line),
                "take the file back as it was blessed, or remove it and bless a run again");
  }
  static bool number(const std::string& word, double& value) {
    const std::optional<double> read = read_number(word);
    value = read.value_or(value);
    return read.has_value();
  }
  static bool count(const std::string& word, std::size_t& value) {
    double d = 0.0;
    if (!number(word, d) || d < 0.0 || d > 1e9 || d != std::floor(d)) return false;
    value = static_cast<std::size_t>(d);
    return true;
  }

 private:
  std::string name_;
  std::size_t lines_ = 0, at_ = 0;
  std::vector<std::pair<std::size_t, std::vector<std::string>>> rows_;
};

bool read_tolerance(const std::vector<std::string>& w, GoldenRecord& golden) {
  if (w.size() != 12) return false;
  TubeOptions o;
  const std::pair<const char*, double*> fields[] = {{"absolute", &o.absolute},
                                                    {"relative", &o.relative},
                                                    {"scale", &o.scale},
                                                    {"time_s", &o.time_s},
                                                    {"lag_limit_s", &o.lag_limit_s}};
  for (std::size_t k = 0; k < 5; ++k)
    if (w[2 + 2 * k] != fields[k].first || !Reader::number(w[3 + 2 * k], *fields[k].second)) return false;
  if (w[1] == "ati") return golden.ati = o, true;
  if (w[1] == "firmware") return golden.firmware = o, true;
  return false;
}

Result<void> read_window(Reader& r, GoldenRecord& golden) {
  GoldenWindow window;
  std::size_t rows = 0;
  const auto& w = r.words();
  if (w.size() != 4 || !Reader::number(w[1], window.t0_s) || !Reader::number(w[2], window.step_s) ||
      !Reader::count(w[3], rows) || !(window.step_s > 0.0) || rows == 0)
    return r.bad("a window wants first instant, step and rows");
  r.next();
  for (std::size_t i = 0; i < rows; ++i) {
    double ati = 0.0, dut = 0.0;
    if (!r.more() || r.words().size() != 2 || !Reader::number(r.words()[0], ati) ||
        !Reader::number(r.words()[1], dut))
      return r.bad(fmt::format("the window ends after {} of {} rows", i, rows));
    window.ati_N.push_back(static_cast<float>(ati));
    window.dut_N.push_back(static_cast<float>(dut));
    r.next();
  }
  golden.content.windows.push_back(std::move(window));
  return {};
}

// What a golden is of and where it is from. An unknown word is a known one that was damaged: nothing else writes goldens.
Result<void> read_origin(const Reader& r, GoldenRecord& golden) {
  static const std::vector<std::string> kProvenance{"firmware_sha256", "bundle", "tool_version", "date", "stimulus", "calibration",
                                                    "who", "reason", "mre_maxima_pct", "mse_N2"};
  const std::vector<std::string>& w = r.words();
  const std::string value = join({w.begin() + 1, w.end()}, " ");
  const std::pair<const char*, std::string*> texts[] = {
      {"plan", &golden.plan}, {"case", &golden.case_name}, {"specimen", &golden.specimen}, {"rig", &golden.rig}, {"algorithm", &golden.algorithm}};
  for (const auto& [key, text] : texts) {
    if (w[0] != key) continue;
    if (value.empty() && text != &golden.algorithm) return r.bad("a line without a value");  // a firmware may declare no algorithm
    *text = value;
    return {};
  }
  if (w[0] == "seed") {
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), golden.seed);
    if (error != std::errc{} || end != value.data() + value.size()) return r.bad("a seed is a whole number from 0 on, not '" + printable_utf8(value) + "'");
    return {};
  }
  if (std::find(kProvenance.begin(), kProvenance.end(), w[0]) != kProvenance.end()) {
    golden.provenance[w[0]] = value;
    return {};
  }
  std::vector<std::string> known = kProvenance;
  known.push_back("seed");
  for (const auto& [key, text] : texts) known.push_back(key);
  const std::string near = nearest_name(w[0], known);
  return r.bad("a golden has no line '" + printable_utf8(w[0]) + "'" + (near.empty() ? "" : ", the nearest is '" + near + "'"));
}

double tolerance_N(const TubeOptions& o, double golden_N, double span_N) {
  return std::max({o.absolute, o.relative * std::fabs(golden_N), o.scale * span_N});
}

void worse(GoldenComparison& c, double outside, double t_s, std::string what) {
  if (!(outside > c.outside)) return;
  c.outside = outside;
  c.worst_at_s = t_s;
  if (outside > 1.0) c.cause = std::move(what);
}

double force(const GoldenExtremum& e, GoldenCurve curve) {
  return curve == GoldenCurve::ati ? e.ati_N : e.dut_N;
}
const std::vector<float>& values(const GoldenWindow& w, GoldenCurve curve) {
  return curve == GoldenCurve::ati ? w.ati_N : w.dut_N;
}

// A hold has no lag to speak of: what moves less than the tube is wide are noise and drift.
bool moves(const std::vector<float>& golden_N, const TubeOptions& o) {
  const auto [low, high] = std::minmax_element(golden_N.begin(), golden_N.end());
  const double middle_N = 0.5 * (static_cast<double>(*low) + static_cast<double>(*high));
  const double span_N = static_cast<double>(*high) - static_cast<double>(*low);
  return span_N > 2.0 * tolerance_N(o, middle_N, span_N);
}

void compare_extrema(const GoldenRecord& g, const GoldenContent& tested, GoldenCurve curve,
                     const TubeOptions& o, GoldenComparison& out) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const GoldenExtremum& e : g.content.extrema) {
    low = std::min(low, force(e, curve));
    high = std::max(high, force(e, curve));
  }
  const auto ratio = [](double deviation, double tolerance) {
    if (deviation == 0.0) return 0.0;
    return tolerance > 0.0 ? deviation / tolerance : std::numeric_limits<double>::infinity();
  };
  for (std::size_t k = 0; k < g.content.extrema.size(); ++k) {
    const GoldenExtremum &want = g.content.extrema[k], &got = tested.extrema[k * g.every];
    const double apart_s = std::fabs(got.t_s - want.t_s);
    const double apart_N = std::fabs(force(got, curve) - force(want, curve));
    worse(out, ratio(apart_s, o.time_s), want.t_s,
          fmt::format("an extremum comes at {:.3f} s, in the golden at {:.3f} s", got.t_s, want.t_s));
    const double tolerance = tolerance_N(o, force(want, curve), high - low);
    out.margins.push_back(
        {want.maximum ? "max" : "min", want.t_s, force(want, curve), force(got, curve), tolerance - apart_N});
    out.worst_margin_N = std::min(out.worst_margin_N, tolerance - apart_N);
    worse(out, ratio(apart_N, tolerance), want.t_s,
          fmt::format("the extremum at {:.3f} s is {:.4f} N, in the golden {:.4f} N", want.t_s,
                      force(got, curve), force(want, curve)));
    ++out.n;
  }
}

}  // namespace

std::string to_text(const GoldenRecord& g) {
  std::string out = fmt::format(
      "forcegate golden 1\n# Made by forcegate bless; do not edit by hand.\nplan {}\ncase {}\nspecimen {}\nseed {}\nrig {}\n"
      "algorithm {}\n",
      g.plan, g.case_name, g.specimen, g.seed, g.rig, g.algorithm);
  for (const auto& [key, value] : g.provenance) out += fmt::format("{} {}\n", key, value);
  const std::size_t digest_at = out.size();
  out += tolerance_line("ati", g.ati) + tolerance_line("firmware", g.firmware);
  const std::size_t all = g.extrema_in_all == 0 ? g.content.extrema.size() : g.extrema_in_all;
  const bool whole = g.extrema_in_all == 0;
  // An odd step keeps maxima and minima.
  std::size_t every = whole ? std::max<std::size_t>(1, (all + kKept - 1) / kKept) : g.every;
  if (whole && every > 1 && every % 2 == 0) ++every;
  out += fmt::format("extrema {} every {}\n", all, every);
  for (std::size_t i = 0; i < g.content.extrema.size(); i += whole ? every : 1) {
    const GoldenExtremum& e = g.content.extrema[i];
    out += fmt::format("{} {:.3f} {:.4f} {:.4f}\n", e.maximum ? "max" : "min", e.t_s, e.ati_N, e.dut_N);
  }
  for (const GoldenWindow& w : g.content.windows) {
    out += fmt::format("window {:.3f} {} {}\n", w.t0_s, shortest(w.step_s), w.ati_N.size());
    for (std::size_t i = 0; i < w.ati_N.size(); ++i)
      out += fmt::format("{:.4f} {:.4f}\n", w.ati_N[i], w.dut_N[i]);
  }
  return out.insert(digest_at, "digest " + golden_digest(out) + "\n");
}

Result<GoldenRecord> parse_golden_record(std::string_view text, const std::string& name) {
  Reader r(text, name);
  if (!r.more() || r.words() != std::vector<std::string>{"forcegate", "golden", "1"})
    return r.bad("this is no golden trace of format 1");
  r.next();
  GoldenRecord golden;
  std::set<std::string> seen;
  std::optional<Unexpected> damaged;  // told last: a line that is wrong by itself is told as that
  while (r.more()) {
    const auto& w = r.words();
    if (w[0] == "window") {
      FORCEGATE_CHECK_OK(read_window(r, golden));
      continue;
    }
    if (w[0] == "max" || w[0] == "min") {
      GoldenExtremum e{w[0] == "max", 0.0, 0.0, 0.0};
      if (w.size() != 4 || !Reader::number(w[1], e.t_s) || !Reader::number(w[2], e.ati_N) ||
          !Reader::number(w[3], e.dut_N))
        return r.bad("an extremum wants instant, ATI and firmware");
      golden.content.extrema.push_back(e);
      r.next();
      continue;
    }
    if (w.size() < 2) return r.bad("a line without a value");
    const std::string line = w[0] == "tolerance" ? w[0] + " " + w[1] : w[0];
    if (!seen.insert(line).second) return r.bad("'" + printable_utf8(line) + "' stands here a second time");
    if (w[0] == "extrema") {
      if (w.size() != 4 || !Reader::count(w[1], golden.extrema_in_all) || !Reader::count(w[3], golden.every) || golden.every == 0)
        return r.bad("extrema wants their number and a step");
    } else if (w[0] == "tolerance") {
      if (!read_tolerance(w, golden)) return r.bad("a tolerance line is malformed");
    } else if (w[0] == "digest") {
      if (w[1] != golden_digest(text)) damaged = r.bad("the golden is damaged: apart from its tolerances its lines are not those that were blessed");
    } else {
      FORCEGATE_CHECK_OK(read_origin(r, golden));
    }
    r.next();
  }
  // A line that is not there would leave a comparison out, or hold it against tolerances that nobody gave.
  for (const char* needed : {"plan", "case", "specimen", "seed", "rig", "algorithm", "tolerance ati", "tolerance firmware", "extrema"})
    if (!seen.contains(needed)) return r.bad(fmt::format("the golden lacks its line '{}'", needed));
  const std::size_t expected =
      golden.extrema_in_all == 0 ? 0 : (golden.extrema_in_all - 1) / golden.every + 1;
  if (golden.content.extrema.size() != expected)
    return r.bad(
        fmt::format("the golden holds {} extrema instead of {}", golden.content.extrema.size(), expected));
  if (damaged) return *damaged;
  return golden;
}

Result<GoldenComparison> compare_golden(const GoldenRecord& g, const GoldenContent& tested,
                                        GoldenCurve curve) {
  TubeOptions o = curve == GoldenCurve::ati ? g.ati : g.firmware;
  o.keep_margins = true;
  GoldenComparison out;
  out.lag_s = std::numeric_limits<double>::quiet_NaN();
  if (g.content.extrema.empty() && g.content.windows.empty())
    return fail(ErrorCode::config, "the golden holds neither extrema nor a window", g.case_name,
                "bless it again");
  if (tested.extrema.size() != g.extrema_in_all) {
    out.cause =
        fmt::format("the record has {} extrema, the golden {}", tested.extrema.size(), g.extrema_in_all);
    return out;
  }
  const auto odd = [&](const GoldenExtremum& e) {
    return !std::isfinite(force(e, curve)) || !std::isfinite(e.t_s);
  };
  if (const auto n = std::count_if(tested.extrema.begin(), tested.extrema.end(), odd); n > 0) {
    out.cause = fmt::format("{} of {} extrema are not numbers", n, tested.extrema.size());
    return out;
  }
  if (tested.windows.size() != g.content.windows.size()) {
    out.cause = fmt::format("the record has {} windows, the golden {}", tested.windows.size(),
                            g.content.windows.size());
    return out;
  }
  out.worst_margin_N = std::numeric_limits<double>::infinity();
  compare_extrema(g, tested, curve, o, out);
  const double lag_limit_s = o.lag_limit_s;
  for (std::size_t k = 0; k < g.content.windows.size(); ++k) {
    const GoldenWindow &want = g.content.windows[k], &got = tested.windows[k];
    o.lag_limit_s = moves(values(want, curve), o) ? lag_limit_s : std::numeric_limits<double>::infinity();
    FORCEGATE_TRY(const TubeResult tube, compare_tube({want.t0_s, want.step_s, values(want, curve)},
                                                      {got.t0_s, got.step_s, values(got, curve)}, o));
    if (tube.state == TubeState::not_compared) {
      out.state = TubeState::not_compared;
      out.cause = tube.cause;
      return out;
    }
    out.n += tube.n;
    for (std::size_t i = 0; i < tube.margin.size(); ++i)
      out.margins.push_back({"window", want.t0_s + static_cast<double>(i) * want.step_s,
                             values(want, curve)[i], values(got, curve)[i], tube.margin[i]});
    if (std::isfinite(tube.lag_s) && !(std::fabs(tube.lag_s) <= std::fabs(out.lag_s))) out.lag_s = tube.lag_s;
    out.worst_margin_N = std::min(out.worst_margin_N, tube.worst_margin);
    if (tube.state == TubeState::outside)
      worse(out, std::max(std::nextafter(1.0, 2.0), 1.0 - tube.worst_margin / std::max(1e-9, o.absolute)),
            tube.worst_at_s, fmt::format("window from {:.1f} s: {}", want.t0_s, tube.cause));
  }
  out.state = out.outside <= 1.0 ? TubeState::inside : TubeState::outside;
  return out;
}

}  // namespace forcegate
