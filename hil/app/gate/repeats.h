#pragma once
// A record of the emulated rig played again from its recipe: the same image on the same codes gives the same forces, or the difference is
// the firmware's (a clock, memory that nobody set, threads).

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hil/gate/case_record.h"
#include "hil/gate/rule.h"

namespace forcegate {

struct SecondPlay {
  enum class Is { same, other_by_firmware, other, cancelled } is = Is::same;
  std::string text;  ///< what differs; "" where nothing does
};

/// Two plays of one recipe. `other`: not the image's, or not known to be (frames were lost, another device failed, another kind of rig).
SecondPlay compare_plays(const CaseRecord& first, const CaseRecord& again);

inline constexpr const char* kRepeats = "firmware_repeats";

/// The required check of that name, failed; none where nothing was found.
std::optional<JudgedCheck> repeats_check(std::span<const std::string> found);

}  // namespace forcegate
