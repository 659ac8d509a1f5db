#include <algorithm>
#include <cmath>

#include "hil/base/parallel.h"
#include "hil/diagnose/denoise.h"
#include "hil/diagnose/engine.h"
#include "hil/diagnose/user_candidates.h"
#include "hil/model/rows.h"

namespace forcegate::diagnose {

namespace {

// A single record is cut into contiguous blocks with a gap between them, so that something can be left out.
void split_single(Campaign& campaign) {
  if (campaign.records.size() != 1) return;
  Record whole = std::move(campaign.records.front());
  campaign.records.clear();
  const std::size_t n = whole.trace.size(), parts = 5, gap = n / 100;
  if (n < 400) {
    campaign.records.push_back(std::move(whole));
    return;
  }
  for (std::size_t p = 0; p < parts; ++p) {
    const std::size_t from = p * n / parts + (p > 0 ? gap / 2 : 0), to = (p + 1) * n / parts - (p + 1 < parts ? gap / 2 : 0);
    Record part = whole;
    part.name = whole.name + "/" + std::to_string(p + 1);
    part.trace = Trace{};
    for (const TimeBase& base : whole.trace.time_bases) {
      TimeBase cut = base;
      cut.gaps.clear();
      if (base.t_s.size() == n) cut.t_s.assign(base.t_s.begin() + static_cast<std::ptrdiff_t>(from), base.t_s.begin() + static_cast<std::ptrdiff_t>(to));
      part.trace.time_bases.push_back(std::move(cut));
    }
    for (const Channel& channel : whole.trace.channels) {
      Channel cut = channel;
      cut.raw.clear();
      if (channel.value.size() == n)
        cut.value.assign(channel.value.begin() + static_cast<std::ptrdiff_t>(from), channel.value.begin() + static_cast<std::ptrdiff_t>(to));
      part.trace.channels.push_back(std::move(cut));
    }
    part.start_s = whole.trace.time_bases.front().t_s[from];
    part.dynamic = false;
    campaign.records.push_back(std::move(part));
  }
  campaign.notes.push_back("one record only: cut into five contiguous blocks with a gap; no decay is assumed");
}

}  // namespace

Result<std::unique_ptr<Workspace>> prepare(Campaign campaign, const EngineOptions& options) {
  if (campaign.records.empty()) return fail(ErrorCode::parse, "the campaign has no records", campaign.folder.string(), "");
  auto w = std::make_unique<Workspace>();
  w->law = options.law;
  w->input.name = campaign.name;
  w->input.bench = campaign.bench;
  const bool single = campaign.records.size() == 1;
  w->input.generic = single && campaign.records.front().kind.empty();
  split_single(campaign);
  w->input.notes = campaign.notes;
  w->scales = health_scales(campaign);
  bool any_heldout = false;
  for (const Record& r : campaign.records) any_heldout |= r.role == RecordRole::heldout;
  std::size_t fit_records = 0;
  for (const Record& r : campaign.records) fit_records += r.role != RecordRole::heldout ? 1 : 0;
  if (any_heldout && fit_records == 0) any_heldout = false;
  w->all_fit = !any_heldout;

  struct Prepared {
    RecordHealth health;
    Result<RecordInput> input;
  };
  std::vector<Prepared> prepared(campaign.records.size());
  parallel_for(prepared.size(), options.threads, [&](std::size_t k) {
    Record& record = campaign.records[k];
    prepared[k].health = check_raw_health(record, w->scales, campaign.bench);
    const RecordHealth& h = prepared[k].health;
    const double reference_sd_N = std::hypot(h.noise_F_N, h.lsb_F_N / std::sqrt(12.0));
    if (reference_sd_N > 1e-4 * w->scales.range_N)
      for (Channel& channel : record.trace.channels)
        if (channel.name == "F_ref") channel.value = smooth_within_noise(channel.value, reference_sd_N);
    prepared[k].input = make_record_input(record, prepared[k].health.bad);
    record.trace = Trace{};
    prepared[k].health.bad = {};
  });
  std::map<std::string, RecordHealth> health;
  for (Prepared& p : prepared) {
    FORCEGATE_TRY(RecordInput input, std::move(p.input));
    health.emplace(input.name, std::move(p.health));
    w->input.records.push_back(std::move(input));
  }
  finish_campaign_input(w->input);
  for (RecordInput& input : w->input.records) {
    const Record* declared = nullptr;
    for (const Record& record : campaign.records)
      if (record.name == input.name) declared = &record;
    estimate_excitation(input, declared, w->input.range_N);
    w->health.push_back(health[input.name]);
  }
  FORCEGATE_TRY(w->user_kinds, make_user_kinds(options.user_effects, w->input));
  fit_base(*w);
  if (options.search) build_rig_channel(*w, options.threads);
  build_output_channel(*w, options.threads, options.search ? nullptr : &options.in_model);
  return w;
}

std::vector<int> model_columns(const ResidualChannel& channel, const std::vector<std::string>& in_model) {
  std::vector<int> out;
  for (const std::string& name : in_model)
    for (const Candidate& c : channel.candidates)
      if (c.kind->name == name && (c.form->bank || bank_columns(channel, *c.kind).empty()))
        for (int j = 0; j < c.count; ++j) out.push_back(c.first + j);
  return out;
}

Result<Diagnosis> diagnose_campaign(Campaign campaign, const EngineOptions& options) {
  FORCEGATE_TRY(std::unique_ptr<Workspace> workspace, prepare(std::move(campaign), options));
  return diagnose_workspace(*workspace, options);
}

}  // namespace forcegate::diagnose
