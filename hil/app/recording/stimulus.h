#pragma once
// `forcegate stimulus`: make a force profile, look at it, write it down.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "hil/interface/stimulus.h"

namespace forcegate {

/// "sine" and {"f_Hz=0.5", "A_N=1.05", "tones=0.1:1,0.2:0.5", "path=run.csv"}: a value is a number, a list where the
/// profile says so (numbers separated by "," ), or a text where it says so. Errors: usage, naming the word.
Result<StimulusSpec> parse_stimulus_words(const std::string& name, std::span<const std::string> words,
                                          std::uint64_t seed);

/// Set-point sampled at i / rate_Hz for i = 0 ... floor(duration * rate).
struct SampledStimulus {
  StimulusFacts facts;
  double duration_s = 0.0;
  double rate_Hz = 0.0;
  std::vector<double> force_N;
};

/// Refuses rates outside (0, 100 kHz] and profiles of more than 50 million samples (usage).
Result<SampledStimulus> sample_stimulus(const Stimulus& stimulus, double rate_Hz);

/// Columns t_s, F_cmd_N; shortest decimals that read back as the same doubles. Written beside and renamed.
Result<void> write_stimulus_csv(const SampledStimulus& sampled, const std::filesystem::path& path);

/// Force over time as one SVG, decimated so that no extremum is lost.
Result<void> write_stimulus_svg(const SampledStimulus& sampled, const std::string& title,
                                const std::filesystem::path& path);

/// One row a profile: name, sentence, parameters with unit, range and default.
std::string stimulus_table_text();

}  // namespace forcegate
