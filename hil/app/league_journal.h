#pragma once
// Finished matches of a league, one JSON line each, so that an interrupted league goes on where it stopped. The
// first line names the seed, the size and the digest of the program: answers of another engine are not mixed in.

#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "hil/app/league.h"

namespace forcegate {

/// Scores `reply` against the truth that the match has already; an answer that cannot be read becomes its error.
void take_reply(LeagueMatch& match, const LeagueReply& reply);

class LeagueJournal {
 public:
  /// With an empty path nothing is kept. Errors: io; config when the file belongs to another league, with the way
  /// out. A last line cut short (power, interrupt) is dropped and played again.
  static Result<LeagueJournal> open(const LeagueRequest& request, const std::string& engine);

  /// Fills the match when it was finished before.
  bool recall(LeagueMatch& match) const;
  /// Appends and flushes. From any thread.
  void keep(const LeagueMatch& match, const LeagueReply& reply);
  /// The first failure to write.
  Result<void> status() const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
  std::unique_ptr<std::mutex> turn_ = std::make_unique<std::mutex>();
  std::map<std::string, std::string> finished_;  ///< id -> line
  std::string path_;
  bool failed_ = false;
};

}  // namespace forcegate
