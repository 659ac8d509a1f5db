#include "hil/app/files/own_file.h"
#include "hil/app/recording/stimulus.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hil/base/text.h"
#include "hil/cli/command.h"
#include "hil/cli/parse.h"
#include "hil/cli/verbs/force_row.h"

namespace forcegate {
namespace {

using Json = nlohmann::ordered_json;
constexpr double kWheelEnd_N = 5.5;

std::vector<std::string> names() { return Registry<StimulusKind>::instance().names(); }

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json table_json() {
  Json list = Json::array();
  for (const StimulusKind& kind : Registry<StimulusKind>::instance().all()) {
    Json parameters = Json::array();
    for (const StimulusParameter& p : kind.parameters)
      parameters.push_back({{"name", p.name},
                            {"unit", p.unit},
                            {"kind", p.is_text   ? "text"
                                     : p.is_list ? "list"
                                                 : "number"},
                            {"default", number_or_null(p.fallback)},
                            {"minimum", number_or_null(p.minimum)},
                            {"maximum", number_or_null(p.maximum)},
                            {"doc", p.doc}});
    list.push_back({{"name", kind.name}, {"doc", kind.doc}, {"parameters", parameters}});
  }
  return list;
}

std::string fact(const char* label, double value, const char* unit) {
  return fmt::format("  {:<22}{} {}", label, std::isnan(value) ? "-" : with_uncertainty(value, 0.0), unit);
}

Result<int> list(const Invocation& in) {
  in.console().print(stimulus_table_text());
  in.console().print_json(Json{{"format", 1}, {"stimuli", table_json()}}.dump(2));
  in.console().next("forcegate stimulus sine f_Hz=0.5 A_N=1.05 m_N=2.15 --plot sine.svg");
  return kExitSuccess;
}

constexpr double kFewestSamples = 2.0, kEnoughSamples = 10.0;  // in a cycle

// By its parameters; 0: none tells one.
double highest_frequency(const StimulusSpec& spec) {
  const auto is_frequency = [](const std::string& name) { return name.starts_with("f_") && name.ends_with("Hz"); };
  double out = 0.0;
  for (const auto& [name, value] : spec.numbers)
    if (is_frequency(name)) out = std::max(out, value);
  for (const auto& [name, values] : spec.lists)
    if (is_frequency(name))
      for (const double value : values) out = std::max(out, value);
  return out;
}

Result<int> run(const Invocation& in) {
  if (in.flag("list")) return list(in);
  const std::vector<std::string> words = in.texts("KEY=VALUE");
  if (!in.given("NAME"))
    return fail(ErrorCode::usage, "NAME of the stimulus is missing", "forcegate stimulus",
                "choose one of: " + join(names(), ", "));
  FORCEGATE_TRY(const std::uint64_t seed, in.seed("seed"));
  FORCEGATE_TRY(const double rate_Hz, in.number("rate", 1e-3, 1e5));
  FORCEGATE_TRY(const StimulusSpec spec, parse_stimulus_words(in.text("NAME"), words, seed));
  FORCEGATE_TRY(const auto stimulus, make_stimulus(spec));
  const double fastest_Hz = highest_frequency(spec);
  if (in.given("csv") && rate_Hz < kFewestSamples * fastest_Hz)
    return fail(ErrorCode::usage,
                fmt::format("{} samples a second cannot show {} Hz: another frequency would stand in the file", shortest(rate_Hz),
                            shortest(fastest_Hz)),
                "--rate " + in.text("rate"), fmt::format("give at least {}", shortest(kEnoughSamples * fastest_Hz)));
  FORCEGATE_TRY(const SampledStimulus sampled, sample_stimulus(*stimulus, rate_Hz));
  const std::string title = join(std::vector<std::string>{spec.name, join(words, " ")}, " ");
  if (!in.flag("force")) {
    FORCEGATE_CHECK_OK(check_own_file(in.text("csv"), "t_s,F_cmd_N\n"));
    FORCEGATE_CHECK_OK(check_own_file(in.text("plot"), "<svg"));
  }
  if (in.given("csv")) FORCEGATE_CHECK_OK(write_stimulus_csv(sampled, in.text("csv")));
  if (in.given("plot")) FORCEGATE_CHECK_OK(write_stimulus_svg(sampled, title, in.text("plot")));

  const StimulusFacts& f = sampled.facts;
  Console& console = in.console();
  console.print(console.paint(Paint::strong, title));
  console.print(fact("duration", sampled.duration_s, "s"));
  console.print(fact("mean m", f.mean_N, "N"));
  console.print(fact("amplitude A", f.amplitude_N, "N"));
  console.print(fact("lowest frequency f", f.lowest_frequency_Hz, "Hz"));
  console.print(fact("excitation starts at", f.excitation_start_s, "s"));
  console.print(fact("smallest force", f.minimum_N, "N"));
  console.print(fact("largest force", f.maximum_N, "N"));
  console.print(fmt::format("  {:<22}{}", "cyclic loading", f.dynamic ? "yes" : "no"));
  if (const double cycles = (sampled.duration_s - f.excitation_start_s) * f.lowest_frequency_Hz; f.dynamic && cycles > 0.0 && cycles < 1.0) {
    const auto [low, high] = std::minmax_element(sampled.force_N.begin(), sampled.force_N.end());
    console.note(fmt::format("the record ends after {:.2g} of a cycle of {} Hz: its samples go from {:.4g} to {:.4g} N, the forces above are those of whole cycles",
                             cycles, shortest(f.lowest_frequency_Hz), *low, *high));
  }
  if (in.given("csv") && rate_Hz < kEnoughSamples * fastest_Hz)
    console.note(fmt::format("{:.2g} samples in a cycle of {} Hz: the file hardly shows its turns; --rate {} does", rate_Hz / fastest_Hz,
                             shortest(fastest_Hz), shortest(kEnoughSamples * fastest_Hz)));
  if (f.maximum_N > kWheelEnd_N) console.note(fmt::format("the wheel of the bench ends at {} N, this profile goes to {:.4g} N", shortest(kWheelEnd_N), f.maximum_N));
  if (in.given("csv")) console.print("  written               " + in.text("csv"));
  if (in.given("plot")) console.print("  drawn                 " + in.text("plot"));
  console.print_json(Json{
      {"format", 1},
      {"stimulus", spec.name},
      {"seed", seed},
      {"rate_Hz", rate_Hz},
      {"samples", sampled.force_N.size()},
      {"duration_s", sampled.duration_s},
      {"mean_N", number_or_null(f.mean_N)},
      {"amplitude_N", number_or_null(f.amplitude_N)},
      {"lowest_frequency_Hz", number_or_null(f.lowest_frequency_Hz)},
      {"excitation_start_s", number_or_null(f.excitation_start_s)},
      {"minimum_N", number_or_null(f.minimum_N)},
      {"maximum_N", number_or_null(f.maximum_N)},
      {"dynamic", f.dynamic},
      {"csv", in.text("csv")},
      {"plot",
       in.text("plot")}}.dump(2));
  if (in.given("plot"))
    console.look_at(in.text("plot"));
  else
    console.next(in.command_line() + " --plot " + file_quoted(spec.name + ".svg"));
  return kExitSuccess;
}

const Registration<Command> kRow{Command{
    .name = "stimulus",
    .group = "Traces",
    .summary = "make a force profile, draw it, write it as CSV",
    .description =
        "A stimulus is a pure function of time in newtons. This verb makes one from its parameters, prints its facts "
        "(m, A, f as the compensation law uses them, bounds, start of the excitation), and draws or writes it. The "
        "same words stand in a plan under [case.stimulus].\n\nThe wheel of the bench reaches 0 to 5.5 N.",
    .positionals = {{.name = "NAME", .doc = "Profile.", .required = false, .choices = names},
                    {.name = "KEY=VALUE",
                     .doc = "Parameters, unit in the name: f_Hz=0.5 A_N=1.05. Lists with commas.",
                     .required = false,
                     .repeatable = true}},
    .options =
        {{.name = "plot", .value_name = "FILE", .doc = "Draw the profile as SVG.", .names = Names::file},
         {.name = "csv", .value_name = "FILE", .doc = "Write columns t_s, F_cmd_N.", .names = Names::file},
         {.name = "rate", .value_name = "HZ", .doc = "Samples a second of plot and CSV.", .fallback = "1000"},
         {.name = "seed", .value_name = "N", .doc = "Seed of profiles with chance in them.", .fallback = "1"},
         force_row(),
         {.name = "list", .value_name = "", .doc = "All profiles with their parameters, units and ranges."}},
    .examples = {{"forcegate stimulus sine f_Hz=0.5 A_N=1.05 m_N=2.15 --plot sine.svg",
                  "The force control of Lebosse et al. 2011, IV-B2 (1.1 to 3.2 N at 0.5 Hz):"},
                 {"forcegate stimulus --list", "All profiles and their parameters:"}},
    .run = run,
}};

}  // namespace
}  // namespace forcegate
