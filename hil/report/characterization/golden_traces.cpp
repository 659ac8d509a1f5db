#include "hil/report/characterization/golden_traces.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "hil/base/text.h"

namespace forcegate {
namespace {

using characterize::Curve;

constexpr std::size_t kMostRows = 40, kStepEvery = 5;
constexpr double kAbsolute_V = 0.01, kAbsolute_N = 0.03, kRelative = 0.002;

// Every k-th maximum and the minimum of the same number, so that a row is one cycle.
Curve cycles_of(const Curve& extrema, std::string_view channel) {
  Curve out;
  out.columns = {"t_s", "maximum", "minimum"};
  out.data.resize(3);
  const std::vector<float>&t = *extrema.find("t_s"), &v = *extrema.find(channel),
        &maximum = *extrema.find("maximum");
  const auto maxima = static_cast<std::size_t>(
      std::count_if(maximum.begin(), maximum.end(), [](float m) { return m > 0.5F; }));
  const std::size_t cycles = std::min(maxima, t.size() - maxima);
  const std::size_t every = std::max<std::size_t>(1, (cycles + kMostRows - 1) / kMostRows);
  for (std::size_t i = 0; i < cycles; i += every) {
    out.data[0].push_back(t[i]);
    out.data[1].push_back(v[i]);
    out.data[2].push_back(v[maxima + i]);
  }
  return out;
}

Curve step_of(const Curve& step) {
  Curve out;
  out.columns = {"t_s", "ati_N", "sensor_V"};
  out.data.resize(3);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::vector<float>& v = *step.find(out.columns[k]);
    for (std::size_t i = 0; i < v.size(); i += kStepEvery) out.data[k].push_back(v[i]);
  }
  return out;
}

}  // namespace

std::vector<GoldenTrace> golden_traces(const characterize::SensorStudy& study,
                                       const characterize::StudyPlan& plan) {
  std::vector<GoldenTrace> out;
  for (const Curve& c : study.exemplar.curves) {
    const bool extrema = c.name.starts_with("extrema/");
    if (!extrema && c.name != "fig5") continue;
    GoldenTrace g;
    g.name = study.sensor + "_" + (extrema ? c.name.substr(8) : "step");
    std::replace(g.name.begin(), g.name.end(), ' ', '_');
    const bool control = c.name.starts_with("extrema/control_");
    g.unit = control ? "N" : "V";
    g.absolute = control ? kAbsolute_N : extrema ? kAbsolute_V : std::max(kAbsolute_V, kAbsolute_N);
    g.relative = kRelative;
    g.provenance = {{"plan", plan.name},
                    {"rig", "emulated"},
                    {"sensor", study.sensor},
                    {"specimen", study.exemplar.specimen},
                    {"seed", std::to_string(plan.seed)},
                    {"source", "Lebosse 2011; forcegate characterize"}};
    g.curve = extrema ? cycles_of(c, control ? "ati_N" : "sensor_V") : step_of(c);
    g.curve.name = g.name;
    if (!g.curve.data[0].empty()) out.push_back(std::move(g));
  }
  return out;
}

std::string golden_text(const GoldenTrace& g) {
  std::string out =
      fmt::format("# format = 1\n# name = \"{}\"\n# unit = \"{}\"\n# absolute = {}\n# relative = {}\n",
                  g.name, g.unit, shortest(g.absolute), shortest(g.relative));
  for (const auto& [key, value] : g.provenance) out += fmt::format("# {} = \"{}\"\n", key, value);
  out += join(g.curve.columns, ",") + "\n";
  for (std::size_t i = 0; i < g.curve.data[0].size(); ++i) {
    for (std::size_t k = 0; k < g.curve.data.size(); ++k)
      out +=
          fmt::format("{}{:.{}f}", k > 0 ? "," : "", static_cast<double>(g.curve.data[k][i]), k == 0 ? 3 : 4);
    out += '\n';
  }
  return out;
}

Result<GoldenTrace> parse_golden(std::string_view text, const std::string& name) {
  GoldenTrace g;
  std::size_t number = 0;
  bool header = false;
  const auto bad = [&](std::string why) {
    return fail(ErrorCode::parse, std::move(why), name + ":" + std::to_string(number),
                "write it anew with forcegate characterize --golden");
  };
  for (const std::string& line : split(text, '\n')) {
    ++number;
    if (line.empty()) continue;
    if (line.starts_with("# ")) {
      const std::size_t equals = line.find(" = ");
      if (equals == std::string::npos) return bad("the header line is not 'key = value'");
      const std::string key = line.substr(2, equals - 2);
      std::string value = line.substr(equals + 3);
      if (value.size() >= 2 && value.front() == '"') value = value.substr(1, value.size() - 2);
      double parsed = 0.0;
      const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), parsed);
      const bool is_number = error == std::errc{} && end == value.data() + value.size();
      if (key == "format") {
        if (value != "1") return bad("format " + printable_utf8(value) + " is not known");
      } else if (key == "absolute" || key == "relative") {
        if (!is_number || !(parsed >= 0.0)) return bad("'" + key + "' is not a number from 0");
        (key == "absolute" ? g.absolute : g.relative) = parsed;
      } else if (key == "name") {
        g.name = g.curve.name = value;
      } else if (key == "unit") {
        g.unit = value;
      } else {
        g.provenance[key] = value;
      }
      continue;
    }
    const std::vector<std::string> cells = split(line, ',');
    if (!header) {
      g.curve.columns = cells;
      g.curve.data.resize(cells.size());
      header = true;
      continue;
    }
    if (cells.size() != g.curve.columns.size())
      return bad("the row has another number of cells than the header");
    for (std::size_t k = 0; k < cells.size(); ++k) {
      float v = 0.0F;
      const auto [end, error] = std::from_chars(cells[k].data(), cells[k].data() + cells[k].size(), v);
      if (error != std::errc{} || end != cells[k].data() + cells[k].size() || !std::isfinite(v))
        return bad("'" + printable_utf8(cells[k]) + "' is not a number");
      g.curve.data[k].push_back(v);
    }
  }
  if (g.name.empty() || g.curve.data.size() < 2 || g.curve.data[0].empty())
    return bad("this is no golden trace: name, columns or rows are missing");
  return g;
}

}  // namespace forcegate
