#pragma once
// Makes a campaign with a hidden effect, with two, with a foreign one, or with none; sets the strength so
// that the effect's RMS in its channel falls into the tier, and measures what was really hidden.
//
// Size of an effect: difference of its channel with and without it, less the best gain and offset over the
// whole campaign, RMS over the third of the records that it changes most, in % of the channel's span. Tiers:
// weak 0.15-0.30, medium 0.40-0.85, strong 1.2-2.6. Effects that act from record to record, or as noise of
// the reference, are raised to at least 0.7 / 1.5 / 3 times the scatter that hides them.

#include <string>
#include <vector>

#include "hil/base/result.h"
#include "hil/trace/campaign.h"
#include "rigs/emulated/hidden/plant.h"
#include "rigs/emulated/hidden/truth.h"

namespace forcegate::hidden {

struct CampaignRequest {
  std::uint64_t seed = 1;
  std::string name = "mystery";
  std::vector<std::string> effects;  ///< names from the registry; none: a clean campaign
  Tier tier = Tier::medium;
  double minutes = 20.0;  ///< length of the long sines
};

struct MadeCampaign {
  Conditions conditions;
  std::vector<RecordData> records;
  Truth truth;
};

/// Names of the catalogue (foreign = false) or of the effects outside it (foreign = true), sorted.
std::vector<std::string> effect_names(bool foreign);

/// Error: unknown effect name, minutes outside 1 to 60. Same request, same bits.
Result<MadeCampaign> make_campaign(const CampaignRequest& request);

/// Strength as given instead of a tier; for tests and sensor decorators. One strength per effect.
Result<MadeCampaign> make_campaign_at(const CampaignRequest& request, const std::vector<double>& strengths);

/// The twin: the same bench, records and random numbers with nothing hidden. What a model with the right effect could reach is
/// what a model without any leaves of the twin. Error: as make_campaign.
Result<MadeCampaign> make_twin(const CampaignRequest& request);

/// A force that somebody asks to be played on the sensor of a campaign.
struct AskedForce {
  std::size_t number = 0;  ///< of its record in the campaign, from 0: each has its own noise
  std::string kind;  ///< of stimuli/: "ramp", "sine", ...
  std::vector<double> t_s, force_N;
  double f_min_Hz = 0.0;  ///< lowest frequency of a cyclic load, under which the maxima decay; 0: not cyclic
  double rest_before_s = 7200.0;
};

/// The same bench, sensor and hidden effects go on: records behind those of the campaign and behind what was `played` since, which
/// the sensor has felt and the clock has counted. Only the records of `asked` are given back.
/// Errors: as make_campaign; a force without at least two points in order.
Result<MadeCampaign> continue_campaign(const Truth& truth, const std::vector<AskedForce>& played, const std::vector<AskedForce>& asked);

/// The same data as a diagnosis reads it, without going through files: channels F_ref, U, theta, ... and
/// those facts that the lab wrote down. The caller gives the records away.
Campaign to_campaign(MadeCampaign&& made);

}  // namespace forcegate::hidden
