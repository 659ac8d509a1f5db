#include "hil/app/league/league.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>

#include "hil/app/league/league_journal.h"
#include "hil/app/mystery/mystery.h"
#include "hil/base/parallel.h"
#include "hil/base/rng.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

constexpr hidden::Tier kTiers[] = {hidden::Tier::weak, hidden::Tier::medium, hidden::Tier::strong};

bool wanted(const LeagueRequest& request, const std::string& name) {
  return request.only.empty() ||
         std::find(request.only.begin(), request.only.end(), name) != request.only.end();
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

Result<void> check_names(const std::vector<std::string>& only) {
  std::vector<std::string> known = mystery_effect_names();
  known.push_back("pairs");
  for (const std::string& name : only) {
    if (std::ranges::find(known, name) != known.end()) continue;
    const std::string near = nearest_name(name, known);
    return fail(ErrorCode::usage, "there is no effect \"" + printable_utf8(name) + "\"", "--only",
                (near.empty() ? "" : "did you mean \"" + near + "\"? ") + std::string("there are none, pairs, foreign, and the names that forcegate mystery --list prints"));
  }
  return {};
}

/// Two different effects of the catalogue; not two that both only change a channel's noise.
std::vector<std::string> draw_pair(Rng& rng, const std::vector<std::string>& names) {
  const std::vector<std::string> noises = {"reference_noise", "outliers", "dropouts", "hum"};
  const auto noise = [&](const std::string& n) {
    return std::find(noises.begin(), noises.end(), n) != noises.end();
  };
  for (;;) {
    const std::string &a = names[rng.below(names.size())], &b = names[rng.below(names.size())];
    if (a != b && !(noise(a) && noise(b))) return {a, b};
  }
}

hidden::CampaignRequest request_of(const LeagueMatch& match) {
  return {match.seed, "campaign", match.effects, match.tier, match.minutes};
}

// Only the starting model sees the twin: it is not diagnosed.
void ask_twin(LeagueMatch& match, const LeagueEngine& engine, const LeagueReply& reply) {
  if (!engine.base || !reply.base || match.kind != LeagueClass::single || !match.truth.effects.front().reducible) return;
  auto made = hidden::make_twin(request_of(match));
  if (!made) return;
  auto base = engine.base(std::move(*made), match.truth.effects.front().measure == "force");
  if (base) match.twin = TwinErrors{*reply.base, *base};
}

void play(LeagueMatch& match, const LeagueEngine& engine, LeagueReply& kept) {
  auto start = std::chrono::steady_clock::now();
  auto made = hidden::make_campaign(request_of(match));
  match.generation_s = seconds_since(start);
  if (!made) {
    match.error = made.error().text;
    return;
  }
  match.truth = made->truth;
  start = std::chrono::steady_clock::now();
  Result<LeagueReply> reply = engine.answer(std::move(*made));
  match.engine_s = seconds_since(start);
  if (!reply) {
    match.error = reply.error().to_text();
    return;
  }
  ask_twin(match, engine, *reply);
  take_reply(match, *reply);
  kept = std::move(*reply);
}

}  // namespace

void take_reply(LeagueMatch& match, const LeagueReply& reply) {
  match.naive = reply.naive;
  auto answer = answer_from_json(reply.json);
  if (answer) {
    match.answer = std::move(*answer);
    match.score = score(match.truth, match.answer, match.twin ? &*match.twin : nullptr);
  } else {
    match.error = answer.error().to_text();
  }
}

std::vector<LeagueMatch> league_programme(const LeagueRequest& request) {
  const auto or_default = [&](int given, int full, int small) {
    return given > 0 ? given : request.full ? full : small;
  };
  const int controls = or_default(request.controls, 100, 16), others = or_default(request.others, 40, 8);
  const int each = or_default(request.per_effect, 5, 1);
  const double minutes = request.full ? 20.0 : 5.0;
  std::vector<LeagueMatch> programme;
  const auto add = [&](LeagueClass kind, const std::string& id, std::vector<std::string> effects,
                       hidden::Tier tier) {
    LeagueMatch match;
    match.id = id;
    match.kind = kind;
    match.seed = mix_seed(request.seed, "league/" + id) >> 16;
    match.minutes = minutes;
    match.effects = std::move(effects);
    match.tier = tier;
    programme.push_back(std::move(match));
  };
  if (wanted(request, "none"))
    for (int k = 0; k < controls; ++k)
      add(LeagueClass::control, "none/" + std::to_string(k), {}, hidden::Tier::none);
  const std::vector<std::string> known = hidden::effect_names(false), foreign = hidden::effect_names(true);
  for (const std::string& name : known)
    for (const hidden::Tier tier : kTiers)
      for (int k = 0; k < each && wanted(request, name); ++k)
        add(LeagueClass::single, name + "/" + std::string(to_string(tier)) + "/" + std::to_string(k), {name},
            tier);
  Rng rng(request.seed, "pairs");
  for (int k = 0; k < others; ++k) {
    std::vector<std::string> pair = draw_pair(rng, known);
    const hidden::Tier tier = kTiers[1 + k % 2];
    if (wanted(request, "pairs"))
      add(LeagueClass::pair, "pair/" + pair[0] + "+" + pair[1] + "/" + std::to_string(k), pair, tier);
  }
  for (int k = 0; k < others; ++k) {
    const std::string& name = foreign[static_cast<std::size_t>(k) % foreign.size()];
    if (wanted(request, "foreign") || (!request.only.empty() && wanted(request, name)))
      add(LeagueClass::foreign, name + "/" + std::to_string(k), {name},
          kTiers[1 + k / static_cast<int>(foreign.size()) % 2]);
  }
  return programme;
}

namespace {

// Of an error in full its first line, without "error: ".
std::string error_words(const std::string& error) {
  const std::string line = error.substr(0, error.find('\n'));
  return line.starts_with("error: ") ? line.substr(7) : line;
}

}  // namespace

Result<LeagueResult> play_league(const LeagueRequest& request, const LeagueEngine& engine,
                                 const std::function<void(double, std::string_view)>& progress) {
  const auto start = std::chrono::steady_clock::now();
  LeagueResult result;
  result.request = request;
  result.engine = engine.name;
  FORCEGATE_CHECK_OK(check_names(request.only));
  result.matches = league_programme(request);
  if (result.matches.empty())
    return fail(ErrorCode::usage, "no campaign is left to play: " + join(request.only, ", ") + " is not among these", "--only", "more of the foreign ones are played with --others N");
  FORCEGATE_TRY(LeagueJournal journal, LeagueJournal::open(request, engine.name));
  std::vector<std::size_t> waiting;
  for (std::size_t i = 0; i < result.matches.size(); ++i)
    if (!journal.recall(result.matches[i])) waiting.push_back(i);
  // long ones first would finish sooner; the order of the programme keeps the journal readable
  std::atomic<std::size_t> done{result.matches.size() - waiting.size()};
  std::mutex turn;
  parallel_for(waiting.size(), request.threads, [&](std::size_t k) {
    const std::size_t i = waiting[k];
    LeagueReply reply;
    play(result.matches[i], engine, reply);
    journal.keep(result.matches[i], reply);
    const double share = static_cast<double>(++done) / static_cast<double>(result.matches.size());
    if (!progress) return;
    const std::lock_guard lock(turn);
    progress(share, result.matches[i].id);
  });
  FORCEGATE_CHECK_OK(journal.status());
  result.seconds = seconds_since(start);
  if (std::ranges::none_of(result.matches, [](const LeagueMatch& m) { return m.error.empty(); }))
    return fail(ErrorCode::config, fmt::format("the engine answered none of {} campaigns: {}", result.matches.size(), error_words(result.matches.front().error)), engine.name,
                "try it by hand on one of them: forcegate mystery m, then ENGINE m");
  return result;
}

}  // namespace forcegate
