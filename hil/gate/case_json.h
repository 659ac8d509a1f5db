#pragma once
// Jobs, records and effective plans as JSON, for the pipe between gate and worker and for bundles. A field that a text of
// an older build does not have keeps its default; unknown ones are passed over.
// Numbers that are not finite travel as the texts "nan", "inf", "-inf".

#include <string>
#include <string_view>

#include "hil/gate/case_record.h"

namespace forcegate {

std::string to_json(const CaseJob& job);
Result<CaseJob> job_from_json(std::string_view text);

std::string to_json(const CaseRecord& record);
Result<CaseRecord> record_from_json(std::string_view text);

/// The plan as it was played: overrides of the command line are in it, its path is not.
std::string to_json(const Plan& plan);
Result<Plan> plan_from_json(std::string_view text);

}  // namespace forcegate
