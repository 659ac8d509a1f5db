#pragma once
// From recordings to what models see: block means at no more than 50 rows a second, excitation facts, travel.

#include <span>

#include "hil/base/result.h"
#include "hil/model/record_input.h"

namespace forcegate {

/// Rows of one record. `bad` (may be empty) marks full-rate samples that must not count. Channels are put on the
/// clock of F_ref. Missing forces are held for the state machines; their rows are not ok.
/// Errors: no F_ref or no U channel, fewer than 16 samples.
Result<RecordInput> make_record_input(const Record& record, std::span<const std::uint8_t> bad = {});

/// Sorts by campaign time and fills in what depends on all records: ranges, travel, start times, excitation
/// (declared values first, estimates otherwise, each estimate told in `notes`).
void finish_campaign_input(CampaignInput& campaign);

/// Reads nothing; convenience for callers that need no raw health: all records, then finish.
Result<CampaignInput> make_campaign_input(const Campaign& campaign);

/// q-quantile (0..1) of finite values; NaN when there are none.
double quantile(std::vector<double> values, double q);

/// Facts of the excitation of one record from its rows: dynamic, onset, f, A, F_min, frequency jumps.
void estimate_excitation(RecordInput& record, const Record* declared, double range_N);

}  // namespace forcegate
