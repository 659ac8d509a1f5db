#pragma once
// Names against what no name of the library covers (unnamed_dependences.h).

#include <string>
#include <vector>

#include "hil/diagnose/choose/select.h"
#include "hil/diagnose/diagnosis.h"

namespace forcegate::diagnose {

/// A place that an unnamed dependence fills: of a chosen effect which it outdoes, of all of them at once, or among what the claims leave.
struct Outdone {
  std::vector<std::string> effects;  ///< empty: what is left
  std::string by, group;             ///< see UnnamedDependence
  double gain = 0.0, by_gain = 0.0;  ///< log evidence in that place
  bool is_tie = false;               ///< both explain the same: the names stay, less sure
};

/// Asks it of every effect of the output that acts within records, of all of them together (what is simpler than any), and where `structured`
/// of what is left. Spare columns of the channel are written and given back.
std::vector<Outdone> outdone_by_unnamed(const CampaignInput& input, ResidualChannel& channel, const Selection& selection, bool structured,
                                        unsigned threads);

/// Takes the claims back that are outdone, makes those less sure beside which something explains as much, and says in the notes what does.
void withdraw_outdone(const std::vector<Outdone>& outdone, Diagnosis& out);

}  // namespace forcegate::diagnose
