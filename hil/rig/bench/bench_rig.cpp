// Rig "bench": real instruments, or wire-level twins of them, behind the one interface that the gate knows. How their
// streams become rows: hil/rig/bench/row_assembler.h.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>

#include "hil/base/portable_math.h"
#include "hil/base/read_file.h"
#include "hil/base/text.h"
#include "hil/base/utc_clock.h"
#include "hil/rig/bench/row_assembler.h"
#include "hil/rig/bench/swing_counter.h"
#include "hil/rig/bench_session.h"
#include "hil/rig/self_check.h"
#include "hil/rig/slow_move.h"
#include "hil/rig/specimen_log.h"

namespace forcegate {
namespace {

constexpr double kPeriod_s = 0.01;       // between two looks at the drive
constexpr double kUsableTravel = 0.95;    // the rest is for control
constexpr double kStartTolerance_rad = 0.02;

RowFacts row_facts(const BenchFile& bench) {
  return {bench.rate_Hz, bench.adc_bits, bench.geometry.theta_min_rad, bench.geometry.theta_max_rad,
          bench.limits.board_stale_s, bench.limits.reference_stale_s};
}

class BenchRig final : public Rig, public Dut {
 public:
  BenchRig(BenchFile bench, std::map<std::string, std::string> options)
      : bench_(std::move(bench)), options_(std::move(options)), info_(rig_info(bench_)), rows_(row_facts(bench_)) {}
  ~BenchRig() override { BenchRig::park(); }

  RigInfo info() const override { return info_; }
  double theta_rad() const override { return theta_rad_; }
  double force_ref_N() const override { return force_N_; }
  std::string board_lane() const override { return bench_.board_adapter == "hid_board" ? "hid" : "serial"; }
  Dut* board_firmware() override { return this; }

  Result<void> begin(const RigRecordRequest& request) override {
    begun_ = false;
    const auto given = options_.find("today");
    if (const auto late = expired(bench_, given != options_.end() ? given->second : utc_today()); !late.empty())
      return fail(ErrorCode::config, fmt::format("calibration {} of the {} is out of date since {}", late[0].id, late[0].what,
                                                 late[0].expires),
                  bench_.path.string(), "calibrate it and enter the new id and date under [calibration]");
    FORCEGATE_CHECK_OK(look_at_rest(request));
    const RigGeometry& g = bench_.geometry;
    const double reach_N = kUsableTravel * g.spring_N_per_mm *
                           (g.preload_mm + g.eccentricity_mm * (1.0 - portable::cos(g.theta_max_rad)));
    if (request.force_high_N > std::min(reach_N, bench_.limits.force_max_N) + 1e-9)
      return fail(ErrorCode::config, fmt::format("the bench reaches {:.3g} N, the profile needs {:.3g} N",
                                                 std::min(reach_N, bench_.limits.force_max_N), request.force_high_N),
                  bench_.path.string(), "set a larger eccentricity on the wheel and in [geometry]");
    if (!session_) {
      FORCEGATE_TRY(session_, BenchSession::make(bench_, options_));
    }
    session_->close();  // every record begins with instruments that have just proved who they are
    FORCEGATE_CHECK_OK(safely(session_->world().mount(request)));
    FORCEGATE_CHECK_OK(safely(session_->open()));
    for (const auto& [key, value] : session_->details()) info_.details[key] = value;
    info_.reference_u_time_s = session_->reference().facts().u_time_s;
    FORCEGATE_TRY(const MotorState state, safely(session_->motor().read()));
    theta_rad_ = state.theta_rad;
    FORCEGATE_CHECK_OK(safely(go_to_start(request.force_low_N)));
    FORCEGATE_CHECK_OK(safely(session_->reference().start()));
    FORCEGATE_CHECK_OK(safely(start_stream()));
    if (!bench_.specimens.log.empty()) {
      FORCEGATE_CHECK_OK(safely(SpecimenLog(bench_.specimens.log).begin(request.specimen, utc_seconds(), request.duration_s)));
      logged_ = request.specimen;
    }
    turns_.begin(theta_rad_);
    return {};
  }

  Result<void> command_velocity(double rad_per_s) override {
    if (!begun_) return fail(ErrorCode::internal, "the bench got a command before a record began");
    FORCEGATE_CHECK_OK(safely(session_->arm()));
    commanded_rad_per_s_ = rad_per_s;
    return safely(session_->motor().command_velocity(rad_per_s));
  }

  Result<std::size_t> run(std::size_t n, RigBlock& out, std::size_t at) override {
    if (!begun_) return fail(ErrorCode::internal, "the bench was run before a record began");
    rows_.begin_block(at);
    const auto period = std::max<std::size_t>(1, static_cast<std::size_t>(kPeriod_s * info_.rate_Hz));
    for (std::size_t done = 0; done < n;) {
      const std::size_t chunk = std::min(n - done, period);
      FORCEGATE_CHECK_OK(safely(collect(chunk)));
      for (std::size_t i = 0; i < chunk; ++i)
        if (const auto sample = rows_.fill(out, at + done + i, commanded_rad_per_s_)) keep_answer(*sample);
      done += chunk;
      rows_.refine(out, at + done);
    }
    return n;
  }

  void park() noexcept override {
    begun_ = false;
    commanded_rad_per_s_ = 0.0;
    if (session_) {
      for (const auto& [key, value] : session_->details()) info_.details[key] = value;
      session_->make_safe();
    }
    if (logged_.empty()) return;
    (void)SpecimenLog(bench_.specimens.log).end(logged_, utc_seconds(), turns_.cycles());
    logged_.clear();
  }

  // The firmware on the board.
  Result<DutInfo> open(const DutSession& dut) override {
    if (!begun_) return fail(ErrorCode::internal, "the board's firmware was opened before a record began");
    FORCEGATE_CHECK_OK(session_->board().stop());
    FORCEGATE_CHECK_OK(session_->world().flash(dut.image.string()));
    FORCEGATE_TRY(const DutInfo info, with_fate(session_->board().load(dut)));
    if (!session_->world().flashes()) FORCEGATE_CHECK_OK(same_build(dut.image, info.build_id));
    FORCEGATE_CHECK_OK(start_stream());
    return info;
  }

  Result<void> process(std::uint32_t first_index, std::span<const std::uint16_t> adc, std::span<float> force_N,
                       std::span<std::uint8_t> flags) override {
    for (std::size_t i = 0; i < adc.size(); ++i) {
      if (outputs_.empty() || outputs_.front().index != first_index + i) return never_came(first_index + i);
      if (outputs_.front().adc != adc[i])
        return fail(ErrorCode::internal, "force and code of a sample do not belong together", "board");
      force_N[i] = outputs_.front().force_N;
      flags[i] = outputs_.front().flags;
      outputs_.pop_front();
    }
    return {};
  }

  Result<DutCounters> close() override { return session_ ? session_->board().counters() : DutCounters{}; }

 private:
  /// Whatever goes wrong, the motor is stopped before anybody hears of it.
  template <class T>
  T safely(T result) {
    if (!result) park();
    return result;
  }

  // A board that says nothing more: where this bench knows how the firmware on it fares, that tells whose silence it is.
  template <class T>
  Result<T> with_fate(Result<T> heard) {
    if (heard || heard.error().code != ErrorCode::timeout) return heard;
    const BenchWorld::FirmwareFate fate = session_->world().firmware_fate();
    if (!fate.known) return heard;  // as of a real board
    if (!fate.ended.empty()) return fail(ErrorCode::firmware, "the firmware " + fate.ended + "; " + heard.error().text, "board");
    return fail(ErrorCode::device, heard.error().text + ", although its firmware runs", heard.error().where, heard.error().hint);
  }

  Unexpected never_came(std::uint64_t sample) const {
    const DutCounters c = session_->board().counters();
    if (c.frames_bad + c.frames_dropped + c.overruns > 0)
      return fail(ErrorCode::device, fmt::format("the board's sample {} was lost on the link", sample), "board", "look for a disturbed or overloaded line between board and harness");
    return fail(ErrorCode::device, fmt::format("the board's sample {} never came, and no frame is counted as lost or damaged: firmware or link, it cannot be told", sample),
                "board", "look whether the firmware skips samples, and whether what reads the board counts its losses");
  }

  // The film is not what it was while it still remembers the record before.
  Result<void> look_at_rest(const RigRecordRequest& request) {
    info_.reference_u_rel = bench_.reference_u_rel;
    const BenchSpecimens& s = bench_.specimens;
    if (s.log.empty()) return {};
    const double needed_s = std::min(s.rest_s, request.rest_before_s);
    FORCEGATE_TRY(const auto rest_s, SpecimenLog(s.log).rest_s(request.specimen, utc_seconds()));
    info_.details["rest of " + request.specimen] = rest_s ? fmt::format("{:.2f} h", *rest_s / 3600.0) : "never used before";
    if (!rest_s || *rest_s >= needed_s) return {};
    if (!s.widen)
      return fail(ErrorCode::config, fmt::format("specimen {} has rested {:.2f} h of {:.2f} h", request.specimen, *rest_s / 3600.0, needed_s / 3600.0),
                  s.log.string(), "wait until " + utc_text(utc_seconds() + needed_s - *rest_s) + ", take another specimen, or set short_rest = \"widen\"");
    info_.reference_u_rel = std::hypot(bench_.reference_u_rel, s.short_rest_u_rel);
    info_.details["rest of " + request.specimen] += fmt::format(" of {:.2f} h: uncertainty widened by {} %", needed_s / 3600.0, shortest(100.0 * s.short_rest_u_rel));
    return {};
  }

  Result<void> start_stream() {
    FORCEGATE_CHECK_OK(session_->board().stop());
    FORCEGATE_CHECK_OK(session_->board().start());
    rows_.begin(session_->world().now_s(), theta_rad_);
    outputs_.clear();
    force_N_ = std::numeric_limits<double>::quiet_NaN();
    begun_ = true;
    return {};
  }

  // Slowly to the angle of the record's first force, watched like any other motion.
  Result<void> go_to_start(double force_N) {
    const RigGeometry& g = bench_.geometry;
    const double cosine = 1.0 - (force_N / g.spring_N_per_mm - g.preload_mm) / g.eccentricity_mm;
    const double goal = std::clamp(std::acos(std::clamp(cosine, -1.0, 1.0)), g.theta_min_rad, g.theta_max_rad);
    if (std::fabs(theta_rad_ - goal) <= kStartTolerance_rad) return {};
    FORCEGATE_TRY(const SlowMoveEnd end,
                  move_slowly(*session_, {goal, bench_.limits.start_velocity_rad_per_s, kStartTolerance_rad, nullptr}));
    theta_rad_ = end.to_rad;
    return session_->reference().stop();
  }

  // Lets time go on until the board's next `chunk` samples are there, and looks at everything meanwhile.
  Result<void> collect(std::size_t chunk) {
    BenchWorld& world = session_->world();
    const double due_s = rows_.due_s(chunk);
    FORCEGATE_CHECK_OK(world.advance_to(std::max(due_s, world.now_s())));
    session_->ticked(due_s);
    FORCEGATE_CHECK_OK(look());
    const double patience_s = world.now_s() + bench_.limits.board_stale_s;
    while (rows_.waiting() < chunk) {
      if (world.now_s() > patience_s)
        return with_fate(Result<void>(fail(
            ErrorCode::timeout, fmt::format("the board has been silent for {:.0f} ms at sample {}", 1e3 * bench_.limits.board_stale_s, rows_.index()),
            "board", "check power and cable of the sensor board, and that its firmware still runs")));
      FORCEGATE_CHECK_OK(world.advance_to(world.now_s() + 0.2 * kPeriod_s));
      FORCEGATE_CHECK_OK(look());
    }
    return {};
  }

  Result<void> look() {
    BenchWorld& world = session_->world();
    FORCEGATE_CHECK_OK(session_->beat());
    FORCEGATE_TRY(const MotorState state, session_->timed("reading the drive", [&] { return session_->motor().read(); }));
    theta_rad_ = state.theta_rad;
    turns_.see(theta_rad_);
    rows_.take(state);
    samples_.clear();
    FORCEGATE_CHECK_OK(session_->timed("polling the sensor board", [&] { return session_->board().poll(samples_); }));
    for (const BoardSample& s : samples_) FORCEGATE_CHECK_OK(rows_.take(s, world.now_s()));
    fresh_.clear();
    FORCEGATE_CHECK_OK(session_->timed(kCallOfReference, [&] { return session_->reference().poll(fresh_); }));
    rows_.take(fresh_);
    if (!fresh_.empty()) force_N_ = static_cast<double>(fresh_.back().force_N);
    return {};
  }

  // Of the firmware on the board, until it is asked what it made of this sample; a calibration asks for no forces.
  void keep_answer(const BoardSample& sample) {
    outputs_.push_back(sample);
    while (outputs_.size() > kOutputs) outputs_.pop_front();
  }

  // A board flashed by hand must not be judged for another build than the file; the image holds its build id as text (docs/protocol.md).
  Result<void> same_build(const std::filesystem::path& image, const std::string& build_id) const {
    FORCEGATE_TRY(const std::string bytes, read_file(image));
    if (bytes.find(build_id) != std::string::npos) return {};
    return fail(ErrorCode::device, "the board runs build " + build_id.substr(0, 12) + ", which is not in " + image.string(),
                "board", "flash this image, or name the program that does it under [board] flash");
  }

  static constexpr std::size_t kOutputs = 8192;
  BenchFile bench_;
  std::map<std::string, std::string> options_;
  RigInfo info_;
  std::unique_ptr<BenchSession> session_;
  bool begun_ = false;
  double theta_rad_ = 0.0, force_N_ = std::numeric_limits<double>::quiet_NaN(), commanded_rad_per_s_ = 0.0;
  RowAssembler rows_;
  std::deque<BoardSample> outputs_;
  std::vector<BoardSample> samples_;
  std::vector<ReferenceReading> fresh_;
  std::string logged_;  ///< specimen whose record is begun in the log
  SwingCounter turns_;
};

Result<std::unique_ptr<Rig>> make(const std::map<std::string, std::string>& options) {
  const auto file = options.find("file");
  if (file == options.end())
    return fail(ErrorCode::usage, "a bench needs its file", {}, "for example --rig rigs/twin.toml");
  static const std::vector<std::string> kKnown{"arm", "attach", "clock", "file", "purpose", "today"};
  for (const auto& [name, value] : options)
    if (std::find(kKnown.begin(), kKnown.end(), name) == kKnown.end()) {
      const std::string near = nearest_name(name, kKnown);
      return fail(ErrorCode::usage, "a bench has no option '" + printable_utf8(name) + "'", "--rig-option",
                  near.empty() ? "it has: " + join(kKnown, ", ") : "did you mean '" + near + "'?");
    }
  FORCEGATE_TRY(BenchFile bench, read_bench(file->second));
  FORCEGATE_CHECK_OK(check_devices(bench));
  return std::unique_ptr<Rig>(std::make_unique<BenchRig>(std::move(bench), options));
}

const Registration<RigKind> kRegistered{
    {"bench",
     "The instruments of a bench file, real or as twins. Options: file=BENCH.toml, attach=FOLDER (twins that are "
     "served), clock=virtual|paced, arm=yes (a real bench moves only then), "
     "today=DATE against which calibrations expire, purpose=TEXT shown to whoever else asks for the bench",
     make}};

}  // namespace
}  // namespace forcegate
