#include "hil/rig/bench_session.h"

#include <fmt/format.h>

#include "hil/base/text.h"
#include "hil/rig/self_check.h"

namespace forcegate {
namespace {

constexpr double kGuardSilence_s = 1.0;  // of a harness that hangs; the drive's own timeout is shorter

const BenchWorldKind* world_kind(const BenchFile& bench) {
  return Registry<BenchWorldKind>::instance().find(bench.twins ? "twins" : "real");
}

}  // namespace

BenchSession::BenchSession(BenchFile bench, std::map<std::string, std::string> options)
    : bench_(std::move(bench)), options_(std::move(options)) {}

BenchSession::~BenchSession() { close(); }

Result<std::unique_ptr<BenchSession>> BenchSession::make(BenchFile bench,
                                                         const std::map<std::string, std::string>& options) {
  FORCEGATE_CHECK_OK(check_devices(bench));
  std::unique_ptr<BenchSession> s(new BenchSession(std::move(bench), options));
  const BenchWorldKind* kind = world_kind(s->bench_);
  if (kind == nullptr)
    return fail(ErrorCode::internal, "this build has no world for the bench", s->bench_.path.string());
  FORCEGATE_TRY(s->world_, kind->make(s->bench_.root, options));
  const BenchFile& b = s->bench_;
  FORCEGATE_TRY(s->motor_,
                Registry<MotorKind>::instance().find(b.motor_adapter)->make(b.table("motor"), *s->world_));
  FORCEGATE_TRY(
      s->reference_,
      Registry<ReferenceKind>::instance().find(b.reference_adapter)->make(b.table("reference"), *s->world_));
  FORCEGATE_TRY(s->board_,
                Registry<BoardKind>::instance().find(b.board_adapter)->make(b.table("board"), *s->world_));
  return s;
}

Result<void> BenchSession::take_lease() {
  // Twins that this process has started for itself are nobody else's.
  if (lease_.held() || (bench_.twins && !options_.contains("attach"))) return {};
  const auto purpose = options_.find("purpose");
  FORCEGATE_TRY(lease_, Lease::take(bench_.id, purpose != options_.end() ? purpose->second : "forcegate"));
  return {};
}

template <class Device>
Result<void> BenchSession::open_device(const std::string& name, Device& device) {
  auto opened = device.open();
  if (!opened) {
    Error error = opened.error();  // what opens a port does not know whose it is
    if (!error.where.starts_with(name)) error.where = name + (error.where.empty() ? "" : ": ") + error.where;
    return Unexpected(std::move(error));
  }
  identity_[name] = std::move(*opened);
  return {};
}

Result<void> BenchSession::open() {
  if (open_) return {};
  FORCEGATE_CHECK_OK(take_lease());
  FORCEGATE_CHECK_OK(open_device("reference", *reference_));
  FORCEGATE_CHECK_OK(open_device("board", *board_));
  FORCEGATE_CHECK_OK(open_device("motor", *motor_));
  open_ = true;
  ticks_.clear();
  late_ticks_ = 0;
  late_time_s_ = last_tick_s_ = slowest_call_s_ = 0.0;
  return {};
}

Result<BenchSession::Opened> BenchSession::open_each() {
  FORCEGATE_CHECK_OK(take_lease());
  Opened each{open_device("reference", *reference_), open_device("board", *board_), open_device("motor", *motor_)};
  open_ = each.reference && each.board && each.motor;
  return each;
}

Result<void> BenchSession::start_guard() {
  auto options = options_;
  if (const std::string folder = world_->guard_option(); !folder.empty()) options["attach"] = folder;
  return guard_.start([bench = bench_, options] { (void)stop_motor_now(bench, options); },
                      world_->is_virtual() ? 0.0 : kGuardSilence_s);
}

Result<void> BenchSession::arm() {
  if (armed_) return {};
  const auto allowed = options_.find("arm");
  if (!bench_.twins && (allowed == options_.end() || allowed->second != "yes"))
    return fail(ErrorCode::safety, "the bench is not armed: nothing moves", bench_.path.string(),
                "look that nobody reaches into it, then give --arm");
  FORCEGATE_CHECK_OK(open());
  FORCEGATE_CHECK_OK(start_guard());
  if (auto armed = motor_->arm(); !armed) {
    make_safe();
    return armed;
  }
  armed_ = true;
  if (!bench_.twins) real_time_.request();
  return {};
}

Result<void> BenchSession::beat() {
  lease_.beat();
  if (guard_.beat()) return {};
  return fail(ErrorCode::safety,
              fmt::format("the harness was held up for more than {} s, or its guard has died: the guard of the motor is gone", shortest(kGuardSilence_s)),
              bench_.path.string(), "leave the machine to the bench while it runs, and look which adapter's program holds the loop up");
}

bool BenchSession::make_safe() noexcept {
  bool stopped = true;
  if (armed_ || guard_.id() > 0) stopped = motor_->emergency().has_value();
  armed_ = false;
  real_time_.release();
  if (stopped) guard_.dismiss();  // else it stays and tries when we are gone
  if (!open_) return stopped;
  (void)reference_->stop();
  (void)board_->stop();
  return stopped;
}

void BenchSession::close() noexcept {
  if (motor_) make_safe();
  if (board_) board_->close();
  if (reference_) reference_->close();
  if (motor_) motor_->close();
  open_ = false;
}

std::map<std::string, std::string> BenchSession::details() const {
  std::map<std::string, std::string> out;
  for (const auto& [device, id] : identity_) {
    if (!id.model.empty()) out[device + " model"] = id.model;
    if (!id.serial.empty()) out[device + " serial"] = id.serial;
    if (!id.calibration.empty()) out[device + " calibration"] = id.calibration;
    if (id.by_file) out[device + " serial is that of"] = "the bench file";
  }
  const auto add = [&](const std::string& device, const std::map<std::string, std::uint64_t>& counts) {
    for (const auto& [name, n] : counts)
      if (n > 0) out[device + " " + name] = std::to_string(n);
  };
  add("motor", motor_->counts());
  add("reference", reference_->counts());
  add("board", board_->counts());
  const auto tell_clock = [&](const std::string& device, const ClockFit& c) {
    if (c.exchanges > 0)
      out[device + " clock"] =
          fmt::format("skew {:+.0f} ppm, residual {:.2f} ms, u {:.2f} ms, from {} exchanges", c.skew_ppm,
                      1e3 * c.residual_s, 1e3 * c.u_s, c.exchanges);
  };
  tell_clock("motor", motor_->clock());
  tell_clock("reference", reference_->clock());
  tell_clock("board", board_->clock());
  if (ticks_.ticks() > 0) {
    out["late ticks"] = ticks_.to_text();
    out[kLateTickShare] = fmt::format("{:.6f}", static_cast<double>(late_ticks_) / static_cast<double>(ticks_.ticks()));
    if (const double ran_s = last_tick_s_ - first_tick_s_; late_time_s_ > 0.0 && ran_s > 0.0) out[kLateTimeShare] = fmt::format("{:.6f}", std::min(1.0, late_time_s_ / ran_s));
    if (slowest_call_s_ > bench_.limits.reference_stale_s) out[kSlowestCall] = fmt::format("{} took {:.3f} s", slowest_call_, slowest_call_s_);
  }
  if (ticks_.ticks() > 0 && !bench_.twins) out["real time"] = real_time_.text();
  return out;
}

Result<void> stop_motor_now(const BenchFile& bench, std::map<std::string, std::string> options) {
  options["clock"] = "paced";  // a hand that only stops must not take the twins' time over
  const BenchWorldKind* world = world_kind(bench);
  const MotorKind* kind = Registry<MotorKind>::instance().find(bench.motor_adapter);
  if (world == nullptr || kind == nullptr)
    return fail(ErrorCode::internal, "this build cannot reach the drive");
  if (bench.twins && !options.contains("attach"))
    return fail(ErrorCode::usage, "the twins of this bench live only inside a run", bench.path.string(),
                "serve them first: forcegate bench serve " + bench.path.string());
  FORCEGATE_TRY(const auto place, world->make(bench.root, options));
  FORCEGATE_TRY(const auto motor, kind->make(bench.table("motor"), *place));
  return motor->emergency();
}

}  // namespace forcegate
