// ATI Net F/T: raw data transfer over UDP. Records carry a sequence number, so that every loss is counted and dating is
// not disturbed by it; a second number tells whether the sensor still measures.

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "adapters/ati/rdt.h"
#include "adapters/ati/reading_filter.h"
#include "adapters/ati/reference_options.h"
#include "adapters/transport/network.h"
#include "hil/base/arrival_clock.h"
#include "hil/interface/device.h"

namespace forcegate {
namespace {

using ati::RdtCommand;
constexpr double kSilence_s = 0.1;  ///< bench time after which the stream is asked for again
constexpr int kAsksMax = 5, kDisorderMax = 20, kImplausibleMax = 50;
constexpr std::uint32_t kGapMax = 100000;  ///< records; more is a restart of the box, no loss

struct NetFtOptions : ati::ReferenceOptions {
  std::string host;
  int udp_port = 49152, http_port = 80;
  double rate_Hz = 1000.0, counts_per_force = 0.0, u_time_s = 0.0005, page_timeout_s = 2.0;
  bool bias = false;
};

class AtiNetFt final : public ReferenceSensor {
 public:
  AtiNetFt(NetFtOptions options, BenchWorld& world)
      : options_(std::move(options)), world_(world), filter_(options_.force_max_N, options_.jump_max_N, 0) {}
  ~AtiNetFt() override { close(); }

  Result<DeviceIdentity> open() override {
    close();
    FORCEGATE_TRY(const ati::NetFtConfig config, named(read_page()));
    if (std::fabs(config.counts_per_force - options_.counts_per_force) > 1e-9 * options_.counts_per_force)
      return fail(ErrorCode::config,
                  fmt::format("the box counts {:.9g} to a unit of force, the bench file says {:.9g}",
                              config.counts_per_force, options_.counts_per_force),
                  where(),
                  "select the calibration of this sensor in the box, or enter its scale in the bench file");
    if (config.rate_Hz > 0.0 && std::fabs(config.rate_Hz - options_.rate_Hz) > 1e-6 * options_.rate_Hz)
      return fail(ErrorCode::config,
                  fmt::format("the box sends {:.6g} records a second, the bench file says {:.6g}",
                              config.rate_Hz, options_.rate_Hz),
                  where(), "set the RDT rate in the box or rate_Hz in the bench file");
    newtons_per_count_ = config.newtons_per_unit / config.counts_per_force;
    FORCEGATE_TRY(line_, named(world_.open_datagrams("reference", options_.host, options_.udp_port)));
    FORCEGATE_CHECK_OK(stop());
    if (options_.bias) FORCEGATE_CHECK_OK(send(RdtCommand::bias));
    return DeviceIdentity{config.product, options_.serial, "", options_.calibration_id, true};
  }

  void close() noexcept override {
    if (line_) (void)send(RdtCommand::stop);
    line_.reset();
    streaming_ = false;
  }

  Result<void> start() override {
    FORCEGATE_CHECK_OK(discard());
    filter_.begin();
    clock_.begin(options_.rate_Hz, 0.5);
    rdt_.reset();
    ft_.reset();
    asks_ = disorder_ = implausible_in_a_row_ = 0;
    streaming_ = true;
    return ask();
  }

  Result<void> stop() override {
    streaming_ = false;
    return send(RdtCommand::stop);
  }

  Result<void> poll(std::vector<ReferenceReading>& out) override {
    if (!line_) return fail(ErrorCode::device, "the reference is not open", where());
    const double now_s = world_.now_s();
    for (;;) {
      std::uint8_t datagram[2048];
      const auto n = line_->read(datagram, 0.0);
      if (!n) return told(n.error());
      if (*n == 0) break;
      records_.clear();
      if (!ati::decode_rdt({datagram, *n}, records_)) {
        ++bad_datagrams_;
        continue;
      }
      if (!streaming_) continue;
      for (const ati::RdtRecord& r : records_) FORCEGATE_CHECK_OK(take(r, now_s, out));
    }
    if (streaming_ && now_s - heard_s_ > kSilence_s) {
      if (++asks_ > kAsksMax)
        return fail(ErrorCode::timeout, "the Net F/T sends nothing", where(),
                    "check power and network; only one program at a time gets its records");
      if (options_.bias && rdt_)
        return fail(ErrorCode::device, "the Net F/T fell silent: its bias may be lost", where(),
                    "begin the record again");
      rdt_.reset();
      clock_.restart();
      filter_.begin();
      return ask();
    }
    return {};
  }

  ReferenceFacts facts() const override {
    return {options_.rate_Hz, options_.u_time_s};
  }
  std::map<std::string, std::uint64_t> counts() const override {
    return {{"bad datagrams", bad_datagrams_},
            {"lost records", lost_},
            {"repeated or late records", disordered_},
            {"error records", error_records_},
            {"unbelievable records", implausible_},
            {"records that stood still", stalled_},
            {"requests repeated", repeats_}};
  }

 private:
  std::string where() const { return "reference: " + (line_ ? line_->name() : options_.host); }
  Unexpected told(const Error& e) const {
    return fail(ErrorCode::device, e.text, where(), "check power and network of the Net F/T");
  }
  /// Errors of the network become those of the reference.
  template <class T>
  Result<T> named(Result<T> result) const {
    if (result) return result;
    const Error& e = result.error();
    return fail(e.code == ErrorCode::io ? ErrorCode::device : e.code, e.text,
                where() + (e.where.empty() ? "" : " " + e.where), e.hint);
  }
  Result<ati::NetFtConfig> read_page() const {
    FORCEGATE_TRY(const int port, world_.tcp_port("reference", options_.http_port));
    FORCEGATE_TRY(const std::string page,
                  http_get(options_.host, port, "/netftapi2.xml", options_.page_timeout_s));
    return ati::parse_netft_page(page);
  }
  Result<void> send(RdtCommand command) {
    if (!line_) return fail(ErrorCode::device, "the reference is not open", where());
    if (auto sent = line_->write(ati::encode_rdt(command, 0), 1.0); !sent) return told(sent.error());
    return {};
  }
  Result<void> ask() {
    if (asks_ > 0) ++repeats_;
    heard_s_ = world_.now_s();
    return send(RdtCommand::stream);
  }
  Result<void> discard() {
    std::uint8_t datagram[2048];
    for (;;) {
      if (!line_) return fail(ErrorCode::device, "the reference is not open", where());
      const auto n = line_->read(datagram, 0.0);
      if (!n) return told(n.error());
      if (*n == 0) return {};
    }
  }

  Result<void> take(const ati::RdtRecord& r, double now_s, std::vector<ReferenceReading>& out) {
    if (rdt_) {
      const std::uint32_t ahead = r.rdt_sequence - *rdt_;
      if (ahead == 0 || ahead >= kGapMax) {
        ++disordered_;
        if (++disorder_ > kDisorderMax)
          return fail(ErrorCode::device, "the Net F/T counts its records anew: it has restarted", where(),
                      "begin the record again");
        return {};
      }
      for (std::uint32_t i = 1; i < ahead; ++i) clock_.next(now_s);
      if (ahead > 1) filter_.begin();  // what the force did meanwhile nobody knows
      lost_ += ahead - 1;
    }
    disorder_ = asks_ = 0;
    heard_s_ = now_s;
    rdt_ = r.rdt_sequence;
    ReferenceReading reading;
    reading.t_s = clock_.next(now_s);
    const double force_N = options_.sign * r.counts[options_.axis] * newtons_per_count_;
    reading.force_N = static_cast<float>(force_N);
    const ati::RdtHealth health = ati::rdt_health(r.status);
    const bool stalled = ft_ && *ft_ == r.ft_sequence;
    ft_ = r.ft_sequence;
    if (health != ati::RdtHealth::good || stalled) {
      ++(stalled ? stalled_ : error_records_);
      reading.force_N = std::numeric_limits<float>::quiet_NaN();
      reading.status = health == ati::RdtHealth::saturated ? kRigReferenceSaturated : kRigReferenceFault;
    } else if (!filter_.plausible(force_N)) {
      ++implausible_;
      if (++implausible_in_a_row_ > kImplausibleMax)
        return fail(ErrorCode::device, fmt::format("the Net F/T reads {:.3g} N again and again", force_N),
                    where(), "check force_max_N, scale and unit of the reference");
      return {};
    }
    implausible_in_a_row_ = 0;
    if (clock_.settled(now_s))
      filter_.take(reading, out);
    else
      filter_.pass(static_cast<double>(reading.force_N));
    return {};
  }

  NetFtOptions options_;
  BenchWorld& world_;
  std::unique_ptr<Transport> line_;
  ati::ReadingFilter filter_;
  ArrivalClock clock_;
  std::vector<ati::RdtRecord> records_;
  std::optional<std::uint32_t> rdt_, ft_;
  double newtons_per_count_ = 0.0, heard_s_ = 0.0;
  bool streaming_ = false;
  int asks_ = 0, disorder_ = 0, implausible_in_a_row_ = 0;
  std::uint64_t bad_datagrams_ = 0, lost_ = 0, disordered_ = 0, error_records_ = 0, implausible_ = 0,
                stalled_ = 0, repeats_ = 0;
};

Result<std::unique_ptr<ReferenceSensor>> make(const ConfigNode& table, BenchWorld& world) {
  ConfigReader in(table, "[reference]", "docs/bench.md");
  NetFtOptions o;
  std::int64_t udp = 49152, http = 80, page_ms = 2000;
  in.text("host", o.host, ConfigReader::required);
  in.integer("udp_port", udp, 0, 65535);
  in.integer("http_port", http, 0, 65535);
  in.integer("page_timeout_ms", page_ms, 10, 60000);
  in.number("rate_Hz", o.rate_Hz, 10, 8000, ConfigReader::required);
  in.number("counts_per_force", o.counts_per_force, 1e-3, 1e9, ConfigReader::required);
  in.boolean("bias", o.bias);
  in.number("u_time_s", o.u_time_s, 1e-6, 0.1);
  ati::read_reference_options(in, o);
  FORCEGATE_CHECK_OK(in.finish());
  o.udp_port = static_cast<int>(udp);
  o.http_port = static_cast<int>(http);
  o.page_timeout_s = static_cast<double>(page_ms) * 1e-3;
  return std::make_unique<AtiNetFt>(std::move(o), world);
}

const Registration<ReferenceKind> kRegistered{{"ati_netft", "ATI Net F/T: raw data transfer over UDP", make}};

}  // namespace
}  // namespace forcegate
