#pragma once
// Uncertainty of what is not linear: the time constant, the threshold, the exponent of a form. Gauss-Newton: beside the columns of the fit
// stands one column more for each continuous shape, d/dp sum_j c_j S_j(p), and their joint covariance at the variances of the fit holds the
// shapes, and the strengths with what the shapes leave open (Seber and Wild 1989, Nonlinear Regression, 2.1).

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

struct ShapeCovariance {
  struct Shape {
    int variant = 0;
    std::size_t index = 0;
  };
  Eigen::MatrixXd covariance;  ///< coefficients of the fit, then shapes
  std::vector<Shape> shapes;   ///< those that are continuous
  Eigen::VectorXd step;        ///< of each shape, to where the residual asks it (one Gauss-Newton step, all together with the coefficients)

  /// Standard uncertainties, k = 1, in units of the parameter; 0 for a shape that is chosen from a list.
  double of_coefficient(Eigen::Index at) const;
  double of_shape(int variant, std::size_t index) const;
};

/// d/dp of what a variant adds, newtons on all rows of the record, the strengths being those of the fit. Zero where its bounds leave no room.
Eigen::VectorXd shape_derivative(const CampaignInput& campaign, const ResidualChannel& channel, const MixedFit& fit, const ShapeCovariance::Shape& shape,
                                 const RecordInput& record);

/// Of the variants of a valid fit. What a shape's bounds allow is known before: u never exceeds their distance.
ShapeCovariance shape_covariance(const CampaignInput& campaign, const ResidualChannel& channel, const MixedFit& fit, const std::vector<int>& variants);

}  // namespace forcegate::diagnose
