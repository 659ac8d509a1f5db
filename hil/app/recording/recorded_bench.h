#pragma once
// What the campaign.json of `forcegate record` says of the bench that it played on: only on the same one does a campaign go on.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "hil/app/recording/campaign_recorder.h"

namespace forcegate {

struct RecordedBench {
  std::string rig;                                             ///< without its version
  std::optional<std::string> rig_id;                           ///< of a bench
  std::optional<std::string> specimen;
  std::optional<std::uint64_t> seed, session;
  std::optional<double> rate_Hz, rig_rate_Hz;
  std::optional<std::map<std::string, std::string>> settings;  ///< Rig::settings(); nullopt: written before they were
};

/// Of the text of a campaign.json. nullopt: forcegate record did not make the campaign.
std::optional<RecordedBench> recorded_bench(std::string_view description);
/// `campaign`: a folder, its description, or one recording, of which nothing is said.
std::optional<RecordedBench> recorded_bench_of(const std::filesystem::path& campaign);

/// "seed 1 there, 2 asked": what makes another bench of the one that is asked for. Errors: those of make_rig().
Result<std::vector<std::string>> differences(const RecordedBench& there, const RecordingBench& asked);

struct GivenBench {
  std::string rig = "emulated";
  std::map<std::string, std::string> rig_options;
  std::optional<std::string> specimen;
  std::optional<std::uint64_t> seed;
};

struct BenchToGoOn {
  RecordingBench bench;
  bool known = false;  ///< the campaign tells every option of the rig
};

/// What is not given is as the description of the campaign tells it, where this rig played it. Errors: usage, where what is given contradicts that: another rig
/// plays another sensor, but replay may bring recordings of the same one.
Result<BenchToGoOn> bench_to_go_on(const std::filesystem::path& campaign, const GivenBench& given);

std::string there_and_asked(const std::string& what, const std::string& there, const std::string& asked);

}  // namespace forcegate
