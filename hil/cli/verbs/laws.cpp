#include "hil/app/diagnose/laws.h"

#include <algorithm>

#include "hil/app/files/find_plan.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"

namespace forcegate {
namespace {

// The law with the terms that were found, asked again; where nothing lacks, the records that a dependence would show on.
std::string line_after(const Invocation& in, const std::vector<ParameterAnswer>& answers) {
  const auto lacking = std::ranges::find_if(answers, [](const ParameterAnswer& a) { return !a.added.empty(); });
  if (lacking == answers.end()) return find_plan("campaign") ? "forcegate plan campaign" : "forcegate record --help";
  std::string out = "forcegate laws " + file_quoted(in.text("TABLE")) + " --of " + shell_quoted(lacking->name);
  const auto repeat = [&](const std::string& option) {
    for (const std::string& word : in.texts(option)) out += " --" + option + " " + shell_quoted(word);
  };
  repeat("law");
  for (const FoundTerm& term : lacking->added) out += " --law " + shell_quoted(to_string(term.found.term));
  repeat("over");
  for (const char* option : {"scale", "alpha", "seed"})
    if (in.given(option)) repeat(option);
  return out;
}

Result<int> run(const Invocation& in) {
  LawsRequest request;
  request.table = in.text("TABLE");
  request.of = in.texts("of");
  request.over = in.texts("over");
  request.law = in.texts("law");
  request.scale = in.text("scale");
  FORCEGATE_TRY(request.alpha, in.number("alpha", 1e-6, 0.5));
  FORCEGATE_TRY(request.seed, in.seed("seed"));
  std::vector<std::string> notes;
  FORCEGATE_TRY(const std::vector<ParameterAnswer> answers, laws(request, &notes));
  in.console().print(laws_text(answers));
  in.console().notes(notes);
  in.console().print_json(laws_json(answers, notes));
  in.console().next(line_after(in, answers));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "laws",
    .group = "Diagnosis",
    .summary = "say what a fitted parameter depends on, over records",
    .description =
        "Reads a table with one row for each record: fitted parameters (b, c/a, a gain ...), their standard uncertainties "
        "(u_b) and what was different between the records (f_Hz, A_N, m_N, rest_s, temp_C, cycles ...). Tells which law "
        "lacks a dependence: every covariate as x, ln x, 1/x, x^2 and every product is tried beside the law given, by a "
        "permutation test whose error probability holds for the whole search, and by leaving records out.\n\n"
        "With few records the honest answer is often that no dependence is significant; it says how large one would have "
        "had to be.",
    .positionals = {{.name = "TABLE", .doc = "CSV with a header line and one row for each record.", .names = Names::input}},
    .options = {{.name = "of",
                 .value_name = "NAME",
                 .doc = "Parameter to explain.",
                 .required = true,
                 .repeatable = true},
                {.name = "over",
                 .value_name = "NAME",
                 .doc = "Covariate; default: every other column.",
                 .repeatable = true},
                {.name = "law",
                 .value_name = "TERM",
                 .doc = "What the law has already: f, \"ln f\", 1/f, f^2, f*m.",
                 .repeatable = true},
                {.name = "scale",
                 .value_name = "SCALE",
                 .doc = "The law is for y, ln y or 1/y.",
                 .fallback = "linear",
                 .choices =
                     [] {
                       return std::vector<std::string>{"linear", "log", "reciprocal"};
                     }},
                {.name = "alpha",
                 .value_name = "P",
                 .doc = "Probability of a false dependence, all parameters together.",
                 .fallback = "0.05"},
                {.name = "seed", .value_name = "N", .doc = "Seed of the permutations.", .fallback = "1"}},
    .examples = {{"forcegate laws table.csv --of b", "What does the decay rate depend on?"},
                 {"forcegate laws table.csv --of b --law f --over A --over m",
                  "Beside its law b = k f + b0, is A or m missing?"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
