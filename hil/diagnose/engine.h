#pragma once
// From a campaign to the answer: S0 to S9 in order.

#include <functional>
#include <memory>
#include <string>

#include "hil/base/result.h"
#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/diagnose/workspace.h"
#include "hil/model/model.h"
#include "hil/trace/campaign.h"

namespace forcegate::diagnose {

struct EngineOptions {
  BaseLaw law;  ///< starting model
  std::string model_name = "flexiforce";
  std::vector<UserEffect>
      user_effects;  ///< equations of the model file; those that were fitted are named in in_model
  std::vector<std::string>
      in_model;  ///< effects that the model has already: they are in the base, not candidates
  std::vector<ModelEffect> model_effects;  ///< those of the library among them
  unsigned threads = 2;
  bool pictures = true;  ///< overlays and evidence series too
  bool zero_wanders = true;  ///< one recording: its parts may differ a little in gain and zero (diagnose_campaign_in asks both ways)
  bool search = true;    ///< false: only what compare_workspace needs, no candidates and no rig channel
};

/// What is made of the samples before any model: rows, raw health, excitation. One recording is cut into its parts.
struct CampaignRows {
  CampaignInput input;
  std::vector<RecordHealth> health;  ///< per record; the parts of one recording share that of its samples
  std::vector<Edges> edges;  ///< as Workspace::edges
  std::vector<HealthClaim> raw_claims;  ///< what the samples show before any fit
  HealthScales scales;
  std::string unit = "V";  ///< of the output's column
  JudgedBy judges = JudgedBy::heldout;
};

/// S0 and S1; the campaign's samples are freed record by record.
Result<CampaignRows> take_rows(Campaign campaign, const EngineOptions& options);

/// S2 and S3.
Result<std::unique_ptr<Workspace>> prepare(CampaignRows rows, const EngineOptions& options);

/// S0 to S3.
Result<std::unique_ptr<Workspace>> prepare(Campaign campaign, const EngineOptions& options);

/// S4 to S9 on a prepared workspace. Errors (parse): the records do not determine the starting model.
Result<Diagnosis> diagnose_workspace(Workspace& workspace, const EngineOptions& options);

/// Records, maps and overlays of the base law (with the effects that the model has), without any search. Errors as diagnose_workspace.
Result<Diagnosis> compare_workspace(Workspace& workspace, const EngineOptions& options);

struct Diagnosed {
  std::unique_ptr<Workspace> workspace;
  Diagnosis diagnosis;
};

/// S0 to S9 of a campaign, with the workspace that the answer was found in. One recording is asked twice, with and without zeros of its
/// parts.
Result<Diagnosed> diagnose_campaign_in(Campaign campaign, const EngineOptions& options);
Result<Diagnosis> diagnose_campaign(Campaign campaign, const EngineOptions& options);

}  // namespace forcegate::diagnose
