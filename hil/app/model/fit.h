#pragma once
// `forcegate fit` and `forcegate add`: joint refit of a model on a campaign, with one effect more or without.

#include "hil/app/model/model_input.h"
#include "hil/diagnose/refit/refit.h"

namespace forcegate {

/// `add` empty: refit only.
Result<diagnose::Refit> fit_request(const CampaignRequest& request, const std::string& add);
/// The same with a model in place of the one that the request names.
Result<diagnose::Refit> fit_request(const CampaignRequest& request, const Model& model, const std::string& add);
/// Whether what was added lowers the error.
bool is_needed(const diagnose::Refit& refit);
/// Whether it does not, and plainly lowers that of one gain, zero and decay for all records.
bool helps_one_law(const diagnose::Refit& refit);
std::string refit_text(const diagnose::Refit& refit, const std::string& add, bool notes = true);
std::string refit_json(const diagnose::Refit& refit, const std::string& add);
std::string waterfall_text(const diagnose::Waterfall& waterfall);
std::string waterfall_json(const diagnose::Waterfall& waterfall);

}  // namespace forcegate
