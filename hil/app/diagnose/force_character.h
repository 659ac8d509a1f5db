#pragma once
// What tells pieces of rig time apart by their force alone.

#include <string>
#include <vector>

namespace forcegate {

struct ForceCharacter {
  double seconds = 0.0, average_N_per_s = 0.0, fastest_N_per_s = 0.0, low_N = 1e300, high_N = -1e300;
};

/// Of readings that scatter as those of a load cell do: their noise and their steps are no motion, at whatever rate they come. NaN are left out.
ForceCharacter character_of(const std::vector<double>& t_s, const std::vector<double>& force_N);

/// 0: alike; above 2 nobody would take one for the other. Lengths and rates by their logarithm, the range in newtons.
double distance(const ForceCharacter& a, const ForceCharacter& b);

/// "200 s, 0 to 5 N, 0.3 N/s on the average, 2 N/s at most"
std::string described(const ForceCharacter& c);

}  // namespace forcegate
