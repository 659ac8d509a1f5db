#pragma once
// Pictures that several reports share.

#include <initializer_list>
#include <string>
#include <vector>

#include "hil/report/figures/figure.h"

namespace forcegate::figures {

/// One step of an error waterfall: adding `name` took the error from `before` to `after`.
struct WaterfallStep {
  std::string name;
  double before = 0.0, after = 0.0;
  double u = 0.0;       ///< standard uncertainty of before - after; 0 = not known
  bool claimed = true;  ///< false: drawn hollow whatever u says
};

/// First bar: the error at the start; then one hanging bar a step, hollow when |before - after| <= 2 u or not
/// claimed; last bar: the error at the end. A dotted line at `noise_floor` (NaN = unknown). `not_claimed`: what the summary says of a
/// bar that is hollow for that reason.
Figure waterfall(const std::string& title, const std::string& start, const std::vector<WaterfallStep>& steps,
                 const std::string& end, const std::string& unit, double noise_floor,
                 const std::string& not_claimed = "was taken in to look at the rest and is not claimed");

/// Before and after of many things, one row each: ring, line, dot; one dot where all are as they were; a small tick at the row's floor
/// (NaN = none).
struct BeforeAfter {
  std::string name;
  double before = 0.0, after = 0.0, floor = kAuto;
};
Figure before_after_rows(const std::string& title, const std::vector<BeforeAfter>& rows,
                         const std::string& quantity, const std::string& unit);

/// y over x split by the sign of `direction` (0: held; empty: not split): a density per direction when there are more
/// than 800 points, marks otherwise. `y_reach` > 0 sets the y range to +-y_reach.
void add_directed(Panel& panel, const std::vector<double>& x, const std::vector<double>& y,
                  const std::vector<double>& direction, double y_reach);

/// Lines end where samples are missing: puts NaN into every y between two samples that lie more than four usual steps of x
/// apart, and more than `least`. x of one sign of step; fewer than four samples stay as they are.
void break_at_gaps(std::vector<double>& x, std::initializer_list<std::vector<double>*> y, double least = 0.0);

/// Value with two or three digits and the SI prefix that makes it readable: 0.0123 V -> {12.3, "mV"}; a ratio, unit "1", in percent.
struct Scaled {
  double factor = 1.0;
  std::string unit;
};
Scaled readable_unit(double magnitude, const std::string& unit);

}  // namespace forcegate::figures
