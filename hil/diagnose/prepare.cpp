#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "hil/base/largest_first.h"
#include "hil/base/plain_number.h"
#include "hil/diagnose/base/base_fit.h"
#include "hil/diagnose/base/own_decay.h"
#include "hil/diagnose/candidates/command_channel.h"
#include "hil/diagnose/candidates/guessed_shapes.h"
#include "hil/diagnose/candidates/model_effects.h"
#include "hil/diagnose/candidates/rig_law.h"
#include "hil/diagnose/candidates/signatures.h"
#include "hil/diagnose/candidates/user_candidates.h"
#include "hil/diagnose/choose/reference_latency.h"
#include "hil/diagnose/engine.h"
#include "hil/diagnose/raw/absurd_force.h"
#include "hil/diagnose/raw/clean_samples.h"
#include "hil/diagnose/raw/lost_blocks.h"
#include "hil/diagnose/raw/missing_code.h"
#include "hil/diagnose/raw/record_gains.h"
#include "hil/diagnose/raw/stuck_bit.h"
#include "hil/model/model_frame.h"
#include "hil/model/row_step.h"
#include "hil/model/rows.h"

namespace forcegate::diagnose {

namespace {

std::vector<std::size_t> usable_rows(const RecordInput& record) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < record.rows(); ++i)
    if (record.ok[i] != 0) out.push_back(i);
  return out;
}

// The states of the first rows are not known, unless force and output stand still there. A load that is put on there and stays is all that
// tells of the gain.
std::size_t rows_that_settle(const RecordInput& whole, const std::vector<std::size_t>& usable) {
  constexpr double kMostOfSpan = 0.3, kStill = 0.03;
  constexpr std::size_t kFewestRows = 10;
  const std::size_t n = usable.size(), tenth = n / 10, first = std::max(n / 100, kFewestRows);
  const auto span = [&](const std::vector<double>& x, std::size_t begin, std::size_t end) {
    const auto at = [&](std::size_t k) { return usable.begin() + static_cast<std::ptrdiff_t>(k); };
    const auto [low, high] = std::minmax_element(at(begin), at(end), [&](std::size_t a, std::size_t b) { return x[a] < x[b]; });
    return x[*high] - x[*low];
  };
  const bool at_rest = span(whole.F_N, 0, first) < kStill * span(whole.F_N, 0, n) && span(whole.U_V, 0, first) < kStill * span(whole.U_V, 0, n);
  return !at_rest && span(whole.F_N, tenth, n) > kMostOfSpan * span(whole.F_N, 0, n) ? tenth : 0;
}

double common_step_V(const std::vector<RecordHealth>& health) {
  constexpr double kAlike = 0.01;
  double low = 1e300, high = 0.0;
  for (const RecordHealth& h : health) low = std::min(low, h.lsb_U_V), high = std::max(high, h.lsb_U_V);
  return high - low < kAlike * high ? low : 0.0;
}

// A single recording is judged in contiguous blocks with a gap between them, so that something can be left out. Each has its share of the
// usable rows: one that lies in a stretch of missing samples would have nothing to say. Every
// block keeps the whole history, since what came before it is still in the states of the system. Columns are made once for all blocks,
// from the first: it alone has the full rate.
void cut_into_blocks(CampaignRows& w) {
  constexpr std::size_t kBlocks = 5, kFewestRows = 200;
  const std::vector<std::size_t> usable = usable_rows(w.input.records.front());
  const std::size_t n = usable.size();
  if (n < kFewestRows) return;
  RecordInput whole = std::move(w.input.records.front());
  const RecordHealth health = std::move(w.health.front());
  std::vector<double> fast_t_s = std::move(whole.fast_t_s), fast_F_N = std::move(whole.fast_F_N);
  w.input.records.clear();
  w.health.clear();
  const std::size_t gap = n / 100, settled = rows_that_settle(whole, usable), length = (n - settled) / kBlocks;
  for (std::size_t b = 0; b < kBlocks; ++b) {
    RecordInput block = whole;
    block.name = whole.name + "/" + std::to_string(b + 1);
    block.index = b;
    const std::size_t begin = settled + b * length + (b > 0 ? gap / 2 : 0),
                      end = b + 1 < kBlocks ? settled + (b + 1) * length - gap / 2 : n;
    block.ok.assign(whole.rows(), 0);
    for (std::size_t i = begin; i < end; ++i) block.ok[usable[i]] = 1;
    w.input.records.push_back(std::move(block));
    w.health.push_back(health);
  }
  w.input.records.front().fast_t_s = std::move(fast_t_s);
  w.input.records.front().fast_F_N = std::move(fast_F_N);
  w.input.notes.push_back(
      std::string(settled > 0 ? "one recording only: its first tenth settles the states, the rest is judged in five blocks, each left out in turn"
                              : "one recording only: it is judged in five blocks, each left out in turn; it begins at rest, or its force moves "
                                "at its beginning alone or not at all") +
      (whole.dynamic ? "" : "; no decay is assumed"));
}

// What happened in a long gap nobody saw: the states of loop and creep after it are not known before the force has moved for a while.
void leave_out_after_gaps(RecordInput& input, std::vector<std::string>& notes) {
  constexpr double kLong_s = 2.0, kMostOfRecord = 0.1, kSteps = 50.0;
  double longest_s = 0.0;
  for (std::size_t i = 1; i < input.rows(); ++i) {
    const double gap_s = input.t_s[i] - input.t_s[i - 1];
    if (!follows_hole(input, i, std::max(kLong_s, kSteps * input.row_step_s))) continue;
    // rows are means: the samples at the two edges tell how long it was
    const bool sampled = input.fast_t_s.size() > input.row_begin[i] && input.row_begin[i] > 0;
    longest_s = std::max(longest_s, sampled ? input.fast_t_s[input.row_begin[i]] - input.fast_t_s[input.row_begin[i] - 1] : gap_s);
    const double until_s = input.t_s[i] + std::min(gap_s, kMostOfRecord * input.duration_s);
    for (std::size_t k = i; k < input.rows() && input.t_s[k] < until_s; ++k) input.ok[k] = 0;
  }
  if (longest_s > 0.0)
    notes.push_back(input.name + ": rows after a gap (the longest " + plain_number(longest_s) +
                    " s) are left out for as long as it was, at most a tenth of the record: the sensor's state is not known there");
}

// Nobody said when the cycling began: steps and ramps before it count as static where the decay then fits far better.
void find_late_onset(RecordInput& input, double range_N) {
  constexpr double kFarBetter = 0.5;  // mean square
  const RecordInput early = input;
  double least = kFarBetter * left_by_decay(input);
  bool found = false;
  const auto try_each = [&](const std::vector<double>& begins_s) {
    for (const double begin_s : begins_s) {
      RecordInput late = early;
      begin_cycles_at(late, begin_s, range_N);
      if (const double left = left_by_decay(late); left < least) least = left, input = std::move(late), found = true;
    }
  };
  try_each(cycles_may_begin_s(early, range_N));
  if (found) try_each(turns_begin_s(early, range_N, input.onset_s));
}

// Why hardly a row of a record is usable: what befell most of its samples.
std::string why_unusable(const Record& record, const RecordHealth& health) {
  if (const Channel* U = record.trace.find("U")) {
    double low = 1e300, high = -1e300;
    for (const double v : U->value)
      if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
    if (low == high) return "its output stands at " + plain_number(low) + " " + U->unit + " throughout; was the sensor connected?";
  }
  std::array<std::size_t, static_cast<std::size_t>(BadSample::censored) + 1> n{};
  for (const std::uint8_t bad : health.bad) ++n[bad];
  const auto most = static_cast<BadSample>(std::ranges::max_element(n) - n.begin());
  switch (most) {
    case BadSample::zero: return "its output lies at its low end while the force stands elsewhere; was the sensor connected?";
    case BadSample::held: return "its output holds one value while the force moves";
    case BadSample::rail: return "its output lies at a rail";
    case BadSample::censored: return "its output lies at or beyond an end of the range";
    case BadSample::outlier:
    case BadSample::bit: return "its output is spikes for the most part";
    default: return "hardly a row has both force and output";
  }
}

// Records whose rows are all missing, at a rail or out of range say nothing; a sensor that was not plugged in must not end a campaign.
Result<void> leave_out_unusable(CampaignRows& w, const std::map<std::string, std::string>& why, bool asks_one_recording) {
  constexpr auto kFewestRows = 16, kFewestOfOne = 200;
  auto& records = w.input.records;
  const auto usable = [](const RecordInput& r) { return std::count_if(r.ok.begin(), r.ok.end(), [](char ok) { return ok != 0; }); };
  double low = 1e300, high = -1e300, force_low = 1e300, force_high = -1e300;
  for (const RecordInput& r : records)
    for (std::size_t i = 0; i < r.rows(); ++i)
      if (r.ok[i] != 0) {
        low = std::min(low, r.U_V[i]), high = std::max(high, r.U_V[i]);
        force_low = std::min(force_low, r.F_N[i]), force_high = std::max(force_high, r.F_N[i]);
      }
  std::vector<std::string> left_out;
  std::erase_if(records, [&](const RecordInput& r) {
    if (usable(r) >= kFewestRows) return false;
    left_out.push_back(r.name);
    return true;
  });
  if (records.empty())
    return fail(ErrorCode::parse, "no record has rows to judge by; " + left_out.front() + ": " + why.at(left_out.front()), w.input.name,
                "are the sensor and the reference connected, and the columns mapped as you mean?");
  for (const std::string& name : left_out) w.input.notes.push_back(name + ": left out, " + why.at(name));
  if (asks_one_recording && usable(records.front()) < kFewestOfOne)
    return fail(ErrorCode::parse, "one recording of " + std::to_string(usable(records.front())) + " usable rows is too short for a verdict",
                records.front().name, "record at least " + std::to_string(kFewestOfOne) + " samples, or several recordings");
  if (force_high > force_low && !(high > low))
    return fail(ErrorCode::parse, "the output never moves while the force does", w.input.name,
                "is the sensor connected, and is this its column? --map NAME=U_V names another");
  return {};
}

// What is known before any sample is looked at.
CampaignRows declared_rows(const Campaign& campaign) {
  CampaignRows w;
  w.input.name = campaign.name;
  w.input.bench = campaign.bench;
  w.input.in_counts = is_in_counts(campaign);
  w.input.single = campaign.records.size() == 1;
  w.input.undeclared = std::ranges::all_of(campaign.records, [](const Record& r) { return r.kind.empty(); });
  w.input.generic = w.input.single && w.input.undeclared;
  w.input.notes = campaign.notes;
  note_cleaning(campaign.bench, w.input.notes);
  const Channel* output = campaign.records.front().trace.find("U");
  const bool is_ratio = output != nullptr && output->quantity == "ratio";
  if (output != nullptr && !output->unit.empty() && (is_ratio || output->unit != "1")) w.unit = output->unit;
  return w;
}

void note_falling_output(CampaignRows& w) {
  if (w.unit != "V" || !(w.scales.gain_V_per_N < 0.0)) return;
  w.input.notes.push_back(fmt::format(
      "the output falls as the force rises ({:.3g} V/N): so does a divider with the sensor below (--divider OHMS:SUPPLY:below reads its "
      "conductance); else the force, or the output, has the wrong sign",
      w.scales.gain_V_per_N));
}

struct PreparedRecord {
  RecordHealth health;
  Edges edges;
  Result<RecordInput> input;
  std::vector<CutOut> cuts;
  std::string why_unusable;
};

// The samples of each record are freed as soon as its rows are made.
std::vector<PreparedRecord> prepare_records(Campaign& campaign, const HealthScales& scales, const EngineOptions& options) {
  std::vector<PreparedRecord> out(campaign.records.size());
  // without a search only effects of the model itself ask for the angle
  const RowParts parts{.full_rate = true, .angle = options.search || !options.in_model.empty()};
  parallel_for_largest_first(sample_counts(campaign), options.threads, [&](std::size_t k) {
    Record& record = campaign.records[k];
    const Channel* force = options.search ? record.trace.find("F_ref") : nullptr;
    const std::vector<double> recorded_N = force != nullptr ? force->value : std::vector<double>();
    const double row_step_s = row_step_of(record, campaign.records.size());
    CleanedSamples cleaned = clean_samples(record, scales, campaign.bench, options.pictures);
    out[k].health = std::move(cleaned.health);
    out[k].cuts = std::move(cleaned.cuts);
    if (options.search) out[k].edges = edges_of(record, recorded_N, out[k].health, out[k].health.bad);
    out[k].input = take_record_input(record, out[k].health.bad, row_step_s, parts);
    out[k].why_unusable = why_unusable(record, out[k].health);
    record.trace = Trace{};
    out[k].health.bad = {};
  });
  return out;
}

// Of every record by its name: it may be left out, and the order is that of the start times later.
struct OfRecords {
  std::map<std::string, RecordHealth> health;
  std::map<std::string, Edges> edges;
  std::map<std::string, std::string> why_unusable;
  std::vector<CutOut> cuts;
};

Result<OfRecords> gather(std::vector<PreparedRecord> prepared, std::vector<RecordInput>& records) {
  OfRecords out;
  for (PreparedRecord& p : prepared) {
    std::ranges::move(p.cuts, std::back_inserter(out.cuts));
    FORCEGATE_TRY(RecordInput input, std::move(p.input));
    out.health.emplace(input.name, std::move(p.health));
    out.edges.emplace(input.name, std::move(p.edges));
    out.why_unusable.emplace(input.name, std::move(p.why_unusable));
    records.push_back(std::move(input));
  }
  return out;
}

// With no record to judge by, or none to fit, every record is both.
JudgedBy judges_of(const std::vector<RecordInput>& records) {
  const auto heldout = std::ranges::count_if(records, &RecordInput::heldout);
  return heldout == 0 || heldout == std::ssize(records) ? JudgedBy::left_out : JudgedBy::heldout;
}

void find_decay(RecordInput& input, const Record* declared, const CampaignInput& campaign, bool law_decays) {
  // whether it decays is asked afterwards: two slow cycles are enough to ask
  constexpr std::size_t kFewestTurns = 4, kFewestToAsk = 2;
  estimate_excitation(input, declared, campaign.range_N, kFewestTurns);
  // a hand that goes up and down hardly twice has cycled the film, where the decay is plain
  if (law_decays && !campaign.single && !input.dynamic && input.dynamic_assumed) {
    estimate_excitation(input, declared, campaign.range_N, kFewestToAsk);
    if (input.dynamic && !decays_plainly(input)) estimate_excitation(input, declared, campaign.range_N, kFewestTurns);
  }
  if (law_decays && input.dynamic && input.dynamic_assumed) find_late_onset(input, campaign.range_N);
  if (law_decays && input.dynamic) input.F_min_N = lowest_force_of_decay(input);
  if (campaign.single && input.dynamic && input.dynamic_assumed) {
    input.dynamic_assumed = false;  // the blocks share the answer of the whole
    if (!law_decays || !decays_by_itself(input)) {
      set_static(input);
      input.found_static = true;
    }
  }
}

void find_decays(CampaignInput& input, const Campaign& campaign, const EngineOptions& options) {
  parallel_for(input.records.size(), options.threads, [&](std::size_t k) {
    const Record* declared = nullptr;
    for (const Record& record : campaign.records)
      if (record.name == input.records[k].name) declared = &record;
    find_decay(input.records[k], declared, input, options.law.decays);
  });
}

// An amplifier rounds before it stops, in the records that do not quite get there too: what comes near a rail that was found tells of no curve.
void leave_out_near_rail(CampaignRows& w) {
  constexpr double kRounds = 0.06;  // of the range
  constexpr std::size_t kFewest = 50;
  const auto clipping = std::ranges::find(w.raw_claims, "clipping", &HealthClaim::effect);
  if (clipping == w.raw_claims.end()) return;
  const double bent_V = clipping->value - kRounds * w.scales.U_range_V;
  for (RecordInput& r : w.input.records) {
    std::vector<std::uint8_t> below = r.ok;
    for (std::size_t i = 0; i < r.rows(); ++i)
      if (r.U_V[i] >= bent_V) below[i] = 0;
    if (std::ranges::count(below, 1) >= static_cast<std::ptrdiff_t>(kFewest)) r.ok = std::move(below);
  }
}

void judge_samples(CampaignRows& w, OfRecords& of, const std::optional<StuckBit>& stuck) {
  for (const RecordInput& input : w.input.records) {
    w.health.push_back(of.health[input.name]);
    w.edges.push_back(std::move(of.edges[input.name]));
  }
  w.input.U_step_V = common_step_V(w.health);
  w.raw_claims = health_claims(w.health, w.scales, w.input.bench);
  if (stuck && std::ranges::find(w.raw_claims, "adc_codes", &HealthClaim::effect) == w.raw_claims.end()) w.raw_claims.push_back(claim_of_stuck_bit(*stuck, w.scales.unit));
  leave_out_near_rail(w);
  if (std::string note = note_of_left_out(w.health, w.raw_claims); !note.empty()) w.input.notes.push_back(std::move(note));
  if (std::string note = note_of_hum_taken_off(w.health, w.scales, w.raw_claims); !note.empty()) w.input.notes.push_back(std::move(note));
  add_sample_windows(of.cuts, w.raw_claims);
}

}  // namespace

Result<CampaignRows> take_rows(Campaign campaign, const EngineOptions& options) {
  if (campaign.records.empty())
    return fail(ErrorCode::parse, "the campaign has no records", campaign.folder.string(), "");
  CampaignRows w = declared_rows(campaign);
  leave_out_missing_codes(campaign, w.input.notes);
  leave_out_absurd_force(campaign, options.threads, w.input.notes);
  const std::optional<StuckBit> stuck = mend_stuck_bit(campaign, w.input.notes);
  w.scales = health_scales(campaign, options.threads);
  note_falling_output(w);
  FORCEGATE_TRY(OfRecords of, gather(prepare_records(campaign, w.scales, options), w.input.records));
  if (stuck)
    for (std::size_t k = 0; k < campaign.records.size(); ++k) of.health[campaign.records[k].name].bad_mean_square_V2 += stuck->mean_square_V2[k];
  for (RecordInput& input : w.input.records) leave_out_after_gaps(input, w.input.notes);
  FORCEGATE_CHECK_OK(leave_out_unusable(w, of.why_unusable, w.input.single && options.search));
  FORCEGATE_CHECK_OK(check_record_gains(w.input.records, w.input.notes));
  w.judges = judges_of(w.input.records);
  finish_campaign_input(w.input, options.threads);
  find_decays(w.input, campaign, options);
  find_lost_blocks(w.input, options.threads);
  judge_samples(w, of, stuck);
  if (w.input.single) cut_into_blocks(w);
  return w;
}

Result<std::unique_ptr<Workspace>> prepare(CampaignRows rows, const EngineOptions& options) {
  auto w = std::make_unique<Workspace>();
  w->law = options.law;
  w->zero_wanders = options.zero_wanders;
  w->input = std::move(rows.input);
  w->health = std::move(rows.health);
  w->edges = std::move(rows.edges);
  w->raw_claims = std::move(rows.raw_claims);
  w->scales = rows.scales;
  w->output.unit = std::move(rows.unit);
  w->judges = rows.judges;
  hold_references_of_air(w->input);
  FORCEGATE_TRY(w->user_kinds, make_user_kinds(options.user_effects, w->input));
  choose_wanted_rows(w->input);
  const std::vector<Candidate> of_model = model_candidates(w->input, options.model_effects);
  fit_base(*w, options.threads, beside_base_law(w->input, of_model));
  if (options.search) {
    build_rig_channel(*w, options.threads);
    build_command_channel(*w, options.threads);
  }
  if (options.search) {
    build_output_channel(*w, options.threads, of_model);
    fit_guessed_shapes(*w, options.threads);
    return w;
  }
  ListedOnly only{options.in_model, {}};
  const bool latency_in_model = std::ranges::find(options.in_model, kLatencyEffect) != options.in_model.end();
  if (!latency_in_model) {
    only.families.push_back(kLatencyEffect);
    only.is_read = [](const Candidate& c) { return c.kind->name != kLatencyEffect || is_allowed_lead(c); };
  }
  build_output_channel(*w, options.threads, of_model, &only);
  fit_guessed_shapes(*w, options.threads);
  return w;
}

Result<std::unique_ptr<Workspace>> prepare(Campaign campaign, const EngineOptions& options) {
  FORCEGATE_TRY(CampaignRows rows, take_rows(std::move(campaign), options));
  return prepare(std::move(rows), options);
}

}  // namespace forcegate::diagnose
