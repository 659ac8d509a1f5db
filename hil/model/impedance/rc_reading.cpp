#include "hil/model/impedance/rc_reading.h"

#include <cmath>
#include <complex>

namespace forcegate::impedance {
namespace {

using Complex = std::complex<double>;
constexpr double kPi = 3.14159265358979323846;
constexpr double kThirdHarmonic = 0.01;

// H = -x / (1 + (1 + x) j f/GBW) solved for x = R_g Y.
Complex loop_of(Complex transfer, double f_Hz, double gain_bandwidth_Hz) {
  const Complex lag{0.0, gain_bandwidth_Hz > 0.0 ? f_Hz / gain_bandwidth_Hz : 0.0};
  return -transfer * (1.0 + lag) / (1.0 + lag * transfer);
}

}  // namespace

RcReading rc_reading(const Phasor& phasor, double source_V, double f_Hz, const Circuit& circuit) {
  // sin has the phasor 1: v = Re sin part + j cos part
  const Complex transfer = Complex{phasor.in_phase_V, phasor.quadrature_V} / source_V;
  const Complex loop = loop_of(transfer, f_Hz, circuit.gain_bandwidth_Hz);
  const Complex y = loop / circuit.feedback_ohm;
  const double w = 2.0 * kPi * f_Hz;
  RcReading out;
  out.f_Hz = f_Hz;
  out.amplitude_V = std::abs(transfer * source_V);
  out.conductance_S = y.real();
  out.capacitance_F = y.imag() / w;
  out.phase_rad = std::arg(y);
  const double noise_S = phasor.u_V / std::abs(source_V) / circuit.feedback_ohm;
  const Complex moved =
      circuit.gain_bandwidth_Hz > 0.0
          ? loop_of(transfer, f_Hz, circuit.gain_bandwidth_Hz * (1.0 + circuit.gain_bandwidth_u_rel)) /
                    circuit.feedback_ohm -
                y
          : Complex{0.0, 0.0};
  const auto combine = [&](double value, double turned) {
    return std::sqrt(noise_S * noise_S + turned * turned + std::pow(value * circuit.feedback_u_rel, 2));
  };
  out.u_conductance_S = combine(y.real(), moved.real());
  out.u_capacitance_F = combine(y.imag(), moved.imag()) / w;
  out.u_phase_rad = std::hypot(noise_S / std::abs(y), (moved / y).imag());
  const double third_noise = 3.0 * phasor.u_V / out.amplitude_V;
  out.saturated = phasor.clipped > 0 || phasor.third_harmonic > kThirdHarmonic + third_noise;
  return out;
}

RcReading dc_reading(const Level& level, double source_V, const Circuit& circuit) {
  RcReading out;
  out.amplitude_V = std::abs(level.mean_V);
  out.conductance_S = -level.mean_V / source_V / circuit.feedback_ohm;
  out.u_conductance_S =
      std::hypot(level.u_V / source_V / circuit.feedback_ohm, out.conductance_S * circuit.feedback_u_rel);
  out.saturated = level.clipped > 0;
  return out;
}

}  // namespace forcegate::impedance
