#include "hil/app/league_journal.h"

#include <nlohmann/json.hpp>

#include "hil/base/digest.h"

namespace forcegate {
namespace {

using Json = nlohmann::ordered_json;

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
  if (match.error.empty()) take_reply(match, {j.value("answer", ""), j.value("naive", "")});
  return true;
}

void LeagueJournal::keep(const LeagueMatch& match, const LeagueReply& reply) {
  if (!journal_.keeps()) return;
  const Json j = {{"id", match.id},
                  {"seed", match.seed},
                  {"minutes", match.minutes},
                  {"engine_s", match.engine_s},
                  {"generation_s", match.generation_s},
                  {"error", match.error},
                  {"naive", reply.naive},
                  {"truth", hidden::to_json(match.truth)},
                  {"answer", reply.json}};
  journal_.keep(j.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace forcegate
