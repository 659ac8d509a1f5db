#pragma once
// Terms of a sum of exponentials that the records tell. A term of a thousand seconds beside records of a hundred is told by what noise makes of its
// first tenth, and a compensator would go on with it for hours.

#include <cstddef>
#include <string>
#include <vector>

#include "hil/diagnose/refit/best_form.h"
#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Whether a record is half as long as the time constant of column `strength` of the form, and shows 40 % of it; true of columns without one.
bool is_seen(const EffectForm& form, std::size_t strength, const CampaignInput& input);

/// Says once which terms of the form are not.
void note_unseen(const EffectKind& kind, const EffectForm& form, const CampaignInput& input, std::vector<std::string>& notes);

/// The columns of a variant that are seen, all where none is; `notes` tell of the others.
std::vector<int> seen_columns(const Workspace& workspace, int variant, std::vector<std::string>& notes);

/// Forms beside each other and what a model file brings may have them again: fitted anew beside the `present` columns without what is not seen, told
/// in `notes`. As they are where none of the columns is seen.
void leave_out_unseen(const Workspace& workspace, const std::vector<int>& present, WrittenForms& forms, std::vector<std::string>& notes);

}  // namespace forcegate::diagnose
