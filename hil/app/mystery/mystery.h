#pragma once
// `forcegate mystery`: a campaign with something hidden in it, and the sealed truth beside it.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "hil/base/result.h"

namespace forcegate {

struct MysteryRequest {
  std::uint64_t seed = 1;
  std::filesystem::path folder;
  std::string effect;             ///< a name, "none", "foreign"; "": drawn from the seed
  std::vector<std::string> pair;  ///< two names; then `effect` is empty
  std::string strength;           ///< "weak", "medium", "strong"; "": drawn
  double minutes = 20.0;          ///< length of the long sines
  bool overwrite = false;
  std::function<bool()> interrupted;  ///< first asked before the first file, then before each: then what was written is taken back
};

struct MysteryResult {
  std::filesystem::path folder;
  std::string commitment;  ///< SHA-256 of nonce and truth sheet
  std::size_t records = 0, rows = 0;
  double campaign_minutes = 0.0;
};

/// `on_commitment` hears the hash before the first sample is written, so that it can be printed and kept.
Result<MysteryResult> make_mystery(const MysteryRequest& request,
                                   const std::function<void(const std::string&)>& on_commitment);

/// A force to be played on the sensor of a mystery.
struct MysterySegment {
  std::string name, kind;
  std::vector<double> t_s, force_N;
  double f_min_Hz = 0.0;  ///< lowest frequency of a cyclic load; 0: not cyclic
};
/// Whether the folder holds a mystery, whose sensor is at hand as long as its seal is.
bool is_mystery(const std::filesystem::path& folder);
/// Plays the segments on the sensor of the mystery in `folder`, behind all that was played on it before, and appends the records there; nothing of
/// the truth is said.
/// The names of the new files, in order. Errors: a seal that was changed; those of the files.
Result<std::vector<std::string>> play_on_mystery(const std::filesystem::path& folder,
                                                 const std::vector<MysterySegment>& segments);

/// Names for --effect: the catalogue, "none", "foreign", and the foreign ones by name.
std::vector<std::string> mystery_effect_names();

}  // namespace forcegate
