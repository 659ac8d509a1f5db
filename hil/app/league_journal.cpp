#include "hil/app/league_journal.h"

#include <fstream>
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
  journal.path_ = request.journal.string();
  FORCEGATE_TRY(const std::string header, header_of(request, engine));
  std::uintmax_t whole = 0;
  if (std::ifstream old(request.journal, std::ios::binary); old) {
    std::string line;
    bool first = true;
    while (std::getline(old, line) && !old.eof()) {
      whole += line.size() + 1;
      if (first && line != header)
        return fail(ErrorCode::config, "the journal belongs to another league or another build", journal.path_,
                    "remove it, or name another file");
      if (!first) {
        const Json j = Json::parse(line, nullptr, false);
        if (j.is_object() && j.contains("id") && j["id"].is_string()) journal.finished_[j["id"]] = line;
      }
      first = false;
    }
  }
  std::error_code failed;
  if (whole > 0) std::filesystem::resize_file(request.journal, whole, failed);
  journal.file_.reset(std::fopen(journal.path_.c_str(), whole > 0 ? "ab" : "wb"));
  if (!journal.file_ || failed)
    return fail(ErrorCode::io, "the journal cannot be written", journal.path_, "create its folder first");
  if (whole == 0) std::fprintf(journal.file_.get(), "%s\n", header.c_str());
  return journal;
}

bool LeagueJournal::recall(LeagueMatch& match) const {
  const auto at = finished_.find(match.id);
  if (at == finished_.end()) return false;
  const Json j = Json::parse(at->second, nullptr, false);
  if (j.value("seed", std::uint64_t{0}) != match.seed || j.value("minutes", 0.0) != match.minutes) return false;
  match.engine_s = j.value("engine_s", 0.0);
  match.generation_s = j.value("generation_s", 0.0);
  match.error = j.value("error", "");
  if (auto truth = hidden::truth_from_json(j.value("truth", ""))) match.truth = std::move(*truth);
  if (match.error.empty()) take_reply(match, {j.value("answer", ""), j.value("naive", "")});
  return true;
}

void LeagueJournal::keep(const LeagueMatch& match, const LeagueReply& reply) {
  if (!file_) return;
  const Json j = {{"id", match.id},
                  {"seed", match.seed},
                  {"minutes", match.minutes},
                  {"engine_s", match.engine_s},
                  {"generation_s", match.generation_s},
                  {"error", match.error},
                  {"naive", reply.naive},
                  {"truth", hidden::to_json(match.truth)},
                  {"answer", reply.json}};
  const std::string line = j.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  const std::lock_guard lock(*turn_);
  failed_ |= std::fwrite(line.data(), 1, line.size(), file_.get()) != line.size() || std::fflush(file_.get()) != 0;
}

Result<void> LeagueJournal::status() const {
  if (failed_) return fail(ErrorCode::io, "the journal could not be written to the end", path_, "is the disk full?");
  return {};
}

}  // namespace forcegate
