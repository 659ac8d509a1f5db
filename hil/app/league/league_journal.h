#pragma once
// Finished matches of a league, one JSON line each, so that an interrupted league goes on where it stopped. The
// first line names the seed, the size and the digest of the program: answers of another engine are not mixed in.

#include <string>

#include "hil/app/files/resume_journal.h"
#include "hil/app/league/league.h"

namespace forcegate {

/// Scores `reply` against the truth and the twin that the match has already; an answer that cannot be read becomes its error.
void take_reply(LeagueMatch& match, const LeagueReply& reply);

class LeagueJournal {
 public:
  /// With an empty path nothing is kept. Errors: those of ResumeJournal.
  static Result<LeagueJournal> open(const LeagueRequest& request, const std::string& engine);

  /// Fills the match when it was finished before.
  bool recall(LeagueMatch& match) const;
  /// Appends and flushes. From any thread.
  void keep(const LeagueMatch& match, const LeagueReply& reply);
  /// The first failure to write.
  Result<void> status() const { return journal_.status(); }

 private:
  ResumeJournal journal_;
};

}  // namespace forcegate
