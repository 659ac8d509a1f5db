// Sensor board whose adapter is a program of its own, in any language (docs/adapters.md). Rows of its answer to "poll":
// index counted from the start of the stream, ADC code, force in N, flags.

#include <cmath>

#include "adapters/process/adapter_process.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

using process::AdapterProcess;
using process::ProcessOptions;
using process::Reply;

bool whole(double value, double least, double most) {
  return value >= least && value <= most && value == std::floor(value);
}

class ProcessBoard final : public SensorBoard {
 public:
  ProcessBoard(ProcessOptions program, int adc_bits, double rate_Hz, std::string serial, BenchWorld& world)
      : program_(std::move(program), world),
        world_(world),
        adc_bits_(adc_bits),
        rate_Hz_(rate_Hz),
        serial_(std::move(serial)) {}
  ~ProcessBoard() override { close(); }

  Result<DeviceIdentity> open() override {
    if (world_.is_virtual())
      return fail(ErrorCode::config, "a program of its own cannot follow virtual time", program_.where(),
                  "set clock = \"paced\" under [twins]");
    counters_ = {};
    FORCEGATE_TRY(DeviceIdentity identity, program_.open(true));
    if (!identity.serial.empty() && identity.serial != serial_)
      return fail(ErrorCode::device, "the board has serial number " + identity.serial + ", the bench file says " + serial_,
                  program_.where(), "connect the right board, or enter its serial number under [board]");
    identity.by_file = identity.serial.empty();
    identity.serial = serial_;
    return identity;
  }
  void close() noexcept override {
    if (program_.running()) (void)program_.ask("close");
    program_.end();
  }

  Result<DutInfo> load(const DutSession& session) override {
    const Calibration& c = session.calibration;
    FORCEGATE_TRY(const Reply reply,
                  program_.ask("load", {{"nonce", static_cast<std::int64_t>(session.nonce)},
                                        {"rate_Hz", session.rate_Hz},
                                        {"gain_N_per_V", c.gain_N_per_V},
                                        {"offset_N", c.offset_N},
                                        {"v_range_V", c.v_range_V},
                                        {"b_scale", c.b_scale},
                                        {"q_scale", c.q_scale},
                                        {"adc_bits", static_cast<std::int64_t>(c.adc_bits)},
                                        {"calibration_id", c.id}}));
    const auto number = [&](const char* key) {
      const auto at = reply.number.find(key);
      return at != reply.number.end() ? at->second : -1.0;
    };
    const auto text = [&](const char* key) {
      const auto at = reply.text.find(key);
      return at != reply.text.end() ? at->second : std::string();
    };
    if (!whole(number("nonce"), 0, 4294967295.0) || !whole(number("adc_bits"), 0, 255) ||
        !whole(number("protocol_major"), 0, 255) || !whole(number("protocol_minor"), 0, 255))
      return program_.bad("the answer to 'load' needs nonce, adc_bits, protocol_major and protocol_minor");
    FORCEGATE_CHECK_OK(check_echo({static_cast<int>(number("protocol_major")), static_cast<std::uint32_t>(number("nonce")),
                                   echoes(reply, c), number("rate_Hz")},
                                  session, "the board", program_.where()));
    counters_ = {};
    return DutInfo{static_cast<int>(number("protocol_major")),
                   static_cast<int>(number("protocol_minor")),
                   text("board"),
                   text("build_id"),
                   text("algorithm_id"),
                   session.nonce,
                   c.adc_bits,
                   session.rate_Hz};
  }

  Result<void> start() override {
    next_index_ = 0;
    FORCEGATE_CHECK_OK(program_.ask("start", {{"rate_Hz", rate_Hz_}}));
    return {};
  }
  Result<void> stop() override {
    FORCEGATE_CHECK_OK(program_.ask("stop"));
    return {};
  }

  Result<void> poll(std::vector<BoardSample>& out) override {
    FORCEGATE_TRY(const Reply reply, program_.ask("poll"));
    const double last_code = static_cast<double>((1U << adc_bits_) - 1U);
    for (const std::vector<double>& row : reply.rows) {
      if (row.size() == 4 && whole(row[1], last_code + 1.0, 65535.0))
        return program_.bad("the board sends code " + shortest(row[1]) + ", adc_bits = " + std::to_string(adc_bits_) + " ends at " + shortest(last_code));
      if (row.size() != 4 || !whole(row[0], 0, 4294967295.0) || !whole(row[1], 0, last_code) ||
          !whole(row[3], 0, 255))
        return program_.bad("a sample is not [index, code, force, flags]");
      const auto index = static_cast<std::uint32_t>(row[0]);
      if (index < next_index_) return program_.bad("samples come out of order");
      counters_.indices_lost += index - next_index_;
      next_index_ = index + 1;
      ++counters_.samples;
      out.push_back({index, static_cast<std::uint16_t>(row[1]), static_cast<float>(row[2]),
                     static_cast<std::uint8_t>(row[3])});
    }
    const auto count = [&](const char* key, std::uint64_t& value) {
      if (const auto at = reply.number.find(key); at != reply.number.end() && whole(at->second, 0, 9e15))
        value = static_cast<std::uint64_t>(at->second);
    };
    count("frames_bad", counters_.frames_bad);
    count("frames_dropped", counters_.frames_dropped);
    count("overruns", counters_.overruns);
    return {};
  }

  DutCounters counters() const override { return counters_; }
  std::map<std::string, std::uint64_t> counts() const override {
    auto all = program_.counts();
    all["damaged frames"] = counters_.frames_bad;
    all["lost frames"] = counters_.frames_dropped;
    all["lost samples"] = counters_.indices_lost;
    return all;
  }
  ClockFit clock() const override { return program_.clock().fit(); }

 private:
  // Numbers of CAL that the answer holds are those that the board echoed (as f32); adc_bits it must hold.
  static bool echoes(const Reply& reply, const Calibration& c) {
    const auto same = [&](const char* key, double sent) {
      const auto at = reply.number.find(key);
      return at == reply.number.end() || static_cast<float>(at->second) == static_cast<float>(sent);
    };
    const auto id = reply.text.find("calibration_id");
    return same("gain_N_per_V", c.gain_N_per_V) && same("offset_N", c.offset_N) && same("v_range_V", c.v_range_V) &&
           same("b_scale", c.b_scale) && same("q_scale", c.q_scale) && same("adc_bits", c.adc_bits) &&
           (id == reply.text.end() || id->second == c.id);
  }

  AdapterProcess program_;
  BenchWorld& world_;
  int adc_bits_;
  double rate_Hz_;
  std::string serial_;
  std::uint32_t next_index_ = 0;
  DutCounters counters_;
};

Result<std::unique_ptr<SensorBoard>> make(const ConfigNode& table, BenchWorld& world) {
  ConfigReader in(table, "[board]", "docs/adapters.md");
  ProcessOptions program;
  program.device = "board";
  process::read_process_options(in, table, program);
  std::int64_t bits = 16;
  double rate_Hz = 1000.0;
  std::string serial;
  for (const char* elsewhere : {"v_range_V", "flash"}) in.any(elsewhere);
  in.integer("adc_bits", bits, 8, 16);
  in.number("rate_Hz", rate_Hz, 100, 10000);
  in.text("serial", serial, ConfigReader::required);
  FORCEGATE_CHECK_OK(in.finish());
  return std::make_unique<ProcessBoard>(std::move(program), static_cast<int>(bits), rate_Hz,
                                        std::move(serial), world);
}

const Registration<BoardKind> kRegistered{
    {"process", "Sensor board behind a program of its own, in any language (docs/adapters.md)", make}};

}  // namespace
}  // namespace forcegate
