#pragma once
// Joint refit of a model on a campaign: law, effects, and one effect more if asked. All parameters move together.

#include <vector>

#include "hil/diagnose/engine.h"
#include "hil/diagnose/refit/waterfall.h"
#include "hil/model/model.h"

namespace forcegate::diagnose {

struct ParameterMove {
  std::string name, unit;
  double before = 0.0, after = 0.0, u = 0.0;  ///< before: NaN where there was none
};

/// Whether what was added is needed: the error falls by more than a thousandth of it.
bool lowers_error(double before, double after);

struct Refit {
  Model model;
  std::vector<ParameterMove> moves;
  std::vector<std::string> notes;
  JudgedBy judged_by = JudgedBy::heldout;
  bool levels = false;  ///< an effect acts between records: they keep the gain and the zero of all of them, else each its own
  double error_before = 0.0, error_after = 0.0, floor = 0.0;  ///< held-out, adapted, V
  double plain_before = 0.0, plain_after = 0.0;
  std::vector<double> plain_after_of_record;  ///< V, in the order of the workspace's records
  Waterfall waterfall;
};

/// `add` empty: refit only. The law is linearised once, where the workspace has it. Errors (config): effect unknown, not available with these
/// channels, or not excited.
Result<Refit> refit_model(Workspace& workspace, const Model& start, const std::string& add, unsigned threads);

/// The same from a campaign's samples, begun anew where each refit ended until none of its parameters moves by more than a fiftieth of its
/// standard error (at most 10 times): a refit of what it returns changes nothing. Errors before are those of the model before, linearised where
/// that one stands. One recording is fitted with and without zeros of its parts, as a diagnosis of it is.
Result<Refit> refit_campaign(Campaign campaign, const EngineOptions& options, const Model& start, const std::string& add);

/// The same from the rows that a workspace was prepared of, whose parts may differ in zero as they do there.
Result<Refit> refit_prepared_rows(const Workspace& workspace, const EngineOptions& options, const Model& start, const std::string& add);

}  // namespace forcegate::diagnose
