#pragma once
// How much two runs of one campaign differ: the size of what makes the difference.

#include <vector>

#include "rigs/emulated/hidden/effect.h"
#include "rigs/emulated/hidden/plant.h"

namespace forcegate::hidden {

struct Difference {
  double rms = 0.0;          ///< V or N, beyond the best gain and offset, most changed third of the records
  double plain_rms = 0.0;    ///< V or N, all samples
  double heldout_rms = 0.0;  ///< as rms, over all samples of the held-out records
  std::vector<double> record_rms;  ///< plain, per record
};

/// The channel that a measure is of; the force as it was before rounding.
const std::vector<double>& column_of(const RecordData& record, Measure measure);

/// `with` and `without` have the same plans; missing samples are left out.
Difference difference(const std::vector<RecordData>& with, const std::vector<RecordData>& without,
                      Measure measure);

/// Largest minus smallest value of the channel over the campaign, missing samples left out.
double span_of(const std::vector<RecordData>& records, Measure measure);

}  // namespace forcegate::hidden
