#include "hil/app/model/compare.h"

#include <fmt/format.h>

#include <algorithm>

#include <cmath>
#include <nlohmann/json.hpp>

#include "hil/app/model/clean_input.h"
#include "hil/app/model/never_fitted.h"
#include "hil/app/pictures/record_pictures.h"
#include "hil/base/parallel.h"
#include "hil/base/plain_number.h"
#include "hil/base/quantile.h"
#include "hil/base/text.h"
#include "hil/diagnose/answer/residual_map.h"
#include "hil/diagnose/base/own_decay.h"
#include "hil/diagnose/laws/no_input.h"
#include "hil/trace/column_map.h"
#include "hil/trace/columns.h"

namespace forcegate {

namespace {

ModelComparison::AsWritten as_written(const RecordInput& r, const std::vector<double>& U) {
  double square = 0.0, mean = 0.0, of_model = 0.0, n = 0.0;
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (r.ok[i] != 0) {
      square += (r.U_V[i] - U[i]) * (r.U_V[i] - U[i]);
      mean += r.U_V[i];
      of_model += U[i];
      n += 1.0;
    }
  mean /= std::max(n, 1.0), of_model /= std::max(n, 1.0);
  double swing = 0.0, swing_of_model = 0.0;
  for (std::size_t i = 0; i < r.rows(); ++i)
    if (r.ok[i] != 0) swing += (r.U_V[i] - mean) * (r.U_V[i] - mean), swing_of_model += (U[i] - of_model) * (U[i] - of_model);
  return {r.name, std::sqrt(square / std::max(n, 1.0)), swing > 0.0 ? std::sqrt(square / swing) : 0.0, swing > 0.0 ? std::sqrt(swing_of_model / swing) : 1.0};
}

Result<std::vector<ModelComparison::AsWritten>> as_written(const Model& model, CampaignInput rows, unsigned threads, std::string& note) {
  diagnose::settle_excitations(rows.records, threads);
  if (model.law.decays) note = note_of_assumed_cycles(rows.records);
  for (RecordInput& r : rows.records) set_decay(r, model.law);
  const CampaignInFrame input(model.frame, std::move(rows));
  const std::vector<RecordInput>& records = input.input().records;
  std::vector<Result<ModelComparison::AsWritten>> made(records.size());
  parallel_for(made.size(), threads, [&](std::size_t k) {
    made[k] = model_output_V(model, input, records[k]).map([&](const std::vector<double>& U) {
      return as_written(records[k], U);
    });
  });
  std::vector<ModelComparison::AsWritten> out;
  for (Result<ModelComparison::AsWritten>& one : made) {
    FORCEGATE_TRY(ModelComparison::AsWritten written, std::move(one));
    out.push_back(std::move(written));
  }
  return out;
}

// Counts are no volts: what the model's own numbers say of them is nothing.
void leave_out_as_written(Campaign& campaign, const Model& model, ModelComparison& out) {
  for (const Record& record : campaign.records) out.as_written.push_back({record.name, kMissing, kMissing, kMissing});
  const std::string note = note_of_another_unit(model, campaign);
  if (std::ranges::find(campaign.notes, note) == campaign.notes.end()) campaign.notes.push_back(note);
}

// Sensors of one kind differ in gain by a hundred; beyond that it is rather the unit of the force.
std::string note_of_absurd_force(const std::vector<ModelComparison::AsWritten>& written, const std::string& header) {
  constexpr double kMostApart = 300.0, kThousand = 1000.0;
  std::vector<double> ratios;
  for (const auto& a : written)
    if (std::isfinite(a.swing) && a.swing > 0.0) ratios.push_back(a.swing);
  if (ratios.empty()) return {};
  const double ratio = median(std::move(ratios));
  if (ratio < kMostApart && ratio > 1.0 / kMostApart) return {};
  const double thousands = std::round(std::log(ratio) / std::log(kThousand));
  const Unit unit = meaning_of(header).unit;
  const double factor = (unit.quantity == "force" ? unit.factor : 1.0) / std::pow(kThousand, thousands);
  return fmt::format("the model as written moves its output {} times as far as these records do: the unit of the force may be wrong, or that of the output; of the force --map {} reads {} N for each 1 in that column",
                     plain_number(ratio), shell_quoted(header + "=F_ref_N:" + shortest(factor)), shortest(factor));
}

Result<ModelComparison> compare_recordings(const CampaignRequest& request, Campaign campaign, const Model& model, bool pictures) {
  ModelComparison out;
  const Record& first = campaign.records.front();
  const Channel* force = first.trace.find("F_ref");
  const std::string force_header = force != nullptr ? written_header(*force, first.headers) : "F_ref_N";
  const bool is_comparable = output_unit(campaign) == model.output_unit;
  std::string assumed_cycles;
  if (!is_comparable) {
    leave_out_as_written(campaign, model, out);
  } else if (campaign.records.size() == 1) {  // the comparison cuts it into blocks, and the model is asked about the whole
    FORCEGATE_TRY(CampaignInput whole, clean_input(campaign, request.threads));
    FORCEGATE_TRY(out.as_written, as_written(model, std::move(whole), request.threads, assumed_cycles));
  }
  if (diagnose::is_drift_only(campaign)) campaign.notes.push_back(diagnose::what_the_force_shows(campaign));
  diagnose::EngineOptions options = engine_options(model, request.threads);
  options.search = false;
  options.pictures = pictures;
  FORCEGATE_TRY(diagnose::CampaignRows rows, diagnose::take_rows(std::move(campaign), options));
  if (out.as_written.empty()) {
    FORCEGATE_TRY(out.as_written, as_written(model, rows.input, request.threads, assumed_cycles));
  }
  constexpr std::size_t kFewestOfOne = 200;  // usable rows that prepare() asks of a single recording
  const auto& records = rows.input.records;
  out.too_short = records.size() == 1 && static_cast<std::size_t>(std::ranges::count_if(records.front().ok, [](auto ok) { return ok != 0; })) < kFewestOfOne;
  std::string of_unit = is_comparable ? note_of_absurd_force(out.as_written, force_header) : "";
  std::string of_samples = diagnose::note_of_claims(rows.raw_claims);
  FORCEGATE_TRY(std::unique_ptr<diagnose::Workspace> w, diagnose::prepare(std::move(rows), options));
  FORCEGATE_TRY(out.view, diagnose::compare_workspace(*w, options));
  if (out.too_short) {  // nothing is left to fit a law on where it is left out
    for (RecordError& r : out.view.records) r.plain_before = r.plain_after = kMissing;
    out.view.plain_before = out.view.plain_after = kMissing;
    out.view.errors["U_plain"] = {kMissing, kMissing, out.view.unit};
  }
  if (!assumed_cycles.empty()) out.view.notes.push_back(std::move(assumed_cycles));
  if (!of_unit.empty()) out.view.notes.push_back(std::move(of_unit));
  if (!of_samples.empty()) out.view.notes.push_back(std::move(of_samples));
  if (pictures) out.pictures = record_pictures(*w, model);
  return out;
}

}  // namespace

Result<ModelComparison> compare_request(const CampaignRequest& request, bool pictures) {
  FORCEGATE_TRY(Campaign campaign, load_campaign(request));
  FORCEGATE_TRY(const Model model, load_model(request, campaign));
  const PlacesOf places(campaign, request.campaign);
  Result<ModelComparison> out = compare_recordings(request, std::move(campaign), model, pictures);
  if (!out) return Unexpected(places.with_file(std::move(out.error())));
  for (std::string& note : left_out_notes(model)) out->view.notes.push_back(std::move(note));
  return out;
}

namespace {

std::string refitted_in_words(JudgedBy by) {
  switch (by) {
    case JudgedBy::heldout: return "one law for all records, fitted to those that are not held out.";
    case JudgedBy::left_out: return "each record by one law for all the others.";
    case JudgedBy::whole: return "one law for the whole recording.";
  }
  return {};
}

}  // namespace

std::string comparison_text(const ModelComparison& c) {
  const Diagnosis& d = c.view;
  const PrintedUnit unit = printed_unit(d.unit);
  // of one recording the file's own numbers are asked about the whole, everything else about its blocks
  const bool blocks = c.as_written.size() == 1 && d.records.size() > 1;
  std::string out = fmt::format("{}: model {} against {} {}\n", d.campaign, d.model, d.records.size(),
                                blocks ? "blocks of one recording" : d.records.size() == 1 ? "record" : "records");
  const auto row = [&](const std::string& record, const std::string& kind, const std::string& written, const auto&... cells) {
    out += fmt::format("  {:<22} {:<10}", record, kind);
    if (!blocks) out += fmt::format(" {:>12}", written);
    out += fmt::format(" {:>12} {:>12} {:>9} {:>12}", cells...);
  };
  row("record", "kind", "as written", "refitted", "adapted", "floor", "explainable");
  out += "\n";
  row("", "", unit.name, unit.name, unit.name, unit.name, "%");
  out += "\n";
  for (const RecordError& r : d.records) {
    std::string written = "-";
    for (const auto& a : c.as_written)
      if (a.record == r.record && std::isfinite(a.rmse_V)) written = plain_number(unit.factor * a.rmse_V);
    row(r.record, r.kind, written, std::isfinite(r.plain_before) ? plain_number(unit.factor * r.plain_before) : "-", plain_number(unit.factor * r.before),
        plain_number(unit.factor * r.floor), fmt::format("{:.0f}", 100.0 * r.explainable));
    out += r.heldout ? "  held out\n" : "\n";
  }
  if (blocks && std::isfinite(c.as_written.front().rmse_V)) out += fmt::format("as written, the whole recording: {} {}\n", plain_number(unit.factor * c.as_written.front().rmse_V), unit.name);
  out +=
      "\nas written: the file's own numbers. refitted: " + refitted_in_words(d.judged_by) +
      "\nadapted: each record with its own gain, offset, decay and slow wander of the zero within the spread of the campaign.\n"
      "floor: what the instruments may leave.\n\nwhere the residual sits:\n";
  constexpr double kLeastShare = 0.005;
  for (std::size_t k = 0; k < d.maps.size() && k < 4 && d.maps[k].share > kLeastShare; ++k)
    out += fmt::format("  {:<26} {:>4.0f} %  {}\n", d.maps[k].coordinate, 100.0 * d.maps[k].share,
                       d.maps[k].sentence);
  if (d.maps.empty() || d.maps.front().share <= kLeastShare)
    out += "  nowhere in particular: no coordinate predicts it on rows that it was not made from\n";
  if (c.as_written.size() == 1) return out;  // what repeats itself takes two
  out +=
      fmt::format("repeatability between records: gain {:.2g} %, offset {} {}{}; the zero within a record: {} {} RMS\n",
                  100.0 * d.repeatability.gain, plain_number(unit.factor * d.repeatability.offset_V), unit.name,
                  std::isfinite(d.repeatability.log_b) ? fmt::format(", b {:.2g} %, q {:.2g} %", 100.0 * d.repeatability.log_b, 100.0 * d.repeatability.log_q) : "",
                  plain_number(unit.factor * d.repeatability.wander_V), unit.name);
  return out;
}

std::string comparison_json(const ModelComparison& c) {
  auto out = nlohmann::ordered_json::parse(to_json(c.view));
  for (const char* key :
       {"verdict", "residual_unknown", "findings", "ranking", "expected_false", "next_experiment"})
    out.erase(key);
  nlohmann::ordered_json written = nlohmann::ordered_json::array();
  for (const auto& a : c.as_written)
    written.push_back({{"record", a.record}, {"rmse_V", a.rmse_V}, {"relative", a.relative}});
  out["as_written"] = written;
  return out.dump(2) + "\n";
}

}  // namespace forcegate
