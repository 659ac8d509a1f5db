#include "hil/app/recording/stimulus.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "hil/app/files/write_file.h"
#include "hil/base/text.h"
#include "hil/report/figures/figure.h"

namespace forcegate {
namespace {

constexpr double kMaxRate_Hz = 1e5;
constexpr double kMaxSamples = 5e7;

bool parse_double(std::string_view text, double& value) {
  const auto r = std::from_chars(text.data(), text.data() + text.size(), value);
  return !text.empty() && r.ec == std::errc{} && r.ptr == text.data() + text.size();
}

Unexpected not_number(const std::string& word, std::string_view part) {
  return fail(ErrorCode::usage, fmt::format("\"{}\" in \"{}\" is not a number", part, word),
              "forcegate stimulus",
              part.find_first_of("[]") == std::string_view::npos ? "write decimals with a point, as in f_Hz=0.5" : "a list is written f_Hz=1,2 or f_Hz=[1,2], one number without brackets");
}

// "1,2", and "[1, 2]" as a plan writes it.
std::vector<std::string> items_of(std::string_view list) {
  list = trim(list);
  if (list.size() >= 2 && list.front() == '[' && list.back() == ']') list = list.substr(1, list.size() - 2);
  std::vector<std::string> out = split(list, ',');
  for (std::string& part : out) part = std::string(trim(part));
  return out;
}

const StimulusParameter* find_parameter(const StimulusKind* kind, std::string_view name) {
  if (kind == nullptr) return nullptr;
  for (const StimulusParameter& p : kind->parameters)
    if (p.name == name) return &p;
  return nullptr;
}

std::string range_text(const StimulusParameter& p) {
  if (p.is_text) return "text";
  std::string out = fmt::format("{} ... {}", shortest(p.minimum), shortest(p.maximum));
  if (!p.unit.empty() && p.unit != "1") out += " " + p.unit;
  if (p.is_list) out = "list of " + out;
  return out + (std::isnan(p.fallback) ? ", required" : p.is_list ? "" : ", default " + shortest(p.fallback));
}

}  // namespace

Result<StimulusSpec> parse_stimulus_words(const std::string& name, std::span<const std::string> words,
                                          std::uint64_t seed) {
  StimulusSpec spec;
  spec.name = name;
  spec.seed = seed;
  const StimulusKind* kind = Registry<StimulusKind>::instance().find(name);
  std::set<std::string> given;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    if (equals == 0 || equals == std::string::npos)
      return fail(ErrorCode::usage, fmt::format("\"{}\" is not KEY=VALUE", word), "forcegate stimulus",
                  "write parameters as in f_Hz=0.5; \"forcegate stimulus --list\" shows them");
    const std::string key = word.substr(0, equals), value = word.substr(equals + 1);
    if (!given.insert(key).second)
      return fail(ErrorCode::usage, fmt::format("{} is given twice", key), "forcegate stimulus", "give it once; lists have commas");
    const StimulusParameter* parameter = find_parameter(kind, key);
    if (parameter != nullptr && parameter->is_text) {
      spec.texts[key] = value;
    } else if (parameter != nullptr ? parameter->is_list : value.find(',') != std::string::npos) {
      for (const std::string& part : items_of(value)) {
        double number = 0.0;
        if (!parse_double(part, number)) return not_number(word, part);
        spec.lists[key].push_back(number);
      }
    } else {
      double number = 0.0;
      // An unknown key is refused by make_stimulus with a suggestion, which helps more than "not a number".
      if (!parse_double(value, number) && parameter != nullptr) return not_number(word, value);
      spec.numbers[key] = number;
    }
  }
  return spec;
}

Result<SampledStimulus> sample_stimulus(const Stimulus& stimulus, double rate_Hz) {
  if (!(rate_Hz > 0.0 && rate_Hz <= kMaxRate_Hz))
    return fail(ErrorCode::usage, fmt::format("a rate of {} Hz is out of range", shortest(rate_Hz)),
                "forcegate stimulus", "give --rate from 0 (excluded) to 100000");
  const double last = std::floor(stimulus.duration_s() * rate_Hz);
  if (!(last >= 0.0 && last < kMaxSamples))
    return fail(ErrorCode::usage, fmt::format("{} samples are too many to write", shortest(last + 1.0)),
                "forcegate stimulus", "lower --rate or the duration");
  SampledStimulus out;
  out.facts = stimulus.facts();
  out.duration_s = stimulus.duration_s();
  out.rate_Hz = rate_Hz;
  out.force_N.resize(static_cast<std::size_t>(last) + 1);
  // t = i / rate, not i * step: round times stay round in the file.
  for (std::size_t i = 0; i < out.force_N.size(); ++i)
    out.force_N[i] = stimulus.force_N(static_cast<double>(i) / rate_Hz);
  return out;
}

Result<void> write_stimulus_csv(const SampledStimulus& sampled, const std::filesystem::path& path) {
  std::string text = "t_s,F_cmd_N\n";
  text.reserve(sampled.force_N.size() * 24);
  for (std::size_t i = 0; i < sampled.force_N.size(); ++i) {
    text += shortest(static_cast<double>(i) / sampled.rate_Hz);
    text += ',';
    text += shortest(sampled.force_N[i]);
    text += '\n';
  }
  return write_file_atomically(path, text);
}

Result<void> write_stimulus_svg(const SampledStimulus& sampled, const std::string& title,
                                const std::filesystem::path& path) {
  std::vector<double> t(sampled.force_N.size());
  for (std::size_t i = 0; i < t.size(); ++i) t[i] = static_cast<double>(i) / sampled.rate_Hz;
  using namespace figures;
  Figure figure(title);
  figure.show_title = true;
  Panel& whole = figure.panel(Axis{"Time", "s"}, Axis{"Force", "N"}, 180);
  whole.line(t, sampled.force_N, {Role::setpoint}, "set-point");
  // The whole of a long cyclic profile is a solid block, so its first cycles stand below it.
  const double f_Hz = sampled.facts.lowest_frequency_Hz;
  const double begin_s = sampled.facts.excitation_start_s;
  if (f_Hz > 0.0 && sampled.duration_s > 12.0 / f_Hz) {
    const auto clamp_index = [&](double s) {
      return static_cast<std::size_t>(std::clamp(s * sampled.rate_Hz, 0.0, static_cast<double>(t.size())));
    };
    const std::size_t first = clamp_index(begin_s - 1.0 / f_Hz), end = clamp_index(begin_s + 5.0 / f_Hz);
    const auto part = [&](const std::vector<double>& all) {
      return std::vector<double>(all.begin() + static_cast<std::ptrdiff_t>(first),
                                 all.begin() + static_cast<std::ptrdiff_t>(end));
    };
    Panel& cycles = figure.panel(Axis{"Time", "s"}, Axis{"Force", "N"}, 140);
    cycles.title = "Five cycles from the start of the excitation";
    cycles.line(part(t), part(sampled.force_N), {Role::setpoint});
  }
  figure.summary =
      fmt::format("Force between {} N and {} N over {} s.", with_uncertainty(sampled.facts.minimum_N, 0.0),
                  with_uncertainty(sampled.facts.maximum_N, 0.0), shortest(sampled.duration_s));
  return write_file_atomically(path, figure.svg(Figure::Target::standalone));
}

std::string stimulus_table_text() {
  std::string out;
  for (const StimulusKind& kind : Registry<StimulusKind>::instance().all()) {
    out += fmt::format("{}: {}\n", kind.name, kind.doc);
    for (const StimulusParameter& p : kind.parameters)
      out += fmt::format("  {:<16} {} ({})\n", p.name, p.doc, range_text(p));
  }
  return out;
}

}  // namespace forcegate
