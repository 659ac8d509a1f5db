#pragma once
#include <string>

#include "hil/characterize/capacitance/weight_study.h"

namespace forcegate {

/// Networks of pack 0 as the C header that rigs/firmware/two_variable compiles in.
std::string network_header(const characterize::WeightStudy& study);

}  // namespace forcegate
