// Rig "replay": a recording takes the place of the bench. Recorded sensor voltage becomes ADC codes,
//   code = round(U / v_range_V * (2^adc_bits - 1)), clamped (recorded counts are used as they are),
// and the recorded ATI force is the reference. The firmware expects equidistant samples (hil/trace/equidistant.h); lost
// ones are marked. Time starts at 0.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <toml++/toml.h>

#include "hil/base/digest.h"
#include "hil/base/plain_number.h"
#include "hil/base/read_number.h"
#include "hil/base/text.h"
#include "hil/interface/rig.h"
#include "hil/trace/column_map.h"
#include "hil/trace/equidistant.h"
#include "hil/trace/missing_count.h"

namespace forcegate {
namespace {

using Options = std::map<std::string, std::string>;

Unexpected bad_option(const std::string& name, const std::string& value, const char* what) {
  return fail(ErrorCode::config, "option " + name + " = \"" + printable_utf8(value) + "\" " + what,
              "rig replay");
}

Result<double> positive(const Options& options, const char* name, double fallback) {
  const auto it = options.find(name);
  if (it == options.end()) return fallback;
  const std::optional<double> value = read_number(it->second);
  if (!value || *value <= 0.0) return bad_option(name, it->second, "is not a number above 0");
  return *value;
}

/// Values of the calibration file by key, as text; "" level tables are not expected.
Result<Options> read_calibration(const std::string& path) {
  Options out;
  try {
    const toml::table table = toml::parse_file(path);
    for (const auto& [key, node] : table) {
      if (const auto number = node.value<double>())
        out[std::string(key.str())] = shortest(*number);
      else if (const auto text = node.value<std::string>())
        out[std::string(key.str())] = printable_utf8(*text);
    }
  } catch (const toml::parse_error& e) {
    const auto at = e.source().begin;
    return fail(ErrorCode::config, "the calibration file cannot be read: " + std::string(e.description()),
                path + ":" + std::to_string(at.line) + ":" + std::to_string(at.column),
                "it is TOML like gain_N_per_V = 0.5");
  }
  return out;
}

class ReplayRig : public Rig {
 public:
  static Result<std::unique_ptr<Rig>> make(const Options& options) {
    static const std::vector<std::string> kKnown = {"record",    "map",     "cal", "adc_bits",
                                                    "v_range_V", "rate_Hz", "name"};
    for (const auto& [key, value] : options)
      if (std::find(kKnown.begin(), kKnown.end(), key) == kKnown.end()) {
        const std::string near = nearest_name(key, kKnown);
        return fail(ErrorCode::config, "the replay rig has no option \"" + printable_utf8(key) + "\"",
                    "rig replay",
                    near.empty() ? "it knows: " + join(kKnown, ", ") : "did you mean \"" + near + "\"?");
      }
    const auto record = options.find("record");
    if (record == options.end())
      return fail(ErrorCode::usage, "the replay rig needs a recording", "rig replay", "add --record run.csv");
    auto rig = std::make_unique<ReplayRig>();
    if (auto loaded = rig->load(record->second, options); !loaded)
      return tl::unexpected(std::move(loaded).error());
    return std::unique_ptr<Rig>(std::move(rig));
  }

  RigInfo info() const override { return info_; }

  Result<void> begin(const RigRecordRequest& request) override {
    if (!request.faults.empty())
      return fail(ErrorCode::config,
                  "a replay cannot inject the fault \"" + request.faults.begin()->first + "\"", "rig replay",
                  "faults belong to the emulated rig");
    at_ = 0;
    return {};
  }

  Result<void> command_velocity(double) override { return {}; }

  Result<std::size_t> run(std::size_t n, RigBlock& out, std::size_t at) override {
    n = std::min(n, grid_.rows.size() - at_);
    for (std::size_t i = 0; i < n; ++i, ++at_) {
      const GridRow row = grid_.rows[at_];
      const std::size_t s = row.source, o = at + i;
      out.t_s[o] = static_cast<double>(at_) / grid_.rate_Hz;
      out.adc[o] = adc_[s];
      out.force_ref_N[o] = row.lost ? kNoForce : force_N_[s];
      out.setpoint_N[o] = setpoint_N_.empty() ? kNoForce : setpoint_N_[s];
      out.theta_rad[o] = theta_rad_.empty() ? kNoForce : theta_rad_[s];
      out.status[o] = static_cast<std::uint16_t>(row.lost ? status_[s] | kRigSampleLost : status_[s]);
    }
    return n;
  }

  double theta_rad() const override { return theta_rad_.empty() ? std::nan("") : theta_rad_[latest()]; }
  double force_ref_N() const override { return force_N_[latest()]; }
  void park() noexcept override {}

 private:
  static constexpr float kNoForce = std::numeric_limits<float>::quiet_NaN();
  static constexpr double kOverRange = 1.1, kSpikes = 0.01;  // of the converter's range; share of the rows
  static constexpr double kLeastUse = 0.01;                // of its range: nobody records less of it

  std::size_t latest() const { return grid_.rows[at_ == 0 ? 0 : at_ - 1].source; }

  Result<void> load(const std::string& path, const Options& options) {
    FORCEGATE_CHECK_OK(set_converter(options));
    FORCEGATE_TRY(const double rate_Hz, positive(options, "rate_Hz", 0.0));
    const auto map = options.find("map");
    FORCEGATE_TRY(TraceFile file, read_mapped_trace(path, map == options.end() ? std::string() : map->second, rate_Hz));
    FORCEGATE_CHECK_OK(load_channels(file, path));
    FORCEGATE_TRY(const std::string digest, sha256_file(path));
    describe(path, digest);
    note_grid(file.notes);
    if (!file.notes.empty()) info_.details["notes"] = join(file.notes, "; ");
    return {};
  }

  // The converter whose codes the firmware sees: of the options, else of the calibration file, else assumed and said so.
  Result<void> set_converter(const Options& options) {
    Options calibration;
    if (const auto cal = options.find("cal"); cal != options.end()) {
      FORCEGATE_TRY(calibration, read_calibration(cal->second));
      info_.details["calibration_file"] = cal->second;
    }
    const auto either = [&](const char* name, double fallback) -> Result<double> {
      FORCEGATE_TRY(const double from_file, positive(calibration, name, fallback));
      return positive(options, name, from_file);
    };
    FORCEGATE_TRY(const double bits, either("adc_bits", 16));
    FORCEGATE_TRY(info_.v_range_V, either("v_range_V", 10.0));
    if (bits != std::floor(bits) || bits < 8 || bits > 16)
      return bad_option("adc_bits", shortest(bits), "must be 8 to 16");
    std::vector<std::string> assumed;
    for (const auto& [name, value] : {std::pair{"adc_bits", bits}, std::pair{"v_range_V", info_.v_range_V}})
      if (!calibration.contains(name) && !options.contains(name)) assumed.push_back(std::string(name) + " = " + shortest(value));
    if (!assumed.empty()) info_.details["assumed"] = join(assumed, ", ");
    if (info_.v_range_V < 0.1 || info_.v_range_V > 100.0) return bad_option("v_range_V", shortest(info_.v_range_V), "must be 0.1 to 100");
    info_.adc_bits = static_cast<int>(bits);
    for (const auto& [key, value] : calibration) info_.details["calibration." + key] = value;
    return {};
  }

  Result<void> load_channels(TraceFile& file, const std::string& path) {
    const Trace& trace = file.trace;
    const Channel* force = trace.find("F_ref");
    if (!force)
      return fail(ErrorCode::config, "the record has no column of the reference force", path,
                  "name it F_ref_N, or map a column to that name: " + column_map_advice(trace, "F_ref", "N"));
    FORCEGATE_TRY(grid_, equidistant_grid(trace.time_bases[force->time_base], path));
    FORCEGATE_CHECK_OK(load_codes(trace, *force, path, file.notes));
    force_N_.assign(force->value.begin(), force->value.end());
    for (const auto& [name, column] : {std::pair{"F_cmd", &setpoint_N_}, std::pair{"theta", &theta_rad_}})
      if (const Channel* c = trace.find(name); c && c->time_base == force->time_base)
        column->assign(c->value.begin(), c->value.end());
    for (std::size_t i = 0; i < force_N_.size(); ++i)
      if (std::isnan(force_N_[i])) status_[i] |= kRigReferenceFault;
    return {};
  }

  void describe(const std::string& path, const std::string& digest) {
    info_.name = "replay";
    info_.id = digest.substr(0, 16);
    info_.version = "1";
    info_.rate_Hz = grid_.rate_Hz;
    info_.can_move = false;
    info_.emulated = false;
    float largest = 0.0f;
    for (const float f : force_N_)
      if (f > largest) largest = f;
    info_.force_max_N = largest;
    info_.details["record"] = path;
    info_.details["record_sha256"] = digest;
    info_.details["duration_s"] = shortest(static_cast<double>(grid_.rows.size()) / grid_.rate_Hz);
  }

  void note_grid(std::vector<std::string>& notes) const {
    if (grid_.kind == EquidistantGrid::Kind::held)
      notes.push_back("the clock jitters by more than 1 %: sampled at " + shortest(grid_.rate_Hz) + " Hz, the latest row held");
    if (grid_.kind == EquidistantGrid::Kind::on_a_line)
      notes.push_back(fmt::format("the stamps scatter by up to {:.2g} ms about an even clock of {} Hz, which is taken for when the rows were sampled",
                                  1e3 * grid_.scatter_s, shortest(grid_.rate_Hz)));
    if (grid_.lost > 0) notes.push_back(std::to_string(grid_.lost) + " samples were lost in gaps of the record");
    const auto no_reference = std::count_if(force_N_.begin(), force_N_.end(), [](float f) { return std::isnan(f); });
    if (no_reference > 0) notes.push_back(std::to_string(no_reference) + " rows have no reference force");
  }

  Result<void> load_codes(const Trace& trace, const Channel& force, const std::string& path, std::vector<std::string>& notes) {
    const double full = std::exp2(info_.adc_bits) - 1.0;
    const Channel* counts = nullptr;
    std::size_t candidates = 0;
    for (const Channel& c : trace.channels) {
      if (c.raw.empty() || c.time_base != force.time_base) continue;
      if (c.name == "U" || c.name == "adc") {
        counts = &c;
        candidates = 1;
        break;
      }
      counts = &c;
      ++candidates;
    }
    const Channel* voltage = trace.find("U");
    if (candidates != 1) counts = nullptr;
    if (voltage && (voltage->time_base != force.time_base || voltage->quantity == "code")) voltage = nullptr;
    if (!counts && !voltage)
      return fail(ErrorCode::config, "the record has no sensor channel beside its reference force", path,
                  "name it U_V (volts) or U_counts (codes), or map a column to that name: " + column_map_advice(trace, "U", "V"));
    if (!counts && voltage->unit != "V" && (voltage->quantity == "resistance" || voltage->quantity == "conductance" || voltage->quantity == "current"))
      return fail(ErrorCode::config, "the output is a " + voltage->quantity + " in " + voltage->unit + ", and a converter reads volts or counts", path,
                  "forcegate fit and diagnose take it as it is; here record the voltage of its circuit, or map its column (--map NAME=U_V)");
    const std::size_t n = force.value.size();
    adc_.resize(n);
    status_.assign(n, 0);
    if (counts) info_.details["output"] = "counts";
    else FORCEGATE_CHECK_OK(check_range(*voltage, path, notes));
    std::uint16_t held = 0;
    for (std::size_t i = 0; i < n; ++i) {
      double code = kMissing;
      if (counts) {
        code = value_of_count(counts->raw[i]);
        if (code < 0.0)
          return fail(ErrorCode::config, "code " + shortest(code) + " in row " + std::to_string(i + 1) + " is below 0: the firmware takes codes without sign", path,
                      "map a column in volts to U_V, or add to the codes what the lowest lacks");
        if (code > full)
          return fail(ErrorCode::config,
                      "code " + shortest(code) + " in row " + std::to_string(i + 1) + " exceeds " +
                          std::to_string(info_.adc_bits) + " bits",
                      path, "give the right adc_bits (in --cal FILE, unless --rig-option adc_bits states others)");
      } else {
        code = std::round(std::clamp(voltage->value[i] / info_.v_range_V, 0.0, 1.0) * full);
      }
      if (std::isnan(code))
        status_[i] |= kRigSampleLost;
      else
        held = static_cast<std::uint16_t>(code);
      adc_[i] = held;
      if (held == 0 || static_cast<double>(held) == full) status_[i] |= kRigAdcRail;
    }
    return {};
  }

  // Here and there a spike may go beyond the converter's range. A stretch of it is no voltage of that input.
  Result<void> check_range(const Channel& voltage, const std::string& path, std::vector<std::string>& notes) const {
    constexpr double kAtZero = 0.01;  // of the range
    std::size_t beyond = 0, first = 0, values = 0, below = 0;
    double largest_V = 0.0, lowest_V = 0.0;
    for (std::size_t i = 0; i < voltage.value.size(); ++i) {
      if (!std::isfinite(voltage.value[i])) continue;
      ++values;
      below += voltage.value[i] < -kAtZero * info_.v_range_V;
      lowest_V = std::min(lowest_V, voltage.value[i]);
      if (std::fabs(voltage.value[i]) <= kOverRange * info_.v_range_V) continue;
      if (beyond++ == 0) first = i + 1;
      largest_V = std::max(largest_V, std::fabs(voltage.value[i]));
    }
    if (2 * below > values)
      return fail(ErrorCode::config, "U is below 0 V in " + std::to_string(below) + " of " + std::to_string(values) + " rows, down to " + plain_number(lowest_V) + " V, and a converter of 0 to " +
                      shortest(info_.v_range_V) + " V reads code 0 there", path,
                  "where the output falls while the force rises its sign is reversed: exchange the leads of the sensor, or write -U into the column; else add the zero that it lacks");
    if (beyond == 0) return {};
    const std::string reaches = "U reaches " + plain_number(largest_V) + " V, the converter's range is " + shortest(info_.v_range_V) + " V";
    if (static_cast<double>(beyond) <= std::max(1.0, kSpikes * static_cast<double>(values))) {
      notes.push_back(reaches + ": " + std::to_string(beyond) + " rows were cut off there, the first is row " + std::to_string(first));
      return {};
    }
    std::string unit;
    for (const auto& [symbol, per_V] : {std::pair{"mV", 1e3}, std::pair{"uV", 1e6}})
      if (unit.empty() && largest_V / per_V <= kOverRange * info_.v_range_V && largest_V / per_V >= kLeastUse * info_.v_range_V) unit = symbol;
    return fail(ErrorCode::config, reaches + ": " + std::to_string(beyond) + " of " + std::to_string(values) + " rows lie beyond it, the first is row " + std::to_string(first), path,
                (unit.empty() ? std::string() : "the column is probably in " + unit + " (name it U_" + unit + "); else ") + "give the range of the converter (v_range_V in --cal FILE, unless --rig-option v_range_V states another)");
  }

  RigInfo info_;
  EquidistantGrid grid_;
  std::vector<std::uint16_t> adc_, status_;
  std::vector<float> force_N_, setpoint_N_, theta_rad_;
  std::size_t at_ = 0;
};

const Registration<RigKind> kRegistered{
    {"replay", "a recording (CSV, HDF5 or MAT) takes the place of the bench", &ReplayRig::make}};

}  // namespace
}  // namespace forcegate
