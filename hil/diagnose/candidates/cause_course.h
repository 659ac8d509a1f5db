#pragma once
// What a recorded cause does within records: where it runs on, rows tell of it, and where it hardly does, only the records' levels.

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Whether the candidate's cause, behind its form's own lag, runs through a quarter and more of what the campaign runs through within one record.
/// False where its form knows one number for each record (EffectForm::cause).
bool runs_within_records(const CampaignInput& campaign, const Candidate& candidate);

}  // namespace forcegate::diagnose
