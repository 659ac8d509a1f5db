#pragma once
// Joint refit of a model on a campaign: law, effects, and one effect more if asked. All parameters move together.

#include <vector>

#include "hil/diagnose/engine.h"
#include "hil/model/model.h"

namespace forcegate::diagnose {

struct ParameterMove {
  std::string name, unit;
  double before = 0.0, after = 0.0, u = 0.0;
};

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

struct Refit {
  Model model;
  std::vector<ParameterMove> moves;
  std::vector<std::string> notes;
  JudgedBy judged_by = JudgedBy::heldout;
  bool levels = false;  ///< an effect acts between records: they keep the gain and the zero of all of them, else each its own
  double error_before = 0.0, error_after = 0.0, floor = 0.0;  ///< held-out, adapted, V
  double plain_before = 0.0, plain_after = 0.0;
  Waterfall waterfall;
};

/// `add` empty: refit only. Errors (config): effect unknown, not available with these channels, or not excited.
Result<Refit> refit_model(Workspace& workspace, const Model& start, const std::string& add, unsigned threads);

/// The same from a campaign's samples. One recording is fitted with and without zeros of its parts, as a diagnosis of it is.
Result<Refit> refit_campaign(Campaign campaign, const EngineOptions& options, const Model& start, const std::string& add);

}  // namespace forcegate::diagnose
