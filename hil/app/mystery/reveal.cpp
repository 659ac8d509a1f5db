#include "hil/app/mystery/reveal.h"

#include <fmt/format.h>

#include "hil/app/mystery/mystery.h"
#include "hil/base/plain_number.h"
#include "hil/base/read_file.h"
#include "hil/base/text.h"
#include "hil/trace/campaign_description.h"
#include "rigs/emulated/hidden/seal.h"

namespace forcegate {
namespace {

Result<Answer> read_answer(const RevealRequest& request) {
  if (!request.effect.empty()) {
    std::vector<std::string> names = mystery_effect_names();
    names.push_back("unknown");
    if (std::find(names.begin(), names.end(), request.effect) == names.end()) {
      const std::string near = nearest_name(request.effect, names);
      return fail(ErrorCode::usage, "there is no effect \"" + request.effect + "\"", "--effect",
                  near.empty() ? "an effect's name, none or unknown" : "did you mean \"" + near + "\"?");
    }
    return answer_of(request.effect == "foreign" ? "unknown" : request.effect);
  }
  auto text = read_file(request.answer_file);
  if (!text) {
    text.error().hint = "write it with: forcegate diagnose CAMPAIGN --json > answer.json";
    return Unexpected(text.error());
  }
  auto answer = answer_from_json(*text);
  if (!answer)
    answer.error().where =
        request.answer_file.string() + (answer.error().where.empty() ? "" : ": ") + answer.error().where;
  return answer;
}

// The seal is broken by looking: an answer to another question is told before. A mystery whose description is gone cannot be asked.
Result<void> check_campaign(const Answer& answer, const RevealRequest& request) {
  if (answer.campaign.empty()) return {};
  const auto description = read_description(request.folder / "campaign.json");
  if (!description || description->name == answer.campaign) return {};
  if (description->records)
    for (const DescribedRecord& record : *description->records)
      if (record.facts.name == answer.campaign) return {};  // one recording of it was diagnosed
  return fail(ErrorCode::usage, "this is the answer to the campaign \"" + answer.campaign + "\", and this one is \"" + description->name + "\"; the seal stays closed",
              request.answer_file.string(), "forcegate diagnose " + file_quoted(request.folder.string()) + " --json > answer.json");
}

std::string names_of(const hidden::Truth& truth) {
  if (truth.effects.empty()) return "nothing";
  std::string names;
  for (const auto& effect : truth.effects) names += (names.empty() ? "" : " and ") + effect.name;
  return names;
}

// What of the error could be reduced at all is not told: that takes the starting model's error on records without the effect.
std::string error_sentence(const hidden::Truth& truth, const Answer& answer) {
  if (truth.effects.size() != 1 || !truth.effects[0].reducible) return "";
  const hidden::TruthEffect& effect = truth.effects[0];
  const bool in_force = effect.measure == "force", force = in_force && answer.force_error_before && answer.force_error_after;
  const auto before = force ? answer.force_error_before : answer.error_before, after = force ? answer.force_error_after : answer.error_after;
  if (!before || !after) return "";
  const auto text = [](double value, const char* unit_name) {
    const PrintedUnit unit = printed_unit(unit_name);
    return plain_number(unit.factor * value) + " " + unit.name;
  };
  const char* unit = force ? "N" : "V";
  return fmt::format(" The held-out error goes from {} to {}; the effect itself, less one gain and zero, is {} in the records held out.",
                     text(*before, unit), text(*after, unit), text(effect.heldout_rms, in_force ? "N" : "V"));
}

// Claims of what was not hidden.
std::string claims_beside(const hidden::Truth& truth, const Answer& answer) {
  std::string out;
  for (const AnswerFinding& f : answer.findings)
    if (f.claimed() && true_effect(truth, f.effect) == nullptr) out += (out.empty() ? "" : " and ") + f.effect;
  return out;
}

// What an answer lists first it need not claim; of a single effect it does so only where the verdict is "known".
std::string answer_sentence(const hidden::Truth& truth, const Answer& answer) {
  if (answer.findings.empty()) return ", the answer was " + answer.verdict + ".";
  const AnswerFinding& first = answer.findings.front();
  const bool is_there = true_effect(truth, first.effect) != nullptr, alone = is_there && truth.effects.size() == 1;
  if (first.claimed() && !alone) return ", the answer was " + first.effect + ".";
  const std::string but = first.claimed() ? fmt::format("the verdict is \"{}\"", answer.verdict) : fmt::format("not claimed ({:.2g})", first.probability);
  return alone ? ", in the answer it is listed first, but " + but + "." : ", in the answer " + first.effect + " is listed first, but " + but + ".";
}

std::string sentence_of(const hidden::Truth& truth, const Answer& answer, const Score& s, bool right) {
  if (right && truth.effects.empty()) return "Right: nothing was hidden.";
  if (right && truth.foreign()) return "Right: what was hidden is in no catalogue.";
  std::string text = right ? "Right: " + names_of(truth) + "."
                           : "Wrong: hidden was " + names_of(truth) + answer_sentence(truth, answer);
  if (!right && s.rank > 1) text += fmt::format(" It stands at place {} of the findings.", s.rank);
  if (!right && s.look_alike) text += " The answer says that the two cannot be told apart here.";
  if (s.rank > 0 && !s.side_right) text += " The side is wrong.";
  if (s.false_claims > 0 && s.rank > 0) text += " The answer also claims " + claims_beside(truth, answer) + ", which " + (s.false_claims > 1 ? "were" : "was") + " not hidden.";
  if (s.named) text += error_sentence(truth, answer);
  if (!right && !truth.effects.empty() && !truth.effects[0].excited)
    text += " The records did not excite it: nobody could have known.";
  return text;
}

}  // namespace

std::string truth_text(const hidden::Truth& truth) {
  if (truth.effects.empty()) return "hidden: nothing, this is a clean campaign\n";
  std::string text;
  for (const hidden::TruthEffect& e : truth.effects) {
    text += fmt::format("hidden: {} ({}{}), {}\n", e.name, e.foreign ? "outside the catalogue, " : "", e.side,
                        hidden::to_string(truth.tier));
    text += fmt::format("        {}\n", e.form);
    text += fmt::format(
        "        RMS {:.2f} % of the span of {} where it acts most; the noise there is {:.2f} %{}\n",
        e.rms_pct, e.measure == "force" ? "F_ref" : "U",
        e.measure == "force" ? truth.force_noise_pct : truth.voltage_noise_pct,
        e.excited ? "" : "; not excited by these records");
    if (e.between_records)
      text += fmt::format("        between records d' = {:.1f}{}\n", e.detectability, e.cause_recorded ? "" : ", and what moves it was not recorded");
  }
  return text;
}

Result<RevealResult> reveal(const RevealRequest& request) {
  if (!request.answer_file.empty() && !request.effect.empty())
    return fail(ErrorCode::usage, "--answer and --effect exclude each other");
  FORCEGATE_TRY(const hidden::SealedSheet sheet, hidden::read_sealed(request.folder));
  RevealResult result;
  if (!request.answer_file.empty() || !request.effect.empty()) {
    FORCEGATE_TRY(result.answer, read_answer(request));
    FORCEGATE_CHECK_OK(check_campaign(*result.answer, request));
  }
  FORCEGATE_TRY(result.truth_json, hidden::open(sheet));
  FORCEGATE_TRY(result.truth, hidden::truth_from_json(result.truth_json));
  result.commitment = sheet.commitment;
  if (!result.answer) return result;
  const Score s = score(result.truth, *result.answer);
  const hidden::Truth& truth = result.truth;
  result.right = truth.effects.empty()       ? s.clean
                 : truth.foreign()           ? s.honest
                 : truth.effects.size() == 2 ? s.pair_in_three
                                             : s.named;
  result.score = s;
  result.sentence = sentence_of(truth, *result.answer, s, result.right);
  return result;
}

}  // namespace forcegate
