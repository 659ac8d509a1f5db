#pragma once
// `forcegate compare`: how far is the model from the data, and where does it fail.

#include "hil/app/model/model_input.h"
#include "hil/report/record_pictures.h"

namespace forcegate {

struct ModelComparison {
  Diagnosis view;     ///< records, maps, overlays of the refitted base; no findings
  struct AsWritten {  ///< the model file's own numbers, nothing refitted
    std::string record;
    double rmse_V = 0.0, relative = 0.0;  ///< eq. (8); RMS over the RMS swing of U. NaN where the model gives another unit than the record holds
    double swing = 0.0;                   ///< RMS swing of the model's output over that of U
  };
  std::vector<AsWritten> as_written;
  RecordPictures pictures;
  bool too_short = false;  ///< one recording, of which no diagnosis can be made
};

/// `pictures`: those beside the view too.
Result<ModelComparison> compare_request(const CampaignRequest& request, bool pictures = false);
std::string comparison_text(const ModelComparison& comparison);
std::string comparison_json(const ModelComparison& comparison);

}  // namespace forcegate
