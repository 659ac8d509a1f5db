#pragma once
// A FlexiForce A201-100 as what Paredes-Madrid et al. 2010 found it to be: a resistance R_s(F) parallel to a capacitance
// C_s(F) up to a divergence frequency, with a conductance that repeats less well than the capacitance.
//
// Mechanism (the law of parallel RC is the paper's, its physics ours):
//  - Static: G = g F (1 + bend), C = C_0 + c F (1 + bend). Both carry the mean state of the contacts.
//  - Repeatability: a loading leaves the contacts at another mean gap s than the one before, and they slip in little
//    jumps while weights are added ("little step jumps", V-A). Tunnelling makes G ~ exp(-2 kappa s), the plates make
//    C ~ 1/s: one relative change of the gap moves the conductance by lambda = 2 kappa s times what it moves the
//    capacitance. Besides, each has its own part (paths through the ink; rim and leads).
//  - Creep: the gap closes with the logarithm of the time under load, again lambda times stronger in the conductance.
//  - Hysteresis: one play operator on the force.
//  - Beyond the divergence frequency: interfacial polarisation (Maxwell, Wagner, Sillars), a band of relaxations whose
//    lower end is the specimen's own. Their loss adds to the conductance, their share of the capacitance fades, and the
//    phase saturates, as the paper sees; causal (Kramers-Kronig), so a phase that saturates costs some capacitance.
//
// Where the numbers come from is told at draw_rc_specimen().

#include <complex>
#include <cstdint>
#include <vector>

#include "hil/base/rng.h"

namespace forcegate::emulated {

/// What stays with a specimen.
struct RcSpecimen {
  double g_S_per_N = 26.7e-9;  ///< 1/R_s = 6.7 uS at 250 N
  double c0_F = 200e-12;
  double c_F_per_N = 1.8e-12;         ///< C_s = 650 pF at 250 N
  double bend_g = 0.0, bend_c = 0.0;  ///< largest departure from the line, share of 250 N
  double divergence_Hz = 5750.0;      ///< where the phase lies about 3 degrees below that of R_s parallel C_s
  double repeat_g_N = 0.635;          ///< conductance: rms over the range of what does not repeat, as a force
  double repeat_c_N = 0.356;          ///< capacitance: the same
  double creep_per_decade = 0.02;     ///< of the conductance
  double play_share = 0.03;
};

/// Draws:
///  - divergence 4.5 to 7 kHz, uniform (V-A); slopes 20 %, C_0 8 %, c 10 % ("slightly different from one sensor to
///    other" for the capacitance, VI; values read from the axes of Figs. 9 and 11).
///  - errors of the conductance: Table I's eight roots have the median 0.82 N and the logarithmic spread 0.35. What part of
///    them is curvature and what does not repeat the paper does not say. The network takes curvature away: that it is best
///    in seven of eight (Fig. 10) speaks for much, what it leaves over in Table I for little. Two fifths of the variance:
///    bend_g 0.70 % (0.52 N rms about the best line), repeat_g 0.635 N. The maker allows 3 % of 440 N.
///  - errors of the capacitance: of no number in the text. Fig. 10 says: below the conductance for all eight, and the mean of
///    both models beats either in three of eight. The mean does so where the conductance's error is less than 1.6 times the
///    capacitance's, so the median ratio is set to 1.8: 0.46 N, divided likewise (bend_c 0.39 %, repeat_c 0.356 N). Its
///    spread is the smaller one (0.15): where the conductance was bad the network stayed good.
///  - creep 2 % a decade (maker: below 5 %) and play 3 %: ours.
/// All normal draws are cut at two standard deviations.
RcSpecimen draw_rc_specimen(std::uint64_t seed, std::uint64_t set, std::uint64_t sensor);

/// Admittance at rest of the film's state: G, C at low frequency.
struct RcState {
  double conductance_S = 0.0;
  double capacitance_F = 0.0;
};

class RcSensor {
 public:
  /// Fresh from `rest_before_s` without load; rng gives everything that this loading does not share with another.
  void begin(const RcSpecimen& specimen, Rng rng, double rest_before_s);

  void load(double force_N, double hold_s);

  RcState state() const;
  /// Y(f) in siemens.
  std::complex<double> admittance_S(double f_Hz) const;
  double force_N() const { return force_N_; }

 private:
  struct Increment {
    double force_N, at_s;
  };
  double creep_N() const;

  RcSpecimen p_;
  Rng rng_{0};
  double force_N_ = 0, play_N_ = 0, time_s_ = 0, residue_N_ = 0;
  std::vector<Increment> increments_;
  double own_c_N_ = 0;                                // rms of the capacitance's own part
  double gain_common_ = 0, gain_g_ = 0, gain_c_ = 0;  // relative, in terms of force
  double slip_common_N_ = 0, slip_g_N_ = 0, slip_c_N_ = 0;
};

}  // namespace forcegate::emulated
