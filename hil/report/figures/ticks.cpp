#include "hil/report/figures/ticks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "hil/report/figures/text.h"

namespace forcegate::figures {
namespace {

std::string power_label(int exponent) {
  if (exponent >= -3 && exponent <= 3) return coordinate(std::pow(10.0, exponent), 3);
  static const char* const kSuperscript[] = {"\u2070", "\u00b9", "\u00b2", "\u00b3", "\u2074",
                                             "\u2075", "\u2076", "\u2077", "\u2078", "\u2079"};
  std::string out = "10";
  if (exponent < 0) out += "\u207b";
  for (const char c : std::to_string(std::abs(exponent))) out += kSuperscript[c - '0'];
  return out;
}

}  // namespace

std::vector<Tick> linear_ticks(double low, double high, int target) {
  std::vector<Tick> ticks;
  if (!(high > low) || !std::isfinite(high - low)) return ticks;
  const double rough = (high - low) / std::max(1, target);
  const int power = static_cast<int>(std::floor(std::log10(rough)));
  const double base = std::pow(10.0, power);
  const double lead = rough / base;
  const double step = (lead <= 1.0 ? 1.0 : lead <= 2.0 ? 2.0 : lead <= 5.0 ? 5.0 : 10.0) * base;
  const int decimals = std::clamp(static_cast<int>(-std::floor(std::log10(step) + 1e-9)), 0, 12);
  const double first = std::ceil(low / step - 1e-9);
  const double last = std::floor(high / step + 1e-9);
  const bool huge = std::max(std::abs(low), std::abs(high)) >= 1e6;
  for (double k = first; k <= last; k += 1.0) {
    const double value = k * step;
    std::string label = huge || decimals > 6 ? display(value, 3) : fmt::format("{:.{}f}", value, decimals);
    if (k == 0.0) label = fmt::format("{:.{}f}", 0.0, huge || decimals > 6 ? 0 : decimals);
    ticks.push_back({value, typographic_minus(label)});
  }
  return ticks;
}

std::vector<Tick> logarithmic_ticks(double low, double high, int target) {
  std::vector<Tick> ticks;
  if (!(low > 0.0) || !(high > low) || !std::isfinite(high)) return ticks;
  const int first = static_cast<int>(std::floor(std::log10(low) + 1e-9));
  const int last = static_cast<int>(std::ceil(std::log10(high) - 1e-9));
  const double decades = std::log10(high / low);
  const auto make = [&](int every, bool all) {
    ticks.clear();
    std::size_t labelled = 0;
    for (int e = first; e <= last; ++e) {
      for (const int m : {1, 2, 5}) {
        if (m != 1 && decades > 6.0) continue;
        const double value = m * std::pow(10.0, e);
        if (value < low * (1 - 1e-9) || value > high * (1 + 1e-9)) continue;
        std::string label;
        if (m == 1 && (e - first) % every == 0) label = power_label(e);
        if (m != 1 && (decades < 2.0 || all)) label = display(value, 2);
        labelled += label.empty() ? 0 : 1;
        ticks.push_back({value, label});
      }
    }
    return labelled >= 2;
  };
  int every = std::max(1, static_cast<int>(std::ceil(decades / std::max(1, target))));
  while (!make(every, false) && every > 1) --every;
  if (make(every, false) || make(1, true)) return ticks;
  for (int more = std::max(2, target); more <= 10; ++more)
    if (std::vector<Tick> linear = linear_ticks(low, high, more); linear.size() >= 2) return linear;
  return ticks;
}

std::vector<Tick> symmetric_log_ticks(double low, double high, double linear_within, int target) {
  if (!(high > low) || !(linear_within > 0.0) || !std::isfinite(high - low)) return {};
  constexpr double kBesideZero = 0.1, kFewDecades = 2.0;  // of the axis: there stands the label of zero
  const bool holds_zero = low <= 0.0 && high >= 0.0;
  const double most = std::max(std::abs(low), std::abs(high));
  const double least = holds_zero ? linear_within : std::min(linear_within, std::min(std::abs(low), std::abs(high)));
  const int first = holds_zero ? static_cast<int>(std::ceil(std::log10(least) - 1e-9)) : static_cast<int>(std::floor(std::log10(least) + 1e-9)), last = static_cast<int>(std::floor(std::log10(most) + 1e-9));
  if (last < first) return linear_ticks(low, high, target);
  const double length = std::asinh(high / linear_within) - std::asinh(low / linear_within);
  const bool all = std::log10(most / linear_within) < kFewDecades;
  const int sides = (low < 0.0 ? 1 : 0) + (high > 0.0 ? 1 : 0), every = std::max(1, (sides * (last - first + 1) + target - 1) / std::max(1, target));
  std::vector<Tick> ticks;
  std::vector<std::pair<Tick, std::string>> spare;  // with the label that it could have
  const auto label_of = [](double value, int m, int e) { return m == 1 ? (value < 0.0 ? "\u2212" : "") + power_label(e) : display(value, 2); };
  const auto add = [&](int sign) {
    for (int e = first; e <= last; ++e)
      for (const int m : {1, 2, 5}) {
        const double value = sign * m * std::pow(10.0, e);
        if (value < low || value > high) continue;
        const bool labelled = (m == 1 ? (last - e) % every == 0 : all) && (!holds_zero || std::asinh(std::abs(value) / linear_within) > kBesideZero * length);
        ticks.push_back({value, labelled ? label_of(value, m, e) : ""});
        spare.push_back({ticks.back(), label_of(value, m, e)});
      }
  };
  add(-1);
  std::reverse(ticks.begin(), ticks.end());
  if (holds_zero) ticks.push_back({0.0, "0"});
  add(1);
  // one label a side is no scale: from the far end more, where they have room
  constexpr double kRoom = 0.12;
  std::ranges::sort(spare, std::greater<>(), [](const auto& s) { return std::abs(s.first.value); });
  const auto side = [](double value) { return value < 0.0 ? -1 : value > 0.0 ? 1 : 0; };
  for (const auto& [tick, label] : spare) {
    const auto labelled = [&](const Tick& t) { return !t.label.empty(); };
    const auto alike = [&, &tick = tick](const Tick& t) { return labelled(t) && side(t.value) == side(tick.value); };
    const auto near = [&, &tick = tick](const Tick& t) {
      return labelled(t) && std::abs(std::asinh(t.value / linear_within) - std::asinh(tick.value / linear_within)) < kRoom * length;
    };
    if (std::ranges::count_if(ticks, alike) > 1 || std::ranges::any_of(ticks, near)) continue;
    std::ranges::find(ticks, tick.value, &Tick::value)->label = label;
  }
  return ticks;
}

}  // namespace forcegate::figures
