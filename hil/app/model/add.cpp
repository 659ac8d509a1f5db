#include "hil/app/model/add.h"

#include <cmath>

#include "hil/app/files/write_file.h"
#include "hil/app/pictures/record_pictures.h"
#include "hil/diagnose/refit/added_effect.h"
#include "hil/model/compensator/compensator.h"
#include "hil/report/added_html.h"

namespace forcegate {
namespace {

struct Shown {
  Diagnosis view;
  RecordPictures pictures;
};

Result<Shown> show(Campaign campaign, const Model& start, const Model& refitted, const AddRequest& request, bool zero_wanders) {
  const diagnose::EngineOptions before = engine_options(start, request.campaign.threads);
  diagnose::EngineOptions at_end = engine_options(refitted, request.campaign.threads);
  at_end.search = false;
  at_end.zero_wanders = zero_wanders;
  diagnose::EngineOptions at_start = at_end;
  at_start.law = before.law;
  at_start.model_effects = before.model_effects;  // what was added is listed as a family, else it would stand in the base
  FORCEGATE_TRY(diagnose::CampaignRows rows, diagnose::take_rows(std::move(campaign), at_start));
  FORCEGATE_TRY(const std::unique_ptr<diagnose::Workspace> w, diagnose::prepare(rows, at_start));
  Shown out;
  FORCEGATE_TRY(out.view, diagnose::show_added(*w, before, request.effect));
  FORCEGATE_TRY(const std::unique_ptr<diagnose::Workspace> settled, diagnose::prepare(std::move(rows), at_end));
  if (const Result<Diagnosis> after = diagnose::show_added(*settled, before, request.effect)) diagnose::take_after(*after, out.view);
  out.pictures = record_pictures(*w, start, &refitted);
  return out;
}

AddedEffect added_effect(const diagnose::Refit& refit, const std::string& effect) {
  AddedEffect out{.effect = effect,
                  .is_needed = is_needed(refit),
                  .helps_one_law = helps_one_law(refit),
                  .error_before = refit.error_before,
                  .error_after = refit.error_after,
                  .floor = refit.floor,
                  .unit = refit.waterfall.unit,
                  .steps = {},
                  .parameters = {}};
  double error = refit.waterfall.start;
  for (const diagnose::Waterfall::Bar& bar : refit.waterfall.bars) {
    if (!std::isfinite(bar.as_added)) continue;  // a fit on the way failed: no step that could be drawn
    out.steps.push_back({bar.effect, error, error - bar.as_added, 0.0, !bar.hollow});
    error -= bar.as_added;
  }
  for (const diagnose::ParameterMove& m : refit.moves) out.parameters.push_back({m.name, m.unit, m.before, m.after, m.u});
  return out;
}

// Why export will refuse the model for the sake of this effect; "" where it will not.
std::string why_not_undone(const Model& model, const std::string& effect) {
  const auto compensator = make_compensator(model, {});
  if (compensator || compensator.error().where != effect) return {};
  const Error& e = compensator.error();
  return "export will refuse this model as it is: " + e.text + (e.hint.empty() ? "" : "; " + e.hint);
}

}  // namespace

Result<diagnose::Refit> add_request(const AddRequest& request) {
  FORCEGATE_TRY(diagnose::Refit refit, fit_request(request.campaign, request.effect));
  if (std::string why = why_not_undone(refit.model, request.effect); !why.empty()) refit.notes.push_back(std::move(why));
  if (!request.output.empty())
    FORCEGATE_CHECK_OK(write_file_atomically(request.output, write_model(refit.model)));
  return refit;
}

Result<std::string> added_page(const AddRequest& request, const diagnose::Refit& refit, const std::string& command_line) {
  FORCEGATE_TRY(Campaign campaign, load_campaign(request.campaign));
  FORCEGATE_TRY(const Model start, load_model(request.campaign, campaign));
  const bool single = campaign.records.size() == 1;
  std::optional<Shown> one_zero;  // the refit of one recording took the better of two ways
  if (single) {
    FORCEGATE_TRY(one_zero, show(campaign, start, refit.model, request, false));
  }
  FORCEGATE_TRY(Shown shown, show(std::move(campaign), start, refit.model, request, true));
  const auto apart = [&](const Shown& s) { return std::abs(s.view.plain_after - refit.plain_after); };
  if (one_zero && apart(*one_zero) < apart(shown)) shown = std::move(*one_zero);
  shown.view.judged_by = refit.judged_by;
  shown.view.floor = refit.floor;  // of the errors that stand beside it
  return added_html(shown.view, added_effect(refit, request.effect), {FORCEGATE_VERSION, command_line, false, std::move(shown.pictures)});
}

}  // namespace forcegate
