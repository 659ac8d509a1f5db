#pragma once
// Screening and choice in the three comparisons of a campaign: the output against the reference, the reference against the rig's own law, what the
// drive makes of its command.

#include <string>
#include <vector>

#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/engine.h"
#include "hil/diagnose/raw/health_claims.h"

namespace forcegate::diagnose {

struct Search {
  SelectionRules rules, rig_rules, drive_rules;
  Selection output, rig, drive;     ///< rig and drive: base not valid where the campaign has no such channel
  std::vector<std::string> skip;    ///< families that the output was not asked for
  std::vector<Finding> suspicions;  ///< chosen in the output once, and not borne out by left-out records
  std::vector<std::string> begun_anew;  ///< why it was looked through once more
};

/// What the raw samples have shown is not looked for again. May set `judges`.
Search search_channels(Workspace& workspace, const EngineOptions& options);

}  // namespace forcegate::diagnose
