// ATI stand-alone F/T controller on RS-232: ASCII commands, prompt '>', stream by QS. The link is slow (295 binary
// records a second at 38400 baud), so readings are stamped by when they were measured, and resampled by the rig.

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "adapters/ati/record.h"
#include "adapters/ati/reference_options.h"
#include "hil/base/arrival_clock.h"
#include "hil/base/text.h"
#include "hil/interface/device.h"

namespace forcegate {
namespace {

constexpr double kReply_s = 1.0;   ///< wall time for an answer to a command
constexpr double kResync_s = 0.2;  ///< bench time between two attempts to stop a stream
constexpr double kClockWindow_s = 0.5;
constexpr int kResyncMax = 10;
constexpr int kBadLinesMax = 20;

struct AtiOptions : ati::ReferenceOptions {
  std::string port;
  LineSettings line{38400, LineParity::none};
  bool binary = true, checksum = true, bias = false;
  int average = 1;
  double counts_per_force = 1.0, newtons_per_unit = 1.0, rate_Hz = 0.0;
};

class AtiSerial final : public ReferenceSensor {
 public:
  AtiSerial(AtiOptions options, BenchWorld& world) : options_(std::move(options)), world_(world) {}
  ~AtiSerial() override { close(); }

  Result<DeviceIdentity> open() override {
    close();
    FORCEGATE_TRY(line_, world_.open_line(options_.port, options_.line));
    FORCEGATE_CHECK_OK(stop());
    const char* const form = options_.binary ? "CD B" : "CD A";
    FORCEGATE_CHECK_OK(command(form));
    FORCEGATE_CHECK_OK(command("CD R"));
    if (options_.binary) FORCEGATE_CHECK_OK(command(options_.checksum ? "CD E" : "CD U"));
    FORCEGATE_CHECK_OK(command("SM 1"));  // saturation and disconnected gages set the error byte
    FORCEGATE_CHECK_OK(command(fmt::format("SA {}", options_.average)));
    if (options_.bias) FORCEGATE_CHECK_OK(command("SB"));
    return DeviceIdentity{"ATI F/T controller", options_.serial, "", options_.calibration_id, true};
  }

  void close() noexcept override {
    if (line_) (void)send("\r");
    line_.reset();
    state_ = State::idle;
  }

  Result<void> start() override {
    FORCEGATE_CHECK_OK(send("QS\r"));
    buffer_.clear();
    state_ = State::echo;
    width_ = candidate_width_ = 0;
    resyncs_in_a_row_ = bad_in_a_row_ = 0;
    clock_.begin(rate_Hz(), kClockWindow_s);
    last_N_ = std::numeric_limits<double>::quiet_NaN();
    held_.clear();
    return {};
  }

  Result<void> poll(std::vector<ReferenceReading>& out) override {
    FORCEGATE_CHECK_OK(receive());
    const double now_s = world_.now_s();
    if (state_ == State::stopping) FORCEGATE_CHECK_OK(wait_for_prompt(now_s));
    if (state_ == State::echo && !skip_echo()) return {};
    while (state_ == State::streaming) {
      const ati::ParseResult parsed =
          options_.binary ? ati::parse_binary(buffer_, options_.checksum) : ati::parse_ascii(buffer_, width_);
      if (parsed.kind == ati::Parse::need_more) break;
      const bool plausible = parsed.kind == ati::Parse::value && is_plausible(parsed.record);
      if (!plausible) {
        ++bad_records_;
        held_.clear();
        if (options_.binary || parsed.consumed == 0) {
          FORCEGATE_CHECK_OK(resynchronise(now_s));
          break;
        }
        buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(parsed.consumed));
        clock_.next(now_s);  // a line was measured, only not readable
        if (++bad_in_a_row_ > kBadLinesMax) FORCEGATE_CHECK_OK(resynchronise(now_s));
        continue;
      }
      const bool learning = !options_.binary && width_ == 0;
      if (learning && std::exchange(candidate_width_, parsed.consumed) == parsed.consumed) {
        width_ = parsed.consumed;
        clock_.begin(rate_Hz(), kClockWindow_s);  // the width says how many lines a second there are
      }
      buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(parsed.consumed));
      if (learning)
        clock_.next(now_s);  // lines count once two in a row have one length
      else
        take(parsed.record, now_s, out);
    }
    return {};
  }

  Result<void> stop() override {
    state_ = State::idle;
    for (int attempt = 0; attempt < 3; ++attempt) {
      FORCEGATE_CHECK_OK(send("\r"));
      FORCEGATE_TRY(const std::string reply, until_prompt());
      // A stream has stopped for good when a further CR gives nothing but an empty line and the prompt.
      FORCEGATE_CHECK_OK(send("\r"));
      FORCEGATE_TRY(const std::string quiet, until_prompt());
      if (trim(quiet).empty()) return {};
    }
    return fail(ErrorCode::device, "the ATI controller does not come to rest", where(),
                "check the baud rate, and that nothing else uses the line");
  }

  // SA n is a moving average over the controller's own samples, whose rate it does not tell and which is no lower than the stream's:
  // a reading is late by up to half of n - 1 of them.
  ReferenceFacts facts() const override {
    return {rate_Hz(), 0.5 * options_.average / rate_Hz(), options_.counts_per_force};
  }
  std::map<std::string, std::uint64_t> counts() const override {
    return {{"bad records", bad_records_},
            {"resynchronisations", resyncs_},
            {"error records", error_records_},
            {"undated records", undated_records_}};
  }

 private:
  enum class State { idle, echo, streaming, stopping };

  std::string where() const { return "reference: " + (line_ ? line_->name() : options_.port); }
  std::size_t record_bytes() const {
    return options_.binary ? (options_.checksum ? 14 : 13) : (width_ ? width_ : 45);
  }
  double rate_Hz() const {
    return options_.rate_Hz > 0.0 ? options_.rate_Hz
                                  : options_.line.baud / (10.0 * static_cast<double>(record_bytes()));
  }

  Result<void> send(std::string_view text) {
    if (!line_) return fail(ErrorCode::device, "the reference is not open", where());
    auto sent = line_->write({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, kReply_s);
    if (!sent)
      return Unexpected(Error{ErrorCode::device, sent.error().text, where(), "check cable and power"});
    return {};
  }

  /// What the controller says from `echo` on up to its prompt. A prompt before the echo answers something older, such as
  /// the CR with which the line was closed the last time: it may come at any moment.
  Result<std::string> until_prompt(std::string_view echo = {}) {
    std::string reply;
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kReply_s);
    while (std::chrono::steady_clock::now() < end && reply.size() < 100000) {
      std::uint8_t bytes[512];
      const auto n = line_->read(bytes, 0.05);
      if (!n) return Unexpected(Error{ErrorCode::device, n.error().text, where(), "check cable and power"});
      reply.append(reinterpret_cast<const char*>(bytes), *n);
      const std::size_t begin = reply.find(echo);
      if (*n == 0 || begin == std::string::npos) continue;
      const std::string_view answer = trim(std::string_view(reply).substr(begin));
      if (!answer.empty() && answer.back() == '>') return std::string(answer.substr(0, answer.size() - 1));
    }
    if (!echo.empty() && !reply.empty()) return reply;
    return fail(ErrorCode::timeout, "the ATI controller does not answer", where(),
                "check power, cable and baud rate (38400 or 9600 are usual)");
  }

  /// The echo must be there; a garbled exchange is tried again.
  Result<void> command(const std::string& text) {
    std::string got;
    for (int attempt = 0; attempt < 3; ++attempt) {
      FORCEGATE_CHECK_OK(send(text + "\r"));
      FORCEGATE_TRY(got, until_prompt(text));
      if (got.starts_with(text)) {
        const std::string answer(trim(got.substr(text.size())));
        if (answer.find('?') == std::string::npos && answer.find("rror") == std::string::npos) return {};
        return fail(ErrorCode::device, "the ATI controller refuses '" + text + "': " + printable_utf8(answer),
                    where());
      }
      FORCEGATE_CHECK_OK(stop());
    }
    return fail(ErrorCode::device,
                "the ATI controller echoes '" + printable_utf8(trim(got)) + "' to '" + text + "'", where(),
                "check baud rate and parity");
  }

  Result<void> receive() {
    if (!line_) return fail(ErrorCode::device, "the reference is not open", where());
    for (;;) {
      std::uint8_t bytes[4096];
      const auto n = line_->read(bytes, 0.0);
      if (!n) return Unexpected(Error{ErrorCode::device, n.error().text, where(), "check cable and power"});
      if (*n == 0) return {};
      buffer_.insert(buffer_.end(), bytes, bytes + *n);
    }
  }

  bool skip_echo() {
    std::size_t i = 0;
    while (i < buffer_.size() &&
           (buffer_[i] == 'Q' || buffer_[i] == 'S' || buffer_[i] == '\r' || buffer_[i] == '\n'))
      ++i;
    if (i == buffer_.size()) return false;
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(i));
    state_ = State::streaming;
    clock_.restart();
    return true;
  }

  double force_of(const ati::Record& r) const {
    return options_.sign * r.counts[options_.axis] / options_.counts_per_force * options_.newtons_per_unit;
  }

  bool is_plausible(const ati::Record& r) const {
    if (r.error != 0) return true;  // its own kind of reading
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (std::abs(r.counts[axis]) / options_.counts_per_force * options_.newtons_per_unit >
          1.05 * options_.force_max_N)
        return false;
    const double force_N = force_of(r);
    return !(std::fabs(force_N - last_N_) >
             options_.jump_max_N);  // the first one has nothing to be compared with
  }

  // A record counts only when the one behind it is sound too: a byte lost in its middle shows there.
  void take(const ati::Record& r, double now_s, std::vector<ReferenceReading>& out) {
    ReferenceReading reading;
    reading.t_s = clock_.next(now_s) - static_cast<double>(record_bytes()) * 10.0 / options_.line.baud;
    if (r.error != 0) {
      ++error_records_;
      reading.force_N = std::numeric_limits<float>::quiet_NaN();
      reading.status = r.error == 1 ? kRigReferenceSaturated : kRigReferenceFault;
      last_N_ = std::numeric_limits<double>::quiet_NaN();
    } else {
      last_N_ = force_of(r);
      reading.force_N = static_cast<float>(last_N_);
    }
    resyncs_in_a_row_ = bad_in_a_row_ = 0;
    for (const ReferenceReading& h : held_) out.push_back(h);
    held_.clear();
    if (clock_.settled(now_s))
      held_.push_back(reading);
    else
      ++undated_records_;
  }

  Result<void> resynchronise(double now_s) {
    ++resyncs_;
    if (++resyncs_in_a_row_ > kResyncMax)
      return fail(ErrorCode::device, "the ATI stream is unreadable", where(),
                  "check baud rate, cable shield, and 'form' and 'checksum' of [reference]");
    state_ = State::stopping;
    stop_sent_s_ = now_s;
    buffer_.clear();
    last_N_ = std::numeric_limits<double>::quiet_NaN();
    return send("\r");
  }

  // The prompt can be a byte of a record: it counts only as the last byte of a line that has come to rest.
  Result<void> wait_for_prompt(double now_s) {
    const bool prompt = !buffer_.empty() && buffer_.back() == '>';
    if (prompt && buffer_.size() == quiet_size_) {
      buffer_.clear();
      quiet_size_ = 0;
      FORCEGATE_CHECK_OK(send("QS\r"));
      state_ = State::echo;
      return {};
    }
    quiet_size_ = buffer_.size();
    if (now_s - stop_sent_s_ > kResync_s) return resynchronise(now_s);
    return {};
  }

  AtiOptions options_;
  BenchWorld& world_;
  std::unique_ptr<Transport> line_;
  State state_ = State::idle;
  std::vector<std::uint8_t> buffer_;
  std::size_t width_ = 0, quiet_size_ = 0;
  ArrivalClock clock_;
  std::vector<ReferenceReading> held_;
  double last_N_ = std::numeric_limits<double>::quiet_NaN(), stop_sent_s_ = 0.0;
  std::size_t candidate_width_ = 0;
  int resyncs_in_a_row_ = 0, bad_in_a_row_ = 0;
  std::uint64_t bad_records_ = 0, resyncs_ = 0, error_records_ = 0, undated_records_ = 0;
};

Result<std::unique_ptr<ReferenceSensor>> make(const ConfigNode& table, BenchWorld& world) {
  ConfigReader in(table, "[reference]", "docs/bench.md");
  AtiOptions o;
  std::string form = "binary", checksum = "sum8", units = "N";
  std::int64_t baud = 38400, average = 1;
  in.text("port", o.port, ConfigReader::required);
  in.integer("baud", baud, 1200, 1250000);
  in.choice("form", form, {"ascii", "binary"});
  in.choice("checksum", checksum, {"none", "sum8"});
  in.choice("units", units, {"N", "lbf"});
  in.integer("average", average, 1, 255);
  in.boolean("bias", o.bias);
  in.number("counts_per_force", o.counts_per_force, 1e-3, 1e7, ConfigReader::required);
  in.number("rate_Hz", o.rate_Hz, 1, 10000);
  ati::read_reference_options(in, o);
  FORCEGATE_CHECK_OK(in.finish());
  o.line.baud = static_cast<unsigned>(baud);
  o.binary = form == "binary";
  o.checksum = checksum == "sum8";
  o.average = static_cast<int>(average);
  o.newtons_per_unit = units == "lbf" ? 4.4482216152605 : 1.0;
  return std::make_unique<AtiSerial>(std::move(o), world);
}

const Registration<ReferenceKind> kRegistered{
    {"ati_serial", "ATI stand-alone F/T controller on RS-232, ASCII or binary stream", make}};

}  // namespace
}  // namespace forcegate
