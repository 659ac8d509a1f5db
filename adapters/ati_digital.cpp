// ATI Digital F/T on RS-485: set up in Modbus RTU frames, then a stream of gage records at up to 1.25 Mbaud. The matrix
// comes from the sensor itself. Zero bytes jam the stream to end it.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>

#include "adapters/ati/digital.h"
#include "adapters/ati/reading_filter.h"
#include "adapters/ati/reference_options.h"
#include "hil/base/arrival_clock.h"
#include "hil/interface/device.h"

namespace forcegate {
namespace {

constexpr double kResync_s = 0.2;  ///< bench time between two attempts to begin the stream anew
constexpr int kResyncMax = 10, kAttempts = 3;
constexpr std::size_t kJamBytes = 72, kHold = 2;
constexpr std::uint8_t kStream = 0x46, kLock = 0x6A;
using Wall = std::chrono::steady_clock;

struct DigitalOptions : ati::ReferenceOptions {
  std::string port;
  LineSettings line{1250000, LineParity::even};
  std::uint8_t slave = 10;
  int calibration_index = 1;
  double rate_Hz = 0.0, reply_timeout_s = 0.5;
};

class AtiDigital final : public ReferenceSensor {
 public:
  AtiDigital(DigitalOptions options, BenchWorld& world)
      : options_(std::move(options)),
        world_(world),
        filter_(options_.force_max_N, options_.jump_max_N, kHold) {}
  ~AtiDigital() override { close(); }

  Result<DeviceIdentity> open() override {
    close();
    FORCEGATE_TRY(line_, world_.open_line(options_.port, options_.line));
    FORCEGATE_CHECK_OK(stop());
    std::vector<std::uint16_t> block;
    const int base = ati::kCalibrationRegister + ati::kCalibrationStride * (options_.calibration_index - 1);
    for (const auto& [from, count] : {std::pair{0, 64}, {64, 64}, {128, ati::kCalibrationWords - 128}}) {
      FORCEGATE_TRY(const auto words, read_registers(base + from, count));
      block.insert(block.end(), words.begin(), words.end());
    }
    auto calibration = ati::decode_calibration(block);
    if (!calibration)
      return fail(calibration.error().code, calibration.error().text, where(), calibration.error().hint);
    calibration_ = std::move(*calibration);
    if (calibration_.serial != options_.serial)
      return fail(
          ErrorCode::device,
          "the sensor has serial number " + calibration_.serial + ", the bench file says " + options_.serial,
          where(), "connect the right sensor, or enter its calibration and serial number");
    FORCEGATE_CHECK_OK(switch_lock(0xAA));
    const auto written =
        command(ati::encode_write(options_.slave, ati::kGainRegister, calibration_.gains_and_offsets), 16, 8);
    const auto locked = switch_lock(0x18);
    if (!written) return Unexpected(written.error());
    FORCEGATE_CHECK_OK(locked);
    return DeviceIdentity{"ATI Digital F/T " + calibration_.part, calibration_.serial, "",
                          options_.calibration_id};
  }

  void close() noexcept override {
    if (line_) (void)jam();
    line_.reset();
    state_ = State::idle;
  }

  Result<void> start() override {
    filter_.begin();
    clock_.begin(options_.rate_Hz, 0.5);
    resyncs_in_a_row_ = 0;
    FORCEGATE_CHECK_OK(begin_stream());
    return {};
  }

  Result<void> stop() override {
    state_ = State::idle;
    FORCEGATE_CHECK_OK(jam());
    FORCEGATE_CHECK_OK(until_quiet());
    // Whatever the jam has left half said is answered or forgotten now.
    for (int attempt = 0;; ++attempt) {
      const auto status = read_registers(ati::kStatusRegister, 1);
      if (status) return {};
      if (attempt + 1 == kAttempts) return Unexpected(status.error());
      FORCEGATE_CHECK_OK(jam());
      FORCEGATE_CHECK_OK(until_quiet());
    }
  }

  Result<void> poll(std::vector<ReferenceReading>& out) override {
    const std::size_t before = buffer_.size();
    FORCEGATE_CHECK_OK(receive(0.0));
    const double now_s = world_.now_s();
    if (state_ == State::stopping) {
      const bool quiet = buffer_.size() == before && now_s - asked_s_ > kQuiet_s;
      if (quiet) return begin_stream();
      if (now_s - asked_s_ > kResync_s) return resynchronise(now_s);
      return {};
    }
    if (state_ == State::starting) {
      if (buffer_.size() < 5) return now_s - asked_s_ > kResync_s ? resynchronise(now_s) : Result<void>{};
      const auto reply = ati::decode_frame(std::span(buffer_).first(5), options_.slave, kStream);
      if (!reply || (*reply)[0] != 1) return resynchronise(now_s);
      buffer_.erase(buffer_.begin(), buffer_.begin() + 5);
      state_ = State::streaming;
      clock_.restart();
    }
    std::size_t at = 0;
    ati::GageRecord record;
    for (; state_ == State::streaming; at += ati::kGageRecordSize) {
      const auto parsed = ati::parse_gages(std::span<const std::uint8_t>(buffer_).subspan(at), record);
      if (parsed == ati::GageParse::need_more) break;
      const double force_N = options_.sign * ati::gage_force_N(calibration_, record, options_.axis);
      if (parsed == ati::GageParse::invalid ||
          (!record.status_error && !is_railed(record) && !filter_.plausible(force_N))) {
        ++bad_records_;
        filter_.drop();
        return resynchronise(now_s);
      }
      take(record, force_N, now_s, out);
    }
    buffer_.erase(buffer_.begin(),
                  buffer_.begin() + static_cast<std::ptrdiff_t>(std::min(at, buffer_.size())));
    return {};
  }

  ReferenceFacts facts() const override {
    return {options_.rate_Hz, 0.5 / options_.rate_Hz};
  }
  std::map<std::string, std::uint64_t> counts() const override {
    return {{"bad records", bad_records_},
            {"resynchronisations", resyncs_},
            {"error records", error_records_},
            {"undated records", undated_},
            {"requests repeated", repeats_}};
  }

 private:
  static bool is_railed(const ati::GageRecord& r) {
    return std::any_of(r.gage.begin(), r.gage.end(), [](int g) { return g <= -32768 || g >= 32767; });
  }
  enum class State { idle, stopping, starting, streaming };
  static constexpr double kQuiet_s = 0.02;

  std::string where() const { return "reference: " + (line_ ? line_->name() : options_.port); }
  Unexpected told(const Error& e) const {
    return fail(ErrorCode::device, e.text, where(), "check cable and power");
  }

  Result<void> send(std::span<const std::uint8_t> bytes) {
    if (!line_) return fail(ErrorCode::device, "the reference is not open", where());
    if (auto sent = line_->write(bytes, 1.0); !sent) return told(sent.error());
    return {};
  }
  Result<void> jam() {
    const std::array<std::uint8_t, kJamBytes> zeros{};
    return send(zeros);
  }
  Result<void> receive(double timeout_s) {
    if (!line_) return fail(ErrorCode::device, "the reference is not open", where());
    for (;;) {
      std::uint8_t bytes[4096];
      const auto n = line_->read(bytes, timeout_s);
      if (!n) return told(n.error());
      if (*n == 0) return {};
      buffer_.insert(buffer_.end(), bytes, bytes + *n);
      timeout_s = 0.0;
      if (buffer_.size() > 1000000)
        return fail(ErrorCode::device, "the sensor floods the line", where(), "check the baud rate");
    }
  }
  /// Reads until nothing comes for a while (wall time: an exchange).
  Result<void> until_quiet() {
    const auto end = Wall::now() + std::chrono::duration<double>(options_.reply_timeout_s);
    do {
      buffer_.clear();
      FORCEGATE_CHECK_OK(receive(kQuiet_s));
    } while (!buffer_.empty() && Wall::now() < end);
    if (!buffer_.empty())
      return fail(ErrorCode::device, "the sensor's stream does not end", where(),
                  "check baud rate, parity and wiring");
    return {};
  }

  Result<std::vector<std::uint8_t>> command(const std::vector<std::uint8_t>& request, std::uint8_t function,
                                            std::size_t size) {
    Error last;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      if (attempt > 0) ++repeats_;
      FORCEGATE_CHECK_OK(until_quiet());
      FORCEGATE_CHECK_OK(send(request));
      const auto end = Wall::now() + std::chrono::duration<double>(options_.reply_timeout_s);
      while (buffer_.size() < size && Wall::now() < end) {
        if (buffer_.size() == 5 && buffer_[1] == (function | 0x80U)) break;
        FORCEGATE_CHECK_OK(receive(0.01));
      }
      if (buffer_.empty()) {
        last = {ErrorCode::timeout, "the sensor does not answer", where(),
                "check power, cable, baud rate (1.25 M, 115200 or 19200) and slave"};
        continue;
      }
      auto reply = ati::decode_frame(buffer_, options_.slave, function);
      if (reply) return reply;
      last = {ErrorCode::device, reply.error().text, where(), "check baud rate, parity and wiring"};
    }
    return Unexpected(last);
  }
  Result<std::vector<std::uint16_t>> read_registers(int address, int count) {
    FORCEGATE_TRY(const auto data, command(ati::encode_read(options_.slave, address, count), 3,
                                           static_cast<std::size_t>(2 * count) + 5));
    if (data.size() != static_cast<std::size_t>(2 * count) + 1 || data[0] != 2 * count)
      return fail(ErrorCode::device, "the sensor answers with another number of registers", where());
    std::vector<std::uint16_t> words;
    for (std::size_t i = 1; i < data.size(); i += 2)
      words.push_back(static_cast<std::uint16_t>(data[i] << 8 | data[i + 1]));
    return words;
  }
  Result<void> switch_lock(std::uint8_t key) {
    FORCEGATE_TRY(const auto data, command(ati::encode_frame(options_.slave, kLock, {&key, 1}), kLock, 5));
    if (data[0] != 1)
      return fail(ErrorCode::device, "the sensor does not let its settings be changed", where());
    return {};
  }

  Result<void> begin_stream() {
    buffer_.clear();
    const std::uint8_t key = 0x55;
    state_ = State::starting;
    asked_s_ = world_.now_s();
    return send(ati::encode_frame(options_.slave, kStream, {&key, 1}));
  }
  Result<void> resynchronise(double now_s) {
    ++resyncs_;
    if (++resyncs_in_a_row_ > kResyncMax)
      return fail(ErrorCode::device, "the stream of the sensor is unreadable", where(),
                  "check baud rate, shield and termination of the line");
    state_ = State::stopping;
    asked_s_ = now_s;
    buffer_.clear();
    filter_.begin();
    return jam();
  }

  void take(const ati::GageRecord& record, double force_N, double now_s, std::vector<ReferenceReading>& out) {
    ReferenceReading reading;
    reading.t_s = clock_.next(now_s) - static_cast<double>(ati::kGageRecordSize) * 11.0 / options_.line.baud;
    reading.force_N = static_cast<float>(force_N);
    const bool railed = is_railed(record);
    if (record.status_error || railed) {
      ++error_records_;
      reading.force_N = std::numeric_limits<float>::quiet_NaN();
      reading.status = railed ? kRigReferenceSaturated : kRigReferenceFault;
    }
    resyncs_in_a_row_ = 0;
    if (clock_.settled(now_s))
      filter_.take(reading, out);
    else
      ++undated_, filter_.pass(static_cast<double>(reading.force_N));
  }

  DigitalOptions options_;
  BenchWorld& world_;
  ati::ReadingFilter filter_;
  ati::DigitalCalibration calibration_;
  std::unique_ptr<Transport> line_;
  std::vector<std::uint8_t> buffer_;
  ArrivalClock clock_;
  State state_ = State::idle;
  double asked_s_ = 0.0;
  int resyncs_in_a_row_ = 0;
  std::uint64_t bad_records_ = 0, resyncs_ = 0, error_records_ = 0, undated_ = 0, repeats_ = 0;
};

Result<std::unique_ptr<ReferenceSensor>> make(const ConfigNode& table, BenchWorld& world) {
  ConfigReader in(table, "[reference]", "docs/bench.md");
  DigitalOptions o;
  std::string parity = "even";
  std::int64_t baud = 1250000, slave = 10, index = 1, timeout_ms = 500;
  in.text("port", o.port, ConfigReader::required);
  in.integer("baud", baud, 19200, 1250000);
  in.choice("parity", parity, {"none", "even", "odd"});
  in.integer("slave", slave, 1, 247);
  in.integer("calibration_index", index, 1, 16);
  in.number("rate_Hz", o.rate_Hz, 10, 10000, ConfigReader::required);
  in.integer("reply_timeout_ms", timeout_ms, 5, 5000);
  ati::read_reference_options(in, o);
  FORCEGATE_CHECK_OK(in.finish());
  o.line = {static_cast<unsigned>(baud), parity == "even"  ? LineParity::even
                                         : parity == "odd" ? LineParity::odd
                                                           : LineParity::none};
  o.slave = static_cast<std::uint8_t>(slave);
  o.calibration_index = static_cast<int>(index);
  o.reply_timeout_s = static_cast<double>(timeout_ms) * 1e-3;
  return std::make_unique<AtiDigital>(std::move(o), world);
}

const Registration<ReferenceKind> kRegistered{
    {"ati_digital", "ATI Digital F/T on RS-485: Modbus frames, then a stream of gage records at 1.25 Mbaud",
     make}};

}  // namespace
}  // namespace forcegate
