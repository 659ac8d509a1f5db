#include "hil/app/pictures/pictures.h"

#include <fmt/format.h>

#include "hil/app/files/own_file.h"
#include "hil/app/files/write_file.h"
#include "hil/report/diagnosis_figures.h"

namespace forcegate {

Result<std::vector<std::filesystem::path>> write_pictures(const Diagnosis& d, const RecordPictures& pictures,
                                                          const std::filesystem::path& folder, bool replaces) {
  std::vector<std::filesystem::path> out;
  const auto put = [&](const std::string& name, const figures::Figure& figure) -> Result<void> {
    out.push_back(folder / (name + ".svg"));
    if (!replaces) FORCEGATE_CHECK_OK(check_own_file(out.back(), kMarkOfPicture));
    return write_file_atomically(out.back(), figure.svg(figures::Figure::Target::standalone));
  };
  if (!d.ranking.empty()) FORCEGATE_CHECK_OK(put("ranking", ranking_figure(d)));
  if (!d.findings.empty()) FORCEGATE_CHECK_OK(put("waterfall", diagnosis_waterfall(d)));
  if (!d.records.empty()) FORCEGATE_CHECK_OK(put("records", record_error_figure(d)));
  if (!d.maps.empty()) FORCEGATE_CHECK_OK(put("map_before", residual_map_figure(d, false)));
  if (has_after(d)) FORCEGATE_CHECK_OK(put("map_after", residual_map_figure(d, true)));
  for (const ResidualMap& m : d.rig_maps) FORCEGATE_CHECK_OK(put("rig_" + m.coordinate, rig_coordinate_figure(m)));
  for (const Finding& f : d.findings) {
    if (!f.claimed()) continue;
    int number = 0;
    for (const EvidenceSeries& s : f.series)
      FORCEGATE_CHECK_OK(put(fmt::format("{}_{}", f.effect, ++number), evidence_figure(s)));
    for (const SampleWindow& w : f.samples) FORCEGATE_CHECK_OK(put(fmt::format("{}_{}", f.effect, ++number), sample_figure(w)));
  }
  int spectrum = 0, extrema = 0, drift = 0;
  for (const ResidualSpectrum& s : pictures.spectra)
    FORCEGATE_CHECK_OK(put(fmt::format("spectrum_{}", ++spectrum), spectrum_figure(s, pictures.unit, claims_hum(d))));
  for (const ExtremaDecay& e : pictures.extrema)
    FORCEGATE_CHECK_OK(put(fmt::format("extrema_{}", ++extrema), extrema_figure(e, pictures.unit)));
  if (!pictures.levels.empty()) FORCEGATE_CHECK_OK(put("levels", levels_figure(pictures)));
  for (const DriftCourse& c : pictures.drift)
    FORCEGATE_CHECK_OK(put(fmt::format("drift_{}", ++drift), drift_figure(c, pictures.unit)));
  return out;
}

}  // namespace forcegate
