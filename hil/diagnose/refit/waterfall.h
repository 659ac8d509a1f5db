#pragma once
// Which effect of a model takes how much off the held-out error: as added, and averaged over all orders (Shapley 1953).

#include <string>
#include <vector>

namespace forcegate::diagnose {

struct Waterfall {
  struct Bar {
    std::string effect;
    double as_added = 0.0;  ///< fall of the held-out error in the order given; NaN: a fit on the way failed
    double average = 0.0, low = 0.0,
           high = 0.0;    ///< over all orders where they were asked, else as added; NaN as above
    bool hollow = false;  ///< the range holds 0, or is not known
  };
  bool all_orders = true;  ///< false: more than 4 effects, asked in the order given only
  double start = 0.0, end = 0.0, floor = 0.0;
  std::string unit = "V";  ///< of the output's column
  std::vector<Bar> bars;
};

/// Held-out errors with some of the effects beside the law: with every subset of up to 4 (bit k: the k-th effect is in), of more with the first
/// 0, 1, 2 ... in their order. NaN: that fit failed.
struct ErrorsOfEffects {
  std::vector<std::string> effects;
  std::vector<double> error;

  static bool asks_all_orders(std::size_t effects) { return effects <= 4; }
  bool all_orders() const { return asks_all_orders(effects.size()); }
};

/// Bars in the order of the effects; floor and unit are left as they are by default.
Waterfall waterfall_of(const ErrorsOfEffects& errors);

}  // namespace forcegate::diagnose
