#pragma once
// One number per record (its gain, its zero) against what was different between the records. n counts records.
//
//   y_i = mu + x_i' c + zeta_i + e_i,   zeta ~ N(0, s^2 (I + k G + l H + w K)),  e_i ~ N(0, v_i),  c_j ~ N(0, t^2 w_j)
//
// G_ij = 1 where i and j belong to one session: records of a session may hang together, and a predictor that only tells the
// sessions apart explains nothing. H_ii = 1 where record i is cyclic: its gain and zero hang on how well its decay is known, which its own
// variance tells only as far as the law of the decay is right. K_ij falls with the time between i and j: a course over the campaign that nobody
// recorded, a rival where the question is whether records jump (start_s). mu is flat (REML); s is integrated out over a lognormal prior (a factor of 3 about what
// specimens typically repeat to: few records that fit too well are chance, not evidence), k, l, w and t over a few values. The score is the logarithm of the Bayes factor against x = 0 (Kass and Raftery 1995).

#include <Eigen/Dense>
#include <vector>

namespace forcegate::diagnose {

struct RecordSeries {
  Eigen::VectorXd value, variance;  ///< estimate of each record and variance of its measurement
  std::vector<int> session;         ///< empty: every record stands alone
  std::vector<int> cyclic;          ///< 1: under cyclic load; empty: none is
  double typical_scatter = 5e-3;    ///< median of the prior of s
  std::vector<int> alike = {};      ///< 1: records of one kind of load, which may all be off by as much; empty: none are
  std::vector<double> start_s = {}; ///< empty: no course over time is a rival
};

/// Columns that one strength each multiplies; weight: relative prior variance of the strengths. Scaled by normalise() so that a
/// size of 1 moves the records by an RMS of 1 about their mean.
struct RecordPredictor {
  Eigen::MatrixXd column;
  Eigen::VectorXd weight;
  bool positive = false;  ///< one column whose strength physics allows one sign only: the prior is the upper half
  bool alone = false;     ///< it stands in the place of sessions and courses: beside them it has no evidence
};
/// ln 2 Phi(z): what a prior of one sign alone changes, z the posterior mean over its standard deviation.
double log_one_sided(double z);

/// Factor by which the columns were multiplied; 0: they are the same for all records and the predictor is empty.
double normalise(RecordPredictor& predictor);

struct RecordScore {
  double gain = -1e300;    ///< ln Bayes factor
  double explained = 0.0;  ///< share of the spread between records, s^2 (1 + k), that goes away (geometric mean over s, k, l)
  double left_out = 1.0;   ///< mean square error of records predicted from others that x links them to, over the same without x
  Eigen::VectorXd added;   ///< what the columns add to each record, mean 0
};

/// Scores of several predictors of one series, each by itself. `sizes`: values of t. Fewer than 4 records: no score. Of those that stand in the
/// place of sessions and courses, which are many, the best one of each number of columns has more than its gain.
std::vector<RecordScore> score_predictors(const RecordSeries& series, const std::vector<RecordPredictor>& predictors,
                                          const std::vector<double>& sizes);

/// ln of the mean evidence of alternatives: one of the series moves, or all of them. `gains`: per series, ln of the mean Bayes
/// factor over its predictors.
double joint_gain(const std::vector<double>& gains);

/// ln(mean(exp(x))).
double log_mean_exp(const std::vector<double>& x);

}  // namespace forcegate::diagnose
