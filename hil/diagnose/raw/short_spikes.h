#pragma once
// Spikes of a few samples: an electric discharge behind a filter rises within a sample and is gone after a few, a bad contact throws a few
// samples up and down. Their neighbours know of them. And what spikes of a single sample have in common.

#include <cstddef>
#include <span>
#include <vector>

namespace forcegate::diagnose {

inline constexpr std::size_t kLongestSpike = 4;  ///< samples
inline constexpr double kAboveAround = 8.0;      ///< a spike stands so many times above the scatter around it

/// Scatter of one sample among the 24 on either side, V, those next to it left out: median of the second differences. Noise that grows with
/// the load and bursts of noise make all of them jump.
double scatter_around(const std::vector<double>& U, std::size_t at);

/// Spikes of one sample, in rising order, and where the output is at each without it.
struct LoneSpikes {
  const std::vector<double>& U;
  const std::vector<std::size_t>& at;
  const std::vector<double>& level_V;
};

/// Spikes come at any level of the output. Jumps that sit at a few levels only are steps of the converter's curve: the levels that hold four
/// fifths of them are hardly visited otherwise.
bool sit_at_fixed_levels(const LoneSpikes& spikes);

/// Size of the one bit that spikes turn over: most have the same size, at any level, it is a binary fraction of the range, half of it at
/// most, and they go up where the bit is clear and down where it is set. 0: none. `range_V`: of the converter, infinite where it is not declared; then four times the span of the output at most.
double common_bit_V(const LoneSpikes& spikes, double range_V, double span_V);

/// Whether nearly all of them come alone and leave the output, beside the force, on the side where it was: at a step of the converter's curve the output goes over
/// to the other side, and noise makes it jump there again and again.
bool stay_on_one_side(const LoneSpikes& spikes, const std::vector<double>& F_N, double gain_V_per_N, double size_V);

/// Where the output jumps from and to, V.
struct Jump {
  double from_V = 0.0, to_V = 0.0;
};

/// Whether three in five of four and more have another one that leads back: at a step of its curve a converter shows the code of either side, and noise
/// makes it jump up here and down there between the same two. `near_V`: within which levels are one.
bool go_back_and_forth(std::span<const Jump> jumps, double near_V);
std::vector<Jump> jumps_of(const LoneSpikes& spikes);

/// Whether nearly all of five and more fall, from anywhere in the range, to the lowest level that the output has: what it shows where the
/// sensor is disconnected. `near_V`: within which levels are one.
bool fall_to_one_level(const LoneSpikes& spikes, double near_V);

struct ShortSpike {
  std::size_t begin = 0, length = 0;  ///< samples
  double peak_V = 0.0;                ///< above or below the line between its surroundings
  double level_V = 0.0;               ///< of that line in its middle
  bool both_ways = false;             ///< above and below
  bool up = false;                    ///< its peak stands above
};

struct SpikeScales {
  double quiet_V = 0.0;      ///< what noise and steps do between two samples
  double gain_V_per_N = 0.0; ///< of the sensor, without its sign: what the force does is no spike
  bool thrown = false;       ///< the excursions of the campaign are thrown_at_random()
};

/// Excursions of 2 to kLongestSpike samples that end where they began, whatever their course, to the peak. Those beside which the output jumps by a third of
/// that within 100 samples are none: that is a stretch of noise.
std::vector<Jump> excursions(const std::vector<double>& t_s, const std::vector<double>& F, const std::vector<double>& U, const SpikeScales& scales);

/// Whether three and more go up and down by sizes that differ by half: a switch, a bit of the converter, a slip have a size or a direction. What goes back and
/// forth is not thrown.
bool thrown_at_random(std::span<const Jump> excursions, double near_V);

/// Excursions of 2 to kLongestSpike samples that end where they began: to both sides, or within 40 ms to one, largest at their first sample and
/// falling after it. A record with three to both sides may have any to one side, and so may one whose spikes are thrown_at_random()
/// with `lone`, those of a single sample, or a campaign whose excursions are. Where half a turn the other way and half a turn back
/// follow or go before, the output rings, and throws nothing. `t_s`, `F` and `U` on one clock; samples that are missing belong to none.
std::vector<ShortSpike> find_short_spikes(const std::vector<double>& t_s, const std::vector<double>& F, const std::vector<double>& U, const SpikeScales& scales,
                                          std::span<const Jump> lone = {});

}  // namespace forcegate::diagnose
