#include "hil/report/characterization/figures_of_the_paper.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/report/characterization/paper_claims.h"
#include "hil/report/figures/envelope.h"
#include "hil/trace/extrema.h"

namespace forcegate {
namespace {

using namespace figures;
using characterize::Curve;
using characterize::SensorStudy;
using characterize::SessionSheet;

constexpr double kWidth = 680.0, kWide = 210.0, kLow = 150.0;

const Curve* curve_of(const SensorStudy* study, std::string_view name) {
  if (study == nullptr) return nullptr;
  for (const Curve& c : study->exemplar.curves)
    if (c.name == name) return &c;
  return nullptr;
}

std::vector<double> column(const Curve& c, std::string_view name) {
  const std::vector<float>* v = c.find(name);
  return v != nullptr ? doubles(*v) : std::vector<double>{};
}

std::vector<double> shifted(std::vector<double> v, double by, double scale = 1.0) {
  for (double& x : v) x = (x - by) * scale;
  return v;
}

// A line where its cycles can be told apart, else how far they go.
void trace(Panel& p, const std::vector<double>& x, const std::vector<double>& y, Role role, std::string label = {}, double opacity = 0.6) {
  constexpr std::size_t kMostTurns = 120, kFewest = 40, kMost = 240, kTurnsOfStretch = 3;
  constexpr double kProminence = 0.1;  // of the span
  const auto [low, high] = std::ranges::minmax(y);
  const std::size_t turns = high > low ? turning_points(x, y, kProminence * (high - low)).size() : 0;
  if (turns > kMostTurns)
    add_band(p, envelope(x, y, std::clamp(turns / kTurnsOfStretch, kFewest, kMost)), role, opacity, std::move(label));
  else
    p.line(x, y, {role, Dash::solid, 0.6}, std::move(label));
}

class Pictures {
 public:
  explicit Pictures(const std::vector<SensorStudy>& studies)
      : flexi_(study_of(studies, "flexiforce")), fsr_(study_of(studies, "fsr")) {}

  std::vector<PaperPicture> all() {
    calibration();
    step();
    decay();
    erratic();
    jump();
    control();
    tms();
    fitting();
    return std::move(out_);
  }

 private:
  void add(const char* file, const char* place, std::string caption, Figure figure) {
    figure.summary = caption;
    out_.push_back({file, place, std::move(caption), std::move(figure)});
  }

  void calibration() {
    Figure f(curve_of(flexi_, "fig4") != nullptr && curve_of(fsr_, "fig4") != nullptr ? "Calibration of both sensors" : "Calibration", kWidth);
    f.columns = 2;
    std::string residuals;
    for (const SensorStudy* s : {flexi_, fsr_}) {
      const Curve* c = curve_of(s, "fig4");
      if (c == nullptr) continue;
      Panel& p = f.panel(Axis{"Output", "V"}, Axis{"Force", "N"}, kWide);
      p.title = s->sensor == "fsr" ? "FSR" : "FlexiForce";
      p.points(column(*c, "sensor_V"), column(*c, "ati_N"),
               {Role::raw, Dash::solid, 1.0, Marker::dot, 2.0, 0.6}, "measured");
      const auto& k = s->exemplar.calibration;
      const double low_V = (0.2 - k.offset_N) / k.gain_N_per_V, high_V = (4.1 - k.offset_N) / k.gain_N_per_V;
      p.line({low_V, high_V}, {0.2, 4.1}, {Role::model}, "F = G U + F0");
      residuals +=
          fmt::format("{}{}: G = {:.3f} N/V, F0 = {:.3f} N, residual {:.3f} N", residuals.empty() ? "" : "; ",
                      p.title, k.gain_N_per_V, k.offset_N, s->exemplar.calibration_rmse_N);
    }
    if (!f.panels().empty())
      add("fig04.svg", "Fig. 4",
          "Two continuous sweeps and the identified line of eq. (1). " + residuals + ".", std::move(f));
  }

  void step() {
    const Curve *a = curve_of(flexi_, "fig5"), *b = curve_of(fsr_, "fig5");
    if (a == nullptr && b == nullptr) return;
    Figure f("Step responses", kWidth);
    Panel& p = f.panel(Axis{"Time", "ms"}, Axis{"Response / final value", "", -0.05, 1.15}, kWide);
    const auto draw = [&](const Curve& c, const char* name, Style style, const char* label) {
      const std::vector<double> t = shifted(column(c, "t_s"), c.zero_s, 1e3), v = column(c, name);
      double start = 0, end = 0;
      int n = 0, m = 0;
      for (std::size_t i = 0; i < t.size(); ++i) {
        if (t[i] < -20.0) start += v[i], ++n;
        if (t[i] > 330.0) end += v[i], ++m;
      }
      if (n == 0 || m == 0) return;
      start /= n, end /= m;
      p.line(t, shifted(v, start, 1.0 / (end - start)), style, label);
    };
    const Curve& reference = a != nullptr ? *a : *b;
    draw(reference, "ati_N", {Role::reference, Dash::solid, 1.2}, "Nano17");
    if (a != nullptr) draw(*a, "sensor_V", {Role::firmware}, "FlexiForce");
    if (b != nullptr) draw(*b, "sensor_V", {Role::model, Dash::dashed}, "FSR");
    p.hline(0.95, "", Role::muted, Dash::dotted);
    std::string times;
    for (const auto& [ms, who] :
         {std::pair(a != nullptr ? value("step.ati") : fsr_value("step.ati"), "Nano17"),
          {value("step.sensor"), "FlexiForce"},
          {fsr_value("step.sensor"), "FSR"}})
      if (std::isfinite(ms)) times += fmt::format("{}{:.0f} ms ({})", times.empty() ? "" : ", ", ms, who);
    add("fig05.svg", "Fig. 5",
        "A step of the wheel from 1 to 4 N." +
            (times.empty() ? "" : " Within 5 % of the step " + times + " after the command to the wheel."),
        std::move(f));
  }

  void decay() {
    Figure f("Sinusoidal load for 20 min, 1.3 to 4.4 N, 0.25 Hz", kWidth);
    std::string text;
    for (const SensorStudy* s : {flexi_, fsr_}) {
      const Curve* c = curve_of(s, "fig6");
      if (c == nullptr) continue;
      Panel& p = f.panel(Axis{"Time", "s"}, Axis{"Output", "V", 0.0, 10.0}, kLow);
      p.title = s->sensor == "fsr" ? "FSR" : "FlexiForce";
      trace(p, column(*c, "t_s"), column(*c, "sensor_V"), s->sensor == "fsr" ? Role::model : Role::firmware);
      text += fmt::format("{} loses {:.0f} % of its swing", text.empty() ? p.title : ", the " + p.title,
                          s->exemplar.value("harmonic.fig6_loss"));
    }
    if (!f.panels().empty())
      add("fig06.svg", "Fig. 6", "Maxima fall, minima stay: " + text + ".", std::move(f));
  }

  void erratic() {
    const Curve* c = curve_of(fsr_, "fig7");
    if (c == nullptr) return;
    Figure f("FSR, 3.5 N +- 0.4 N, 0.5 Hz", kWidth);
    Panel& p = f.panel(Axis{"Time", "s"}, Axis{"Output", "V"}, kLow);
    trace(p, column(*c, "t_s"), column(*c, "sensor_V"), Role::model);
    add("fig07.svg", "Fig. 7",
        fmt::format(
            "The FSR's maxima wander: {:.1f} % of the swing from maximum to its neighbours; loss over the record {:.0f} %.",
            fsr_value("erratic.wander"), fsr_value("erratic.loss")),
        std::move(f));
  }

  void jump() {
    const Curve *c = curve_of(flexi_, "fig8"), *control = curve_of(flexi_, "fig8_control");
    if (c == nullptr) return;
    Figure f("FlexiForce, 0.5, then 2, then 3 Hz", kWidth);
    Panel& p = f.panel(Axis{"Time", "s"}, Axis{"Output", "V"}, kWide);
    trace(p, column(*c, "t_s"), column(*c, "sensor_V"), Role::firmware, "output");
    if (control != nullptr) {
      std::vector<double> t, v;
      const auto time = column(*control, "t_s"), volts = column(*control, "sensor_V"),
                 maximum = column(*control, "maximum");
      for (std::size_t i = 0; i < time.size(); i += 4)
        if (maximum[i] > 0.5) t.push_back(time[i]), v.push_back(volts[i]);
      p.line(t, v, {Role::reference, Dash::dashed, 1.4}, "maxima without the jumps");
    }
    add("fig08.svg", "Fig. 8",
        fmt::format(
            "At the first jump {:.0f} % of the lost swing come back, then the output returns to the curve that it would have followed ({:+.1f} % of it after 100 s).",
            value("jump.bump"), value("jump.return")),
        std::move(f));
  }

  void control() {
    if (const Curve* c = curve_of(flexi_, "fig9")) {
      Figure f("Force control without compensation", kWidth);
      Panel& p = f.panel(Axis{"Time", "s", 0.0, 400.0}, Axis{"Force", "N", 0.0, 5.5}, kWide);
      force_lines(p, *c);
      add("fig09.svg", "Fig. 9",
          fmt::format(
              "Set-point 1.1 to 3.2 N. The controller believes the falling sensor: the maxima of the true force rise, then the minima, "
              "and after {:.0f} s the wheel comes to its stop (paper: 150 s).",
              value("control.raw_stop")),
          std::move(f));
    }
    if (const Curve* c = curve_of(flexi_, "fig10")) {
      Figure f("Force control with compensation", kWidth);
      Panel& p = f.panel(Axis{"Time", "s"}, Axis{"Force", "N", 0.0, 5.5}, kWide);
      force_lines(p, *c);
      add("fig10.svg", "Fig. 10",
          fmt::format(
              "The same with eq. (7), b and c/a identified: MRE of the Nano17 against the set-point {:.1f} % (maxima), {:.1f} % (minima).",
              value("control.identified_maxima"), value("control.identified_minima")),
          std::move(f));
    }
    if (const Curve* c = curve_of(flexi_, "fig10_end")) {
      Figure f("Force control with compensation, the last seconds", kWidth);
      Panel& p = f.panel(Axis{"Time", "s"}, Axis{"Force", "N"}, kLow);
      p.line(column(*c, "t_s"), column(*c, "ati_N"), {Role::firmware}, "Nano17");
      p.line(column(*c, "t_s"), column(*c, "setpoint_N"), {Role::reference, Dash::dashed}, "set-point");
      add("fig11.svg", "Fig. 11", "Close-up of the end of the compensated record; dashed: set-point.",
          std::move(f));
    }
  }

  // Named in the legend: a name that stands on the line hides what is played there.
  static void level(Panel& p, const std::vector<double>& t, double force_N, std::string label) {
    p.line({t.front(), t.back()}, {force_N, force_N}, {Role::golden, Dash::dashed, 1.1}, std::move(label));
  }

  // Like the paper's: the Nano17 and the FlexiForce by eq. (1), not compensated.
  void force_lines(Panel& p, const Curve& c) {
    std::vector<double> raw_N = column(c, "sensor_V");
    const auto& k = flexi_->exemplar.calibration;
    for (double& v : raw_N) v = k.gain_N_per_V * v + k.offset_N;
    const std::vector<double> t = column(c, "t_s");
    trace(p, t, column(c, "ati_N"), Role::reference, "Nano17", 0.35);
    trace(p, t, raw_N, Role::firmware, "FlexiForce by eq. (1)", 0.5);
    const auto [low, high] = std::ranges::minmax(column(c, "setpoint_N"));
    level(p, t, low, "");
    level(p, t, high, "extrema of the set-point");
  }

  void tms() {
    const Curve* c = curve_of(fsr_, "fig12");
    if (c == nullptr) return;
    Figure f("Force control on a moving head", kWidth);
    f.share_x = true;
    Panel& position = f.panel(Axis{"Time", "s"}, Axis{"Coil position", "mm"}, 110);
    position.line(column(*c, "t_s"), column(*c, "position_mm"), {Role::model, Dash::solid, 1.0});
    Panel& force = f.panel(Axis{"Time", "s"}, Axis{"Contact force", "N", 0.0, 5.5}, kLow);
    force.line(column(*c, "t_s"), column(*c, "ati_N"), {Role::reference, Dash::solid, 0.8}, "Nano17");
    force.hline(5.0, "5 N, never to be passed", Role::fail);
    level(force, column(*c, "t_s"), 1.5, "set-point");
    add("fig12.svg", "Fig. 12",
        fmt::format(
            "FSR without compensation holds 1.5 N on a head that breathes, moves suddenly and leaves the coil: largest force {:.2f} N, "
            "noise in steady spans {:.2f} N peak to peak (paper: below 0.34 N), no contact in {:.1f} % of the time.",
            fsr_value("tms.contact"), fsr_value("tms.noise"), fsr_value("tms.lost")),
        std::move(f));
  }

  void fitting() {
    const Curve* c = curve_of(flexi_, "fig13");
    if (c == nullptr) return;
    std::vector<double> t_max, v_max, t_min, v_min;
    const auto time = column(*c, "t_s"), volts = column(*c, "sensor_V"), maximum = column(*c, "maximum");
    for (std::size_t i = 0; i < time.size(); ++i) {
      if (i % 6 != 0) continue;
      (maximum[i] > 0.5 ? t_max : t_min).push_back(time[i]);
      (maximum[i] > 0.5 ? v_max : v_min).push_back(volts[i]);
    }
    const characterize::DecayRecord* d = nullptr;
    for (const auto& r : flexi_->exemplar.decays)
      if (r.set == "series" && r.f_Hz == 0.5 && std::abs(r.A_N - 1.5) < 0.05 && std::abs(r.m_N - 2.7) < 1e-9)
        d = &r;
    if (d == nullptr || !d->fitted) return;
    std::vector<double> t, fit;
    for (int i = 0; i <= 120; ++i) {
      t.push_back(d->duration_s * i / 120.0);
      fit.push_back(d->u_min_V + d->fit.a_V * std::exp(-d->fit.b_per_s * t.back()) + d->fit.c_V);
    }
    Figure f("Curve fitting of the maxima", kWidth);
    Panel& p = f.panel(Axis{"Time", "s"}, Axis{"Output", "V", 0.0, 10.0}, kWide);
    p.points(t_max, v_max, {Role::firmware, Dash::solid, 1.0, Marker::ring, 3.5}, "maxima");
    p.points(t_min, v_min, {Role::raw, Dash::solid, 1.0, Marker::dot, 2.5}, "minima");
    p.line(t, fit, {Role::model}, "Umin + a exp(-b t) + c");
    p.hline(d->u_min_V, "Umin", Role::muted);
    add("fig13.svg", "Fig. 13",
        fmt::format(
            "Eq. (3) fitted to the maxima of 0.5 Hz, A = 1.5 N: a = {:.2f} V, b = {:.2f}e-3 1/s, c = {:.2f} V, "
            "RMSE (eq. 8) {:.3f} V (paper: 3.48 V, 7.01e-3 1/s, 0.89 V, 0.064 V).",
            d->fit.a_V, 1e3 * d->fit.b_per_s, d->fit.c_V, d->fit.rmse_V),
        std::move(f));
  }

  double value(std::string_view key) const {
    return flexi_ != nullptr ? flexi_->exemplar.value(key) : std::nan("");
  }
  double fsr_value(std::string_view key) const {
    return fsr_ != nullptr ? fsr_->exemplar.value(key) : std::nan("");
  }

  const SensorStudy *flexi_, *fsr_;
  std::vector<PaperPicture> out_;
};

}  // namespace

std::vector<PaperPicture> figures_of_the_paper(const std::vector<SensorStudy>& studies) {
  return Pictures(studies).all();
}

}  // namespace forcegate
