#include "hil/report/capacitance/weight_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace forcegate {
namespace {

using namespace figures;
using namespace characterize;

constexpr double kWidth = 680.0, kHeight = 230.0;
constexpr std::size_t kSensor = 2;  // of pack 0
constexpr Role kForceRoles[] = {Role::model, Role::rising, Role::firmware, Role::falling, Role::raw};
constexpr Marker kForceMarkers[] = {Marker::dot, Marker::square, Marker::up, Marker::ring, Marker::cross};

class Pictures {
 public:
  explicit Pictures(const WeightStudy& study)
      : study_(study),
        sensor_(study.exemplar_set.sensors[kSensor]),
        loads_(study.exemplar[kSensor]),
        levels_(static_cast<std::size_t>(std::floor(study.plan.force_max_N / study.plan.step_N + 1e-9))) {}

  std::vector<PaperPicture> all() {
    conductance();
    sweep(
        "fig06.svg", "Fig. 6", "Phase over frequency", Axis{"Phase", "°", 0.0, 90.0},
        [](const impedance::RcReading& r) { return r.phase_rad * 180.0 / std::numbers::pi; }, true);
    sweep(
        "fig07.svg", "Fig. 7", "Capacitance over frequency", Axis{"C_s", "pF", 0.0, 1000.0},
        [](const impedance::RcReading& r) { return 1e12 * r.capacitance_F; }, false);
    sweep(
        "fig08.svg", "Fig. 8", "Resistance over frequency",
        Axis{"R_s", "kΩ", kAuto, kAuto, Scale::logarithmic},
        [](const impedance::RcReading& r) { return 1e-3 * r.resistance_ohm(); }, false);
    capacitance();
    errors();
    surface();
    return std::move(out_);
  }

 private:
  void add(const char* file, const char* place, std::string caption, Figure figure) {
    figure.summary = caption;
    out_.push_back({file, place, std::move(caption), std::move(figure)});
  }

  std::vector<impedance::ForceReading> first_test() const {
    return {loads_.testing.begin(), loads_.testing.begin() + static_cast<std::ptrdiff_t>(levels_)};
  }

  void conductance() {
    Figure f("Resistance and conductance over force", kWidth);
    f.columns = 2;
    std::vector<double> force, ohm, siemens;
    for (const auto& r : first_test()) {
      const double g = -r.output_V / study_.plan.dc_V / study_.bench.feedback_ohm;
      force.push_back(r.force_N), ohm.push_back(1e-3 / g), siemens.push_back(1e6 * g);
    }
    f.panel(Axis{"Force", "N", 0.0}, Axis{"R_s", "kΩ", kAuto, kAuto, Scale::logarithmic}, kHeight)
        .points(force, ohm, {Role::raw, Dash::solid, 1.0, Marker::dot, 4.0});
    Panel& g = f.panel(Axis{"Force", "N", 0.0}, Axis{"1/R_s", "µS", 0.0}, kHeight);
    g.points(force, siemens, {Role::raw, Dash::solid, 1.0, Marker::dot, 4.0}, "measured, eq. (8)");
    const auto line = impedance::fit_conductance(loads_.training);
    const double scale = -1e6 / study_.plan.dc_V / study_.bench.feedback_ohm;
    g.line(
        {0.0, study_.plan.force_max_N},
        {-line.offset_N / line.slope * scale, (study_.plan.force_max_N - line.offset_N) / line.slope * scale},
        {Role::model}, "line of the training loadings");
    add("fig04.svg", "Fig. 4",
        fmt::format(
            "One sensor on one loading. Conductance is nearly a line; {:.2f} N is the root of the line's MSE on new loadings.",
            std::sqrt(sensor_.mse_N2[0])),
        std::move(f));
  }

  template <class Get>
  void sweep(const char* file, const char* place, const char* title, Axis y_axis, Get get, bool with_law) {
    Figure f(title, kWidth);
    Panel& p = f.panel(Axis{"Frequency", "Hz", kAuto, kAuto, Scale::logarithmic}, std::move(y_axis), kHeight);
    double divergence_Hz = 0.0;
    for (std::size_t i = 0; i < sensor_.sweeps.size() && i < std::size(kForceRoles); ++i) {
      const SweepResult& s = sensor_.sweeps[i];
      std::vector<double> x, y, law;
      for (const auto& r : s.readings) {
        const double value = get(r);
        x.push_back(r.f_Hz);
        y.push_back(p.y_axis.scale == Scale::logarithmic && !(value > 0.0) ? kAuto : value);
        law.push_back(s.fit.phase_rad(r.f_Hz) * 180.0 / std::numbers::pi);
      }
      p.points(x, y, {kForceRoles[i], Dash::solid, 1.0, kForceMarkers[i], 4.5},
               fmt::format("{:.0f} N", s.force_N));
      if (with_law && s.fitted) p.line(x, law, {kForceRoles[i], Dash::solid, 1.0}, i == 0 ? "eq. (9)" : "");
      divergence_Hz += s.fit.divergence_Hz / static_cast<double>(sensor_.sweeps.size());
    }
    if (std::isfinite(divergence_Hz))
      p.vline(divergence_Hz, fmt::format("divergence {:.2f} kHz", 1e-3 * divergence_Hz), Role::muted);
    const auto& top = sensor_.sweeps.back();
    const auto at = [&](double f_Hz) {
      return get(
          *std::min_element(top.readings.begin(), top.readings.end(), [&](const auto& a, const auto& b) {
            return std::abs(std::log(a.f_Hz / f_Hz)) < std::abs(std::log(b.f_Hz / f_Hz));
          }));
    };
    std::string caption;
    if (with_law)
      caption = fmt::format(
          "Markers: measured. Lines: eq. (9) with R_s and C_s of the Bode fit. Beyond the divergence the phase saturates: "
          "at {:.0f} N {:.1f}° at 10 kHz and {:.1f}° at 40 kHz, {}.",
          top.force_N, at(1e4), at(4e4),
          top.fitted ? fmt::format("where eq. (9) says {:.1f}°", top.fit.phase_rad(4e4) * 180.0 / std::numbers::pi) : "where no fit says what eq. (9) does");
    else if (p.y_axis.scale == Scale::logarithmic)
      caption = fmt::format(
          "Resistance falls beyond the divergence: at {:.0f} N from {:.0f} kΩ at 1 kHz to {:.0f} kΩ at 40 kHz.",
          top.force_N, at(1e3), at(4e4));
    else
      caption = fmt::format(
          "Capacitance varies little: at {:.0f} N from {:.0f} pF at 1 kHz to {:.0f} pF at 40 kHz. "
          "A phase that saturates cannot do without such a fall (Kramers and Kronig). Below 1 kHz the readings scatter.",
          top.force_N, at(1e3), at(4e4));
    add(file, place, std::move(caption), std::move(f));
  }

  void capacitance() {
    Figure f("Capacitance over force", kWidth);
    Panel& p = f.panel(Axis{"Force", "N", 0.0}, Axis{"C_s", "pF", 0.0}, kHeight);
    std::vector<double> force, farad;
    for (const auto& r : first_test()) force.push_back(r.force_N), farad.push_back(1e12 * r.capacitance_F);
    p.points(force, farad, {Role::raw, Dash::solid, 1.0, Marker::dot, 4.0}, "measured, eq. (6)");
    const auto line = impedance::fit_capacitance(loads_.training);
    p.line(
        {0.0, study_.plan.force_max_N},
        {-1e12 * line.offset_N / line.slope, 1e12 * (study_.plan.force_max_N - line.offset_N) / line.slope},
        {Role::model}, "line of the training loadings");
    add("fig09.svg", "Fig. 9",
        fmt::format("C_s at {:.0f} Hz; {:.2f} N is the root of the line's MSE on new loadings.",
                    study_.plan.sine_Hz, std::sqrt(sensor_.mse_N2[1])),
        std::move(f));
  }

  void errors() {
    constexpr Role kRoles[] = {Role::raw, Role::model, Role::muted, Role::firmware};
    Figure f("Mean squared error of four models", kWidth);
    Axis sensors{"Sensor", "", -0.6, static_cast<double>(study_.exemplar_set.sensors.size()) - 0.4};
    for (std::size_t s = 1; s <= study_.exemplar_set.sensors.size(); ++s)
      sensors.categories.push_back(std::to_string(s));
    Panel& p = f.panel(std::move(sensors), Axis{"MSE", "N²", 0.0}, kHeight);
    for (std::size_t m = 0; m < 4; ++m) {
      std::vector<Bar> bars;
      for (std::size_t s = 0; s < study_.exemplar_set.sensors.size(); ++s)
        bars.push_back({static_cast<double>(s) + 0.2 * (static_cast<double>(m) - 1.5),
                        0.0,
                        study_.exemplar_set.sensors[s].mse_N2[m],
                        0.0,
                        false,
                        kRoles[m],
                        {}});
      p.bars(std::move(bars), false, false, 0.18);
      p.points({kAuto}, {kAuto}, {kRoles[m], Dash::solid, 1.0, Marker::square, 6.0},
               std::string(kForceModelNames[m]));
    }
    add("fig10.svg", "Fig. 10",
        fmt::format("Pack 0, new loadings. Mean error reduction of this pack {:.0f} %.",
                    study_.exemplar_set.per_mean_pct()),
        std::move(f));
  }

  void surface() {
    constexpr int kCells = 44;
    double v_top = 0, c_low = 1, c_top = 0;
    std::vector<double> v, c;
    for (const auto& r : first_test()) {
      v_top = std::max(v_top, r.output_V), c_low = std::min(c_low, r.capacitance_F),
      c_top = std::max(c_top, r.capacitance_F);
      v.push_back(r.output_V), c.push_back(1e12 * r.capacitance_F);
    }
    HeatMap map;
    map.low = 0.0, map.high = study_.plan.force_max_N;
    map.label = "Force", map.unit = "N";
    for (int i = 0; i <= kCells; ++i) {
      map.x_edges.push_back(1.05 * v_top * i / kCells);
      map.y_edges.push_back(1e12 * (0.9 * c_low + (1.05 * c_top - 0.9 * c_low) * i / kCells));
    }
    for (int y = 0; y < kCells; ++y)
      for (int x = 0; x < kCells; ++x)
        map.value.push_back(
            std::clamp(loads_.network.force_N(0.5 * (map.x_edges[static_cast<std::size_t>(x)] +
                                                     map.x_edges[static_cast<std::size_t>(x) + 1]),
                                              0.5e-12 * (map.y_edges[static_cast<std::size_t>(y)] +
                                                         map.y_edges[static_cast<std::size_t>(y) + 1])),
                       0.0, study_.plan.force_max_N));
    Figure f("Force by the network", kWidth);
    Panel& p = f.panel(Axis{"V_o", "V", 0.0, map.x_edges.back()},
                       Axis{"C_s", "pF", map.y_edges.front(), map.y_edges.back()}, 300.0);
    p.no_grid = true;
    p.heat(std::move(map));
    p.line(v, c, {Role::firmware, Dash::solid, 2.0}, "path of one loading");
    add("fig11.svg", "Fig. 11",
        "The surface that the network has learnt, seen from above. Off the path the network has seen nothing; "
        "how steep it is across decides what it makes of a reading that strays.",
        std::move(f));
  }

  const WeightStudy& study_;
  const SensorResult& sensor_;
  const WeightExemplar& loads_;
  std::size_t levels_;
  std::vector<PaperPicture> out_;
};

}  // namespace

std::vector<PaperPicture> weight_figures(const WeightStudy& study) { return Pictures(study).all(); }

}  // namespace forcegate
