#pragma once
// What stands against an effect that the screen puts first.

#include <string>
#include <vector>

#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

/// An effect that the instruments may feign is no answer: what fits worse may still be one.
inline constexpr const char* kTooSmall = "too small for the declared instruments";
inline constexpr const char* kJitter = "it flattens the noise of the reference where the force stands still";
inline constexpr const char* kTooLittleEvidence = "too little evidence";
inline constexpr const char* kUnphysical = "its sign is unphysical";
inline constexpr const char* kLeads = "the output leads the reference";
inline constexpr const char* kInStep = "with what is carried along, output and reference are in step";
inline constexpr const char* kLeavesMost = "it leaves most of the residual";
inline constexpr const char* kFewJumps = "jumps at codes explain too little of it";
inline constexpr const char* kDiffers = "its strength differs too much between records";
inline constexpr const char* kWithinForm = "it is no more than the first one's form may be wrong by";
inline constexpr const char* kHelpsNoRecords = "it does not help records that were left out";
inline constexpr const char* kHelpsNoParts = "it does not help parts of records that were left out";

/// The effect may be there although it was refused for this reason.
bool is_suspicion(const std::string& reason);
/// How often it was, of those refused for this reason with a score of 20 and more: counted on some 150 of them from three generators.
/// `beside_claim`: something else is claimed, whose form leaves small remains.
double suspicion_probability(const std::string& reason, bool beside_claim);

/// Why an effect is not taken; empty when it is. Sets `stands_out`. `earlier`: what has been chosen before; `removed_before`: RMS that the largest of them removed.
std::string objection(const ResidualChannel& channel, const ScreenResult& result, const FamilyScore& family,
                      ChosenEffect& chosen, const std::vector<ChosenEffect>& earlier,
                      double removed_before, const SelectionRules& rules);

}  // namespace forcegate::diagnose
