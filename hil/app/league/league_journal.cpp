#include "hil/app/league/league_journal.h"

#include <nlohmann/json.hpp>

#include "hil/base/digest.h"

namespace forcegate {
namespace {

using Json = nlohmann::ordered_json;

Json error_json(const diagnose::BaseError& e) { return {{"own_levels", e.own_levels}, {"common_levels", e.common_levels}}; }

Json errors_json(const diagnose::BaseErrors& e) {
  Json j = {{"output", error_json(e.output)}};
  if (e.force) j["force"] = error_json(*e.force);
  return j;
}

diagnose::BaseError error_of(const Json& j) { return {j.value("own_levels", 0.0), j.value("common_levels", 0.0)}; }

diagnose::BaseErrors errors_of(const Json& j) {
  diagnose::BaseErrors e{error_of(j.value("output", Json::object())), std::nullopt};
  if (j.contains("force")) e.force = error_of(j["force"]);
  return e;
}

Result<std::string> header_of(const LeagueRequest& request, const std::string& engine) {
  FORCEGATE_TRY(const std::string program, sha256_file("/proc/self/exe"));
  return Json{{"league", 1},
              {"seed", request.seed},
              {"size", request.full ? "full" : "small"},
              {"engine", engine},
              {"program", program}}
      .dump();
}

}  // namespace

Result<LeagueJournal> LeagueJournal::open(const LeagueRequest& request, const std::string& engine) {
  LeagueJournal journal;
  if (request.journal.empty()) return journal;
  FORCEGATE_TRY(const std::string header, header_of(request, engine));
  FORCEGATE_TRY(journal.journal_, ResumeJournal::open(request.journal, header));
  return journal;
}

bool LeagueJournal::recall(LeagueMatch& match) const {
  const std::string* line = journal_.find(match.id);
  if (line == nullptr) return false;
  const Json j = Json::parse(*line, nullptr, false);
  if (j.value("seed", std::uint64_t{0}) != match.seed || j.value("minutes", 0.0) != match.minutes)
    return false;
  match.engine_s = j.value("engine_s", 0.0);
  match.generation_s = j.value("generation_s", 0.0);
  match.error = j.value("error", "");
  if (auto truth = hidden::truth_from_json(j.value("truth", ""))) match.truth = std::move(*truth);
  if (const auto twin = j.find("twin"); twin != j.end())
    match.twin = TwinErrors{errors_of(twin->value("campaign", Json::object())), errors_of(twin->value("twin", Json::object()))};
  if (match.error.empty()) take_reply(match, {j.value("answer", ""), j.value("naive", ""), std::nullopt});
  return true;
}

void LeagueJournal::keep(const LeagueMatch& match, const LeagueReply& reply) {
  if (!journal_.keeps()) return;
  Json j = {{"id", match.id},
            {"seed", match.seed},
            {"minutes", match.minutes},
            {"engine_s", match.engine_s},
            {"generation_s", match.generation_s},
            {"error", match.error},
            {"naive", reply.naive},
            {"truth", hidden::to_json(match.truth)},
            {"answer", reply.json}};
  if (match.twin) j["twin"] = {{"campaign", errors_json(match.twin->campaign)}, {"twin", errors_json(match.twin->twin)}};
  journal_.keep(j.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace forcegate
