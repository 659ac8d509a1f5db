#pragma once
// A line of the spectrum of some samples by itself: where it lies, how strong it is, and whose it may be besides the mains'.

#include <cmath>
#include <vector>

namespace forcegate::diagnose {

// A unit vector that turns by the same angle at every sample.
struct Rotation {
  explicit Rotation(double angle) : c(std::cos(angle)), s(std::sin(angle)) {}
  void step() {
    const double next = re * c - im * s;
    im = re * s + im * c;
    re = next;
  }
  double c, s, re = 1.0, im = 0.0;
};

// What a line is looked for in: the output less `force_V_per_N` times the force, 0 where the output alone shows more.
struct Seen {
  const std::vector<double>&F, &U;
  double force_V_per_N;
  double at(std::size_t i) const { return force_V_per_N == 0.0 ? U[i] : U[i] - force_V_per_N * F[i]; }
};

struct LinePeak {
  double off_Hz, resolution_Hz;
};

/// Where the power beside `f_Hz` has its peak, to the resolution of the record or of a minute. Samples follow each other at `rate_Hz`.
LinePeak peak_beside(const Seen& seen, double f_Hz, double rate_Hz);

/// Whatever repeats f/n times a second, such as stick-slip, has a line there too, and the n-th is no stronger than the first and than those
/// before it (every second one may be missing). Lines that the mains themselves put there are no witnesses.
bool is_harmonic_of_another(const Seen& seen, double f_Hz, double mains_Hz, double rate_Hz);

/// How often a load goes up through its mean, a tenth of its range beyond it on either side, from the first time to the last; 0: hardly ever.
double cycles_per_s(const std::vector<double>& F_N, double rate_Hz);

/// A law that the model lacks repeats with the load: its lines stand at whole multiples of the load's frequency, one or two of them further down
/// as strong as this one.
bool is_of_load(const Seen& seen, double f_Hz, double rate_Hz);

}  // namespace forcegate::diagnose
