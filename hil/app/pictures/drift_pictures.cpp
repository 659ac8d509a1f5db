#include <algorithm>

#include "hil/app/pictures/record_pictures.h"
#include "hil/diagnose/laws/drift.h"

namespace forcegate {

RecordPictures drift_pictures(const Campaign& campaign, const std::string& form) {
  RecordPictures out;
  for (const Record& record : campaign.records) {
    if (out.drift.size() == kMostRecordPictures) break;
    const Channel* U = diagnose::output_of(record);
    if (U == nullptr) continue;
    out.unit = U->unit;
    const std::vector<double>& t_s = record.trace.time_bases[U->time_base].t_s;
    const auto fitted = diagnose::fit_drift(record.name, t_s, U->value);
    if (!fitted) continue;
    const auto fit = std::find_if(fitted->fits.begin(), fitted->fits.end(), [&](const auto& f) { return form.empty() || f.law->name == form; });
    if (fit == fitted->fits.end()) continue;
    diagnose::DriftBlocks blocks = diagnose::drift_blocks(t_s, U->value);
    DriftCourse course{record.name, std::string(fit->law->name), std::move(blocks.t_s), std::move(blocks.y), {}, fitted->noise};
    for (const double t : course.t_s) course.modelled.push_back(diagnose::value_at(*fit, t));
    out.drift.push_back(std::move(course));
  }
  return out;
}

}  // namespace forcegate
