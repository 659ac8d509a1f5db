#pragma once
// Jobs and records as JSON for the pipe between gate and worker. Not a file format: both ends are one build.
// Numbers that are not finite travel as the texts "nan", "inf", "-inf".

#include <string>
#include <string_view>

#include "hil/gate/case_record.h"

namespace forcegate {

std::string to_json(const CaseJob& job);
Result<CaseJob> job_from_json(std::string_view text);

std::string to_json(const CaseRecord& record);
Result<CaseRecord> record_from_json(std::string_view text);

}  // namespace forcegate
