// Reference sensor whose adapter is a program of its own, in any language (docs/adapters.md). Rows of its answer to
// "poll": time of the measurement by its own clock in s, force in N (null: not valid), status bits.

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "adapters/process/adapter_process.h"

namespace forcegate {
namespace {

using process::AdapterProcess;
using process::ProcessOptions;
using process::Reply;

constexpr double kFuture_s = 0.02;
constexpr double kGap_periods = 2.5;  ///< after a longer silence a reading has none before it to be held against
constexpr unsigned kStatusMask = kRigReferenceSaturated | kRigReferenceFault;

struct Options {
  ReferenceFacts facts;
  double force_max_N = 0.0, jump_max_N = 2.0;
  std::string serial, calibration_id;
};

class ProcessReference final : public ReferenceSensor {
 public:
  ProcessReference(ProcessOptions program, Options options, BenchWorld& world)
      : program_(std::move(program), world), options_(std::move(options)), world_(world) {}
  ~ProcessReference() override { close(); }

  Result<DeviceIdentity> open() override {
    if (world_.is_virtual())
      return fail(ErrorCode::config, "a program of its own cannot follow virtual time", program_.where(),
                  "set clock = \"paced\" under [twins]");
    FORCEGATE_TRY(DeviceIdentity identity, program_.open(true));
    if (!identity.serial.empty() && identity.serial != options_.serial)
      return fail(
          ErrorCode::device,
          "the sensor has serial number " + identity.serial + ", the bench file says " + options_.serial,
          program_.where(), "connect the right sensor, or enter its calibration and serial number");
    identity.by_file = identity.serial.empty();
    identity.serial = options_.serial;
    identity.calibration = options_.calibration_id;
    return identity;
  }
  void close() noexcept override {
    if (program_.running()) (void)program_.ask("close");
    program_.end();
  }

  Result<void> start() override {
    last_s_ = -std::numeric_limits<double>::infinity();
    last_N_ = std::numeric_limits<double>::quiet_NaN();
    jumps_in_a_row_ = 0;
    FORCEGATE_CHECK_OK(program_.ask("start"));
    return {};
  }
  Result<void> stop() override {
    FORCEGATE_CHECK_OK(program_.ask("stop"));
    return {};
  }

  Result<void> poll(std::vector<ReferenceReading>& out) override {
    FORCEGATE_TRY(const Reply reply, program_.ask("poll"));
    if (!reply.rows.empty() && !reply.number.contains("clock_s"))
      return program_.bad("readings without 'clock_s' have no time");
    const double now_s = world_.now_s();
    for (const std::vector<double>& row : reply.rows) {
      if (row.size() != 3) return program_.bad("a reading is not [time, force, status]");
      if (!(row[0] > last_s_)) return program_.bad("readings come out of order");
      if (!(row[2] >= 0 && row[2] <= 65535 && row[2] == std::floor(row[2])))
        return program_.bad("a reading has a status that is no number from 0 to 65535");
      if (row[0] - last_s_ > kGap_periods / options_.facts.rate_Hz) last_N_ = std::numeric_limits<double>::quiet_NaN();
      last_s_ = row[0];
      ReferenceReading reading;
      reading.t_s = program_.clock().bench_s(row[0]);
      if (reading.t_s > now_s + kFuture_s)
        return program_.bad(fmt::format("a reading is {:.3f} s in the future", reading.t_s - now_s));
      reading.status = static_cast<std::uint16_t>(static_cast<unsigned>(row[2]) & kStatusMask);
      reading.force_N = static_cast<float>(row[1]);
      if (std::isnan(row[1]) && reading.status == 0) reading.status = kRigReferenceFault;
      if (reading.status != 0) {
        reading.force_N = std::numeric_limits<float>::quiet_NaN();
        last_N_ = std::numeric_limits<double>::quiet_NaN();
      } else if (std::fabs(row[1]) > 1.05 * options_.force_max_N ||
                 std::fabs(row[1] - last_N_) > options_.jump_max_N) {
        ++refused_;
        if (++jumps_in_a_row_ > kJumpsMax)
          return fail(ErrorCode::device, fmt::format("the reference reads {:.3g} N again and again", row[1]),
                      program_.where(), "check scale, units and wiring of the reference");
        continue;
      } else {
        last_N_ = row[1];
      }
      jumps_in_a_row_ = 0;
      out.push_back(reading);
    }
    return {};
  }

  ReferenceFacts facts() const override { return options_.facts; }
  std::map<std::string, std::uint64_t> counts() const override {
    auto all = program_.counts();
    all["unbelievable readings refused"] = refused_;
    return all;
  }
  ClockFit clock() const override { return program_.clock().fit(); }

 private:
  static constexpr int kJumpsMax = 20;
  AdapterProcess program_;
  Options options_;
  BenchWorld& world_;
  double last_s_ = 0.0, last_N_ = 0.0;
  int jumps_in_a_row_ = 0;
  std::uint64_t refused_ = 0;
};

Result<std::unique_ptr<ReferenceSensor>> make(const ConfigNode& table, BenchWorld& world) {
  ConfigReader in(table, "[reference]", "docs/adapters.md");
  ProcessOptions program;
  program.device = "reference";
  process::read_process_options(in, table, program);
  Options o;
  in.any("calibration_expires");
  in.any("u_rel");
  in.number("rate_Hz", o.facts.rate_Hz, 1, 100000, ConfigReader::required);
  double resolution_N = 0.0, noise_N = 0.0;  // the bench file hands them to the gate
  in.number("resolution_N", resolution_N, 1e-6, 10, ConfigReader::required);
  in.number("noise_N", noise_N, 0, 10);
  in.number("u_time_s", o.facts.u_time_s, 1e-6, 0.1, ConfigReader::required);
  in.number("force_max_N", o.force_max_N, 0.1, 100000, ConfigReader::required);
  in.number("jump_max_N", o.jump_max_N, 0.01, 100000);
  in.text("serial", o.serial, ConfigReader::required);
  in.text("calibration_id", o.calibration_id, ConfigReader::required);
  FORCEGATE_CHECK_OK(in.finish());
  return std::make_unique<ProcessReference>(std::move(program), std::move(o), world);
}

const Registration<ReferenceKind> kRegistered{
    {"process", "Reference behind a program of its own, in any language (docs/adapters.md)", make}};

}  // namespace
}  // namespace forcegate
