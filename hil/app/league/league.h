#pragma once
// `forcegate league`: the engine against many mysteries, and the table of how it did.
//
// Every campaign has its own seed, mixed from the league's; the campaigns of two league seeds share nothing.
// Results land in their own place, so that the tables do not depend on the number of threads.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/app/mystery/scoring.h"
#include "hil/base/result.h"
#include "rigs/emulated/hidden/campaign_maker.h"

namespace forcegate {

struct LeagueReply {
  std::string json;  ///< the JSON of `forcegate diagnose`
  std::string
      naive;  ///< what the largest residual correlation would have named (league_baseline.h); "" not asked
  std::optional<diagnose::BaseErrors> base = {};  ///< of the engine's starting model; none: not told
};

/// Anything that answers a campaign. An engine sees the records and what the lab wrote down, never the truth: the
/// campaign crosses the wall as forcegate::Campaign.
struct LeagueEngine {
  std::string name;
  std::function<Result<LeagueReply>(hidden::MadeCampaign&&)> answer;
  /// Errors of its starting model alone, of the force too where asked: what it is given is the twin of a campaign. None: the share of
  /// the reducible error is not told.
  std::function<Result<diagnose::BaseErrors>(hidden::MadeCampaign&&, bool with_force)> base = {};
};

/// The built-in diagnosis in this process, one thread a campaign, with the model that is used when none is given.
LeagueEngine built_in_engine();

/// An external engine: `command` with a campaign folder appended, answer on its stdout. Folders are made
/// below the system's temporary folder and removed. It tells nothing of a starting model.
LeagueEngine command_engine(std::string command);

struct LeagueRequest {
  std::uint64_t seed = 1;
  bool full = false;              ///< else the small corpus of shorter records
  unsigned threads = 0;           ///< 0: one a processor
  std::vector<std::string> only;  ///< effects to play, "none", "foreign", "pairs"; empty: all
  int per_effect = 0;  ///< campaigns per effect and strength; 0: 5 in the full league, 1 in the small one
  int controls = 0;    ///< clean campaigns; 0: 100 in the full league, 16 in the small one
  int others = 0;      ///< pairs, and as many foreign ones; 0: 40 in the full league, 8 in the small one
  std::filesystem::path journal;  ///< finished matches are kept here and not played again; empty: none
};

enum class LeagueClass { control, single, pair, foreign };

struct LeagueMatch {
  std::string id;  ///< "creep/weak/3"
  LeagueClass kind = LeagueClass::control;
  std::uint64_t seed = 0;  ///< `forcegate mystery --seed ...` makes the same campaign
  double minutes = 20.0;
  std::vector<std::string> effects;
  hidden::Tier tier = hidden::Tier::none;

  hidden::Truth truth;
  Answer answer;
  Score score;
  std::optional<TwinErrors> twin;  ///< of one effect that a model can predict, by an engine that tells its starting model's errors
  std::string naive;  ///< of LeagueReply
  std::string error;  ///< the engine's, when it gave no answer; counts as a miss
  double engine_s = 0.0, generation_s = 0.0;
};

struct LeagueResult {
  LeagueRequest request;
  std::string engine;
  std::vector<LeagueMatch> matches;
  double seconds = 0.0;
};

/// At least 100 controls, 5 campaigns per effect and strength, 40 pairs and 40 foreign ones when full; 16, 1,
/// 8 and 8 of them with long sines of five minutes otherwise.
std::vector<LeagueMatch> league_programme(const LeagueRequest& request);

Result<LeagueResult> play_league(const LeagueRequest& request, const LeagueEngine& engine,
                                 const std::function<void(double, std::string_view)>& progress);

/// The table for a person. Two leagues of one seed differ in the line of seconds only.
std::string league_text(const LeagueResult& result);
std::string league_json(const LeagueResult& result);
/// The command that makes the campaign of the gravest miss again: a clean one before the strongest effect; without a miss a league of the
/// next seed.
std::string league_next(const LeagueResult& result);

}  // namespace forcegate
