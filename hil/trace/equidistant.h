#pragma once
// A record as firmware reads it: one row each sample period, lost ones too.

#include <cstdint>
#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/trace/trace.h"

namespace forcegate {

/// Which row of the record a sample period shows, and whether that one is only held.
struct GridRow {
  std::uint32_t source = 0;
  bool lost = false;
};

struct EquidistantGrid {
  enum class Kind {
    as_stamped,  ///< steps within 1 % of the nominal one: row by row
    on_a_line,   ///< stamps scatter about an even clock by less than one period: row by row, since that clock has sampled
    held,        ///< neither: sampled at the nominal rate, the latest row held (zero-order hold)
  };
  double rate_Hz = 0.0;
  Kind kind = Kind::as_stamped;
  double scatter_s = 0.0;  ///< on_a_line: the largest distance of a stamp from the even clock
  std::size_t lost = 0;
  std::vector<GridRow> rows;
};

/// Gaps are filled with the row before them, marked as lost. A rate within 0.1 % of a whole number of hertz, or within three times its
/// uncertainty where the stamps scatter, is that number.
/// Errors (config, naming `where`): fewer than two samples, no sample rate, a gap of more than 1e7 periods, more than 4e9 periods in all.
Result<EquidistantGrid> equidistant_grid(const TimeBase& base, const std::string& where);

}  // namespace forcegate
