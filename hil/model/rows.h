#pragma once
// From recordings to what models see: block means at no more than 50 rows a second, excitation facts, travel.

#include <span>

#include "hil/base/result.h"
#include "hil/model/record_input.h"
#include "hil/trace/row_length.h"

namespace forcegate {

/// Parts of a record that cost as much as all the rest, and that only effects read.
struct RowParts {
  bool full_rate = true;  ///< fast_t_s, fast_F_N
  bool angle = true;      ///< sin_theta, cos_theta, late_cos_theta
};

/// Rows of one record, about equally long in time also where the rate of sampling changes. `bad` (may be empty) marks full-rate samples that must not count. Channels are put on the
/// clock of F_ref. Missing forces are held for the state machines; their rows are not ok.
/// Errors: no F_ref or no U channel, fewer than 16 samples.
/// `row_step_s`: aimed at; never less than one sample.
Result<RecordInput> make_record_input(const Record& record, std::span<const std::uint8_t> bad = {},
                                      double row_step_s = kRowStep_s, const RowParts& parts = {});

/// The same; the full-rate clock and force are taken out of the record's trace instead of copied.
Result<RecordInput> take_record_input(Record& record, std::span<const std::uint8_t> bad, double row_step_s,
                                      const RowParts& parts);

/// rate_N_per_s of the rows from F_N: central differences, 0 at both ends.
void set_rates(RecordInput& record);

/// Whether there is a hole before this row: a step above `longest_step_s`, and not one of several alike, as where a logger goes on more slowly.
bool follows_hole(const RecordInput& record, std::size_t row, double longest_step_s);

/// Sorts by campaign time and fills in what depends on all records: ranges, travel, start times, excitation
/// (declared values first, estimates otherwise, each estimate told in `notes`).
void finish_campaign_input(CampaignInput& campaign, unsigned threads = 1);

/// Samples of every record.
std::vector<std::size_t> sample_counts(const Campaign& campaign);

/// Reads nothing; convenience for callers that fit nothing: all records, then finish. `bad`: of each record, as in make_record_input; empty: none.
Result<CampaignInput> make_campaign_input(const Campaign& campaign, unsigned threads = 1, const RowParts& parts = {},
                                          std::span<const std::vector<std::uint8_t>> bad = {});

/// Turning points from which on a record that nobody declared counts as cycled.
inline constexpr std::size_t kTurnsOfCycling = 8;
/// Facts of the excitation of one record from its rows: dynamic, onset, f, A, F_min, frequency jumps. Of a kind that is cyclic by its name (sine, multisine,
/// sweep, prbs, switch) three turning points are enough.
void estimate_excitation(RecordInput& record, const Record* declared, double range_N, std::size_t fewest_turns = kTurnsOfCycling);

/// Where a record that was moved in other ways before may begin to be cycled: from there to its end the peaks, and the valleys, keep their
/// height (first, if at all); behind its longest stretches without a turn.
std::vector<double> cycles_may_begin_s(const RecordInput& record, double range_N);

/// The first turning points after `from_s`, where its cycles may begin as well: a step may come before them.
std::vector<double> turns_begin_s(const RecordInput& record, double range_N, double from_s);

/// Takes what came before for static: onset, f, A, F_min and jumps from the cycles after it.
void begin_cycles_at(RecordInput& record, double onset_s, double range_N);

/// Force that stands still most of the time: without knowledge of the output such a record is taken for a static one.
bool stands_mostly_still(const RecordInput& record, double range_N);

/// Takes the record for a static one: no decay, no cycle.
void set_static(RecordInput& record);

}  // namespace forcegate
