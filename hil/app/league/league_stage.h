#pragma once
// At which step of the diagnosis a match was lost, read from the answer alone: screening scores, findings and the
// engine's own notes.

#include <string>

#include "hil/app/league/league.h"

namespace forcegate {

enum class MissStage {
  none,             ///< no miss
  no_answer,        ///< the engine failed
  not_excited,      ///< the records show (almost) nothing of it
  not_a_candidate,  ///< the engine did not look for it in this campaign: a channel is missing, or no signature
  raw_health,       ///< a detector of the raw samples did not speak
  evidence,         ///< first in the screening, never claimed: too little evidence, or carried as a nuisance
  outranked,        ///< another family had more evidence in the first screening
  refused,          ///< the choice turned it down, with its reason
  not_claimed,      ///< listed below a claim, as whatever else is
  outclaimed,       ///< listed, but another effect was claimed
  false_claim,      ///< clean or foreign: a known effect was claimed
  called_unknown,   ///< clean: structure was seen in noise
  called_none       ///< foreign: nothing was seen
};

std::string_view to_string(MissStage stage);

struct Miss {
  MissStage stage = MissStage::none;
  std::string effect;  ///< hidden effect that was missed; "" on clean campaigns
  std::string other;   ///< effect that took its place, when there is one
  std::string detail;  ///< one sentence
};

Miss miss_of(const LeagueMatch& match);

}  // namespace forcegate
