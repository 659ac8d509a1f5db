#include <algorithm>
#include <cmath>

#include "hil/app/record_pictures.h"
#include "hil/diagnose/laws/drift.h"

namespace forcegate {
namespace {

double law_of_time(const diagnose::DriftFit& fit, double t_s) {
  const double s = std::max(0.0, t_s - fit.onset_s);
  double course = 0.0;
  if (fit.form == "line") course = s;
  if (fit.form == "exponential") course = std::exp(-s / fit.shape);
  if (fit.form == "logarithm") course = std::log10(1.0 + s / fit.shape);
  if (fit.form == "power") course = std::pow(s, fit.shape);
  return fit.constant + fit.size * course;
}

}  // namespace

RecordPictures drift_pictures(const Campaign& campaign, const std::string& form) {
  constexpr std::size_t kBlocks = 200;
  RecordPictures out;
  for (const Record& record : campaign.records) {
    if (out.drift.size() == kMostRecordPictures) break;
    const Channel* U = diagnose::output_of(record);
    if (U == nullptr) continue;
    out.unit = U->unit;
    const std::vector<double>& t_s = record.trace.time_bases[U->time_base].t_s;
    const auto fitted = diagnose::fit_drift(record.name, t_s, U->value);
    if (!fitted) continue;
    const auto fit = std::find_if(fitted->fits.begin(), fitted->fits.end(), [&](const auto& f) { return form.empty() || f.form == form; });
    if (fit == fitted->fits.end()) continue;
    std::vector<std::size_t> good;
    for (std::size_t i = 0; i < U->value.size(); ++i)
      if (std::isfinite(U->value[i])) good.push_back(i);
    DriftCourse course{record.name, fit->form, {}, {}, {}, fitted->noise};
    const std::size_t n = std::min(kBlocks, good.size());
    for (std::size_t b = 0; b < n; ++b) {
      const std::size_t from = b * good.size() / n, to = (b + 1) * good.size() / n;
      double t = 0.0, y = 0.0;
      for (std::size_t k = from; k < to; ++k) t += t_s[good[k]] - t_s[good.front()], y += U->value[good[k]];
      course.t_s.push_back(t / static_cast<double>(to - from));
      course.measured.push_back(y / static_cast<double>(to - from));
      course.modelled.push_back(law_of_time(*fit, course.t_s.back()));
    }
    out.drift.push_back(std::move(course));
  }
  return out;
}

}  // namespace forcegate
