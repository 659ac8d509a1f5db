#include "hil/app/mystery/scoring.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "hil/base/text.h"
#include "hil/diagnose/choose/select.h"

namespace forcegate {
namespace {

using Json = nlohmann::json;

std::optional<double> number(const Json& object, const char* key) {
  const auto at = object.find(key);
  if (at == object.end() || !at->is_number()) return std::nullopt;
  return at->get<double>();
}

bool accepts_side(const hidden::TruthEffect& effect, const std::string& side) {
  return side == effect.side ||
         std::find(effect.also_side.begin(), effect.also_side.end(), side) != effect.also_side.end();
}

// "adapted" lists what a record may have of its own.
bool keeps_common_levels(const Json& object) {
  const auto at = object.find("adapted");
  return at != object.end() && at->is_array() && std::find(at->begin(), at->end(), "gain") == at->end();
}

std::optional<Reduction> reduction_of(const hidden::Truth& truth, const Answer& answer, bool named, const TwinErrors* twin) {
  constexpr double kLeast = 0.1;  // of the error before
  if (!twin || truth.effects.size() != 1 || truth.foreign() || !truth.effects[0].reducible) return std::nullopt;
  const hidden::TruthEffect& effect = truth.effects[0];
  const bool between = is_between_records(effect.name);
  const auto counted = [&](const std::string& unit, const diagnose::BaseError& campaign, const diagnose::BaseError& of_twin,
                           std::optional<double> before, std::optional<double> after, bool common) -> std::optional<Reduction> {
    if (!named) {
      if (!before || common != between) before = campaign.of(between);
      after = before, common = between;
    }
    if (!before || !after) return std::nullopt;
    const Reduction r{unit, *before, *after, of_twin.of(common)};
    return r.before > 0.0 && r.before - r.twin >= kLeast * r.before ? std::optional(r) : std::nullopt;
  };
  if (effect.measure == "force" && twin->campaign.force && twin->twin.force)
    if (auto force = counted("N", *twin->campaign.force, *twin->twin.force, answer.force_error_before, answer.force_error_after,
                             answer.force_common_levels))
      return force;
  // a rig that moves otherwise is no error of the output: the twin's force took another course
  if (effect.measure == "force" && effect.side == "rig") return std::nullopt;
  return counted("V", twin->campaign.output, twin->twin.output, answer.error_before, answer.error_after, answer.common_levels);
}

}  // namespace

Result<Answer> answer_from_json(const std::string& text) {
  try {
    const Json j = Json::parse(text);
    Answer answer;
    answer.campaign = j.value("campaign", "");
    j.at("verdict").get_to(answer.verdict);
    if (answer.verdict != "none" && answer.verdict != "known" && answer.verdict != "unknown")
      return fail(ErrorCode::parse, "the verdict is \"" + answer.verdict + "\"", "verdict",
                  "it is none, known or unknown");
    for (const Json& f : j.value("findings", Json::array())) {
      AnswerFinding finding{f.at("effect"), f.value("side", ""), f.value("probability", 1.0), {}};
      for (const Json& other : f.value("confounded_with", Json::array()))
        finding.confounded_with.push_back(other.is_string() ? other.get<std::string>()
                                                            : other.at("effect").get<std::string>());
      answer.findings.push_back(std::move(finding));
    }
    for (const Json& name : j.value("depends_on", Json::array())) answer.depends_on.push_back(name);
    answer.error_before = number(j, "error_before");
    answer.error_after = number(j, "error_after");
    answer.common_levels = keeps_common_levels(j);
    if (j.contains("errors") && j["errors"].contains("F")) {
      answer.force_error_before = number(j["errors"]["F"], "before");
      answer.force_error_after = number(j["errors"]["F"], "after");
      answer.force_common_levels = keeps_common_levels(j["errors"]["F"]);
    }
    for (const Json& row : j.value("ranking", Json::array()))
      answer.ranking.push_back({row.value("effect", ""), number(row, "score").value_or(0.0)});
    std::stable_sort(answer.ranking.begin(), answer.ranking.end(),
                     [](const AnswerRank& a, const AnswerRank& b) { return a.score > b.score; });
    for (const Json& row : j.value("refused", Json::array()))
      answer.refused.try_emplace(row.at("effect").get<std::string>(), row.value("reason", ""));
    for (const char* key : {"reason", "sentence", "summary"})
      if (answer.reason.empty() && j.contains(key) && j[key].is_string()) answer.reason = j[key];
    return answer;
  } catch (const Json::exception& e) {
    const std::string_view what = e.what();  // "[json.exception.parse_error.101] parse error at line 1 ..."
    const std::size_t end = what.find("] ");
    return fail(ErrorCode::parse, "this is not an answer of diagnose: " + printable_utf8(what.substr(end == std::string_view::npos ? 0 : end + 2)), "",
                "such an answer is what forcegate diagnose CAMPAIGN --json prints");
  }
}

Answer answer_of(const std::string& effect) {
  Answer answer;
  answer.verdict = effect == "none" || effect == "unknown" ? effect : "known";
  if (answer.verdict == "known") answer.findings.push_back({effect, "", 1.0, {}});
  return answer;
}

double Reduction::share() const { return std::clamp((before - after) / (before - twin), -1.0, 1.0); }

const hidden::TruthEffect* true_effect(const hidden::Truth& truth, const std::string& name) {
  for (const hidden::TruthEffect& effect : truth.effects)
    if (!effect.foreign && effect.name == name) return &effect;
  return nullptr;
}

bool AnswerFinding::claimed() const { return probability >= kClaim; }

Score score(const hidden::Truth& truth, const Answer& answer, const TwinErrors* twin) {
  Score s;
  const bool foreign = truth.foreign(), clean = truth.effects.empty();
  const bool elsewhere = std::none_of(truth.effects.begin(), truth.effects.end(),
                                      [](const auto& e) { return accepts_side(e, "sensor"); });
  std::size_t in_three = 0;
  for (std::size_t i = 0; i < answer.findings.size(); ++i) {
    const AnswerFinding& finding = answer.findings[i];
    const hidden::TruthEffect* hit = true_effect(truth, finding.effect);
    if (hit) {
      if (i < 3) ++in_three;
      if (s.rank == 0) {
        s.rank = static_cast<int>(i) + 1;
        s.side_right = finding.side.empty() || accepts_side(*hit, finding.side);
      }
    } else if (finding.claimed()) {
      ++s.false_claims;
      if (elsewhere && !clean && finding.side == "sensor") s.sensor_blamed = true;
    }
  }
  s.named = answer.verdict == "known" && s.rank == 1;
  s.top2 = s.rank == 1 || s.rank == 2;
  s.top3 = s.top2 || s.rank == 3;
  if (!s.named && !answer.findings.empty())
    for (const std::string& other : answer.findings[0].confounded_with)
      s.look_alike |= answer.verdict == "known" && true_effect(truth, other) != nullptr;
  s.pair_in_three = truth.effects.size() == 2 && in_three == 2;
  s.honest = foreign && answer.verdict == "unknown" && s.false_claims == 0;
  s.clean = clean && answer.verdict == "none" && s.false_claims == 0;
  s.reduction = reduction_of(truth, answer, s.named, twin);
  return s;
}

Interval wilson_95(std::size_t k, std::size_t n) {
  if (n == 0) return {};
  constexpr double z = 1.959963984540054;
  const double count = static_cast<double>(n), p = static_cast<double>(k) / count, zz = z * z / count;
  const double middle = (p + 0.5 * zz) / (1.0 + zz);
  const double half = z * std::sqrt(p * (1.0 - p) / count + 0.25 * zz / count) / (1.0 + zz);
  return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

double score_quantile(std::vector<double> values, double p) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double at = p * static_cast<double>(values.size() - 1);
  const auto i = static_cast<std::size_t>(at);
  if (i + 1 >= values.size()) return values.back();
  return values[i] + (at - static_cast<double>(i)) * (values[i + 1] - values[i]);
}

}  // namespace forcegate
