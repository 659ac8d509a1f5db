#pragma once
// The same question one floor up: which law of a fitted parameter is missing a dependence? Given a, b, c, c/a, a gain ...
// of n records and what was different between them (frequency, amplitude, mean, rest, temperature, cycles), a law
//
//   g(y_i) = beta_0 + sum_k beta_k t_k(x_i) + e_i,   t_k in {x, ln x, 1/x, x^2, x z},  g in {y, ln y, 1/y}
//
// is searched for the term that it lacks. n counts records, never samples.
//
// Test: the F statistic of the best of all candidate terms against its distribution when the residuals of the law are
// permuted over the records (Freedman and Lane 1983), the maximum over the candidates being taken in every permutation
// (Westfall and Young 1993): the error probability holds for the whole search, whatever the correlation of the candidates
// and without assuming normal errors. Forward steps until nothing is significant. Leave-one-out errors are exact (PRESS).
// Weights 1/(u_i^2 + s^2) where uncertainties are given; s, the scatter between records, is estimated by moments.

#include <cstdint>
#include <string>
#include <vector>

#include "hil/base/result.h"

namespace forcegate {

struct Covariate {
  std::string name, unit;
  std::vector<double> value;  ///< one per record
};

enum class TermForm { linear, logarithm, reciprocal, square, product };

/// A function of one covariate, or the product of two.
struct LawTerm {
  TermForm form = TermForm::linear;
  std::string covariate, other;  ///< `other` only for a product
};
std::string to_string(const LawTerm& term);  ///< "f", "ln f", "1/f", "f^2", "f m"
/// Reads what to_string writes, and "f*m". Error: usage.
Result<LawTerm> parse_term(std::string_view text);

enum class ResponseScale { linear, logarithm, reciprocal };

struct ParameterQuestion {
  std::string name, unit;
  std::vector<double> value;
  std::vector<double> u;  ///< standard uncertainties; empty: unknown and equal
  std::vector<Covariate> covariates;
  std::vector<LawTerm> law;  ///< what the law has already; the constant always
  ResponseScale scale = ResponseScale::linear;
  double alpha = 0.05;  ///< of a false dependence in this question (all candidates together)
  int permutations = 1999;
  std::uint64_t seed = 1;
};

/// One candidate beside the law as it stood in that step.
struct RankedTerm {
  LawTerm term;
  double F = 0.0;
  double p_alone = 1.0;    ///< permutation, this candidate only
  double p = 1.0;          ///< permutation, maximum over all candidates
  double loo_after = 0.0;  ///< leave-one-out RMS with it
  double r2 = 0.0;         ///< share of the law's residual that it takes away
};

struct LawCoefficient {
  std::string term;  ///< "1" for the constant
  double value = 0.0, u = 0.0;
};

struct FoundTerm {
  RankedTerm found;
  double loo_before = 0.0;
  std::vector<LawTerm> fits_as_well;  ///< signatures with |cos| > 0.95, beside which the found term is not significant (alone, at alpha)
};

struct ParameterAnswer {
  std::string name, unit;
  std::string response;  ///< g(y), of which the law is: "ca", "ln ca", "1/ca"
  std::size_t n = 0, candidates = 0;
  std::vector<FoundTerm> added;
  std::vector<RankedTerm> ranking;  ///< candidates beside the given law, best first
  std::vector<LawCoefficient> law;  ///< final law
  double loo_constant = 0.0, loo_before = 0.0, loo_after = 0.0;  ///< leave-one-out RMS in the units of g(y)
  double scatter = 0.0;         ///< s: what is left between records, same units
  double smallest_share = 0.0;  ///< a dependence must take this share of the residual to be seen with these n
  std::string sentence;
};

/// Errors: usage (unequal lengths, unknown covariate, fewer than 6 records, a scale that the values do not allow).
Result<ParameterAnswer> missing_dependence(const ParameterQuestion& question);

}  // namespace forcegate
