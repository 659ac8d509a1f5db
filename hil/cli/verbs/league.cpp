#include "hil/app/league/league.h"

#include "hil/app/files/own_file.h"
#include "hil/app/files/write_file.h"
#include "hil/base/text.h"
#include "hil/cli/command.h"
#include "hil/cli/interrupt.h"
#include "hil/cli/verbs/force_row.h"

namespace forcegate {
namespace {

std::vector<std::string> sizes() { return {"small", "full"}; }

Result<int> run(const Invocation& in) {
  LeagueRequest request;
  if (in.given("out") && !in.flag("force")) FORCEGATE_CHECK_OK(check_own_file(in.text("out"), kMarkOfLeague));
  FORCEGATE_TRY(request.seed, in.seed("seed"));
  FORCEGATE_TRY(const std::int64_t threads, in.integer("threads", 0, 256));
  FORCEGATE_TRY(const std::int64_t each, in.integer("each", 0, 1000));
  request.threads = static_cast<unsigned>(threads);
  request.per_effect = static_cast<int>(each);
  FORCEGATE_TRY(const std::int64_t controls, in.integer("controls", 0, 100000));
  FORCEGATE_TRY(const std::int64_t others, in.integer("others", 0, 100000));
  request.controls = static_cast<int>(controls);
  request.others = static_cast<int>(others);
  request.journal = in.text("journal");
  if (!request.journal.empty()) help_after_interrupt("what is finished is kept in " + printable_utf8(request.journal.string()) + ": the same command goes on from there");
  request.full = in.text("size") == "full";
  if (in.given("only")) request.only = split(in.text("only"), ',');
  const LeagueEngine engine = in.given("engine") ? command_engine(in.text("engine")) : built_in_engine();
  Console& console = in.console();
  FORCEGATE_TRY(const LeagueResult result, play_league(request, engine, console.progress_callback()));
  console.end_progress();
  const std::string json = league_json(result);
  if (in.given("out")) FORCEGATE_CHECK_OK(write_file_atomically(in.text("out"), json + "\n"));
  console.print(league_text(result));
  console.print_json(json);
  console.next(league_next(result));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "league",
    .group = "Diagnosis",
    .summary = "score the diagnosis on many campaigns with hidden effects",
    .description =
        "Makes clean campaigns, campaigns with each effect of the catalogue at three strengths, "
        "with pairs and with foreign "
        "effects, lets the engine answer each without knowing, and prints how often it was right: "
        "intervals are Wilson's, 95 % (on clean campaigns the exact ones of Clopper and Pearson). Beside it stand two "
        "rules that need no engine: always \"none\", and the largest residual correlation. Every miss is listed with the "
        "step at which it was lost and the seed that makes the same campaign with `forcegate "
        "mystery`.\n\nThe reducible error removed is (before - after) / (before - twin): held-out errors of the answer, and of the "
        "model that it began with on the campaign's twin, the same records and random numbers with nothing hidden. It is counted where "
        "the twin's error is at least a tenth below; a miss removes 0. An external engine does not see the twin and has no such "
        "line.\n\nThe table does "
        "not depend on the number of threads. Use a seed that nobody has tuned on.",
    .options = {{.name = "seed", .value_name = "N", .doc = "Seed of the corpus.", .fallback = "1"},
                {.name = "size",
                 .value_name = "SIZE",
                 .doc = "small: 119 campaigns of short records; full: 615.",
                 .fallback = "small",
                 .choices = sizes},
                {.name = "threads",
                 .value_name = "T",
                 .doc = "Campaigns at a time; 0: one a processor.",
                 .fallback = "0"},
                {.name = "each",
                 .value_name = "N",
                 .doc = "Campaigns per effect and strength; 0: 1 small, 5 full.",
                 .fallback = "0"},
                {.name = "controls",
                 .value_name = "N",
                 .doc = "Clean campaigns; 0: 16 small, 100 full.",
                 .fallback = "0"},
                {.name = "others",
                 .value_name = "N",
                 .doc = "Pairs, and as many foreign ones; 0: 8 small, 40 full.",
                 .fallback = "0"},
                {.name = "only",
                 .value_name = "LIST",
                 .doc = "Effects to play, or none, pairs, foreign; separated by commas."},
                {.name = "engine",
                 .value_name = "COMMAND",
                 .doc = "Score another engine: COMMAND FOLDER prints the JSON of diagnose. It is not given the "
                        "twins: no line of the reducible error removed."},
                {.name = "journal",
                 .value_name = "FILE",
                 .doc = "Keep finished campaigns here; the same command goes on after an interrupt."},
                {.name = "out", .value_name = "FILE", .doc = "Write all results as JSON.", .names = Names::file},
                force_row()},
    .examples = {{"forcegate league --seed 20261121", "The small league:"},
                 {"forcegate league --seed 5 --only hysteresis,creep,none --each 10", "One question only:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
