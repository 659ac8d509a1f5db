// Plays a recorded force again: the channel "F_ref" (what the reference cell saw) of a CSV, HDF5 or MAT file, or the one
// that `channel` names, linearly between its samples and without the file's own start time. Missing samples
// are bridged.

#include <fmt/format.h>

#include "hil/trace/column_map.h"
#include "stimuli/profile.h"

namespace forcegate::stimuli {
namespace {

class Replay final : public Profile {
 public:
  Replay(std::vector<double> t_s, std::vector<double> force_N, double ramp_s)
      : t_s_(std::move(t_s)), recorded_N_(std::move(force_N)) {
    duration_s_ = ramp_s + t_s_.back();
    const auto [low, high] = std::minmax_element(recorded_N_.begin(), recorded_N_.end());
    set_ramp(ramp_s, recorded_N_.front());
    facts_.minimum_N = ramp_s > 0.0 ? 0.0 : *low;
    facts_.maximum_N = *high;
    facts_.mean_N = 0.5 * (*low + *high);
    facts_.amplitude_N = 0.5 * (*high - *low);
    describe_cycles();
  }

 protected:
  double profile_N(double since_s) const override {
    const auto after = std::upper_bound(t_s_.begin(), t_s_.end(), since_s);
    if (after == t_s_.begin()) return recorded_N_.front();
    if (after == t_s_.end()) return recorded_N_.back();
    const auto i = static_cast<std::size_t>(after - t_s_.begin());
    const double w = (since_s - t_s_[i - 1]) / (t_s_[i] - t_s_[i - 1]);
    return recorded_N_[i - 1] + w * (recorded_N_[i] - recorded_N_[i - 1]);
  }

 private:
  // Crossings of the middle with a dead band of a fifth of the swing. Two or more whole cycles of at most 40
  // s make a cyclic load; its frequency at the start is that of the first ten cycles.
  void describe_cycles() {
    const double band_N = 0.2 * facts_.amplitude_N;
    int side = 0, rises = 0;
    double first_s = 0.0, last_s = 0.0;
    for (std::size_t i = 0; i < t_s_.size() && rises <= 10; ++i) {
      const double x = recorded_N_[i] - facts_.mean_N;
      const int now = x > band_N ? 1 : (x < -band_N ? -1 : side);
      if (side < 0 && now > 0) {
        if (rises == 0) first_s = t_s_[i];
        last_s = t_s_[i];
        ++rises;
      }
      side = now;
    }
    if (rises < 3 || facts_.amplitude_N < 0.05) return;
    const double period_s = (last_s - first_s) / (rises - 1);
    if (period_s > 40.0) return;
    facts_.dynamic = true;
    facts_.lowest_frequency_Hz = 1.0 / period_s;
  }

  std::vector<double> t_s_, recorded_N_;
};

// What is too large for a force in newtons may be one in another unit.
Result<void> check_size(const Channel& force, const std::string& path) {
  double largest_N = 0.0;
  for (const double f : force.value)
    if (std::isfinite(f)) largest_N = std::max(largest_N, f);
  if (!(largest_N > kForceLimit_N)) return {};
  std::string units;
  for (const auto& [symbol, newton] : {std::pair{"gf", 9.80665e-3}, std::pair{"mN", 1e-3}})
    if (const double real_N = largest_N * newton; real_N > 0.1 && real_N <= kForceLimit_N)
      units += fmt::format("{}{:.3g} N if it is in {}", units.empty() ? "" : ", ", real_N, symbol);
  return fail(ErrorCode::config, fmt::format("the recorded force reaches {:.4g} N", largest_N), path,
              "a profile may not exceed " + shortest(kForceLimit_N) + " N" + (units.empty() ? "" : "; it would be " + units + ": name the unit in the column's header"));
}

Result<std::unique_ptr<Stimulus>> make(const StimulusSpec& spec) {
  const std::string& path = spec.texts.at("path");
  const auto named = spec.texts.find("channel");
  const std::string channel_name =
      named == spec.texts.end() || named->second.empty() ? "F_ref" : named->second;
  const auto map = spec.texts.find("map");
  FORCEGATE_TRY(const TraceFile file, read_mapped_trace(path, map == spec.texts.end() ? std::string() : map->second));
  const Channel* channel = file.trace.find(channel_name);
  if (channel == nullptr || channel->unit != "N") {
    std::vector<std::string> forces;
    for (const Channel& c : file.trace.channels)
      if (c.unit == "N") forces.push_back(c.name);
    return fail(
        ErrorCode::config, "there is no force channel '" + printable_utf8(channel_name) + "'", path,
        forces.empty() ? "a force column is named like F_ref_N" : "choose one of: " + join(forces, ", "));
  }
  const std::vector<double>& clock_s = file.trace.time_bases[channel->time_base].t_s;
  std::vector<double> t_s, force_N;
  FORCEGATE_CHECK_OK(check_size(*channel, path));
  for (std::size_t i = 0; i < channel->value.size(); ++i) {
    const double force = channel->value[i];
    if (!std::isfinite(force)) continue;
    t_s.push_back(clock_s[i]);
    force_N.push_back(std::max(0.0, force));  // the cell's noise around no load is not a pull
  }
  if (t_s.size() < 2)
    return fail(ErrorCode::config, "the recording holds fewer than two samples of the force", path);
  const double start_s = t_s.front();
  for (double& t : t_s) t -= start_s;
  return std::unique_ptr<Stimulus>(
      std::make_unique<Replay>(std::move(t_s), std::move(force_N), spec.numbers.at("ramp_s")));
}

const Registration<StimulusKind> kRegistered{
    {"replay",
     "A recorded force, played again",
     {{"path", "", kRequired, 0.0, 0.0, "CSV, HDF5 or MAT file with a clock and a force column such as F_ref_N", false,
       true},
      {"map", "", 0.0, 0.0, 0.0, "names of foreign columns, COLUMN=NAME, one a line", false, true},
      {"channel", "", 0.0, 0.0, 0.0, "name of the force channel; left out = F_ref", false, true},
      ramp_parameter()},
     make}};

}  // namespace
}  // namespace forcegate::stimuli
