#include "hil/gate/board_faults.h"

#include <algorithm>
#include <limits>

#include "hil/base/rng.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

constexpr std::size_t kFrame = 10;  // samples
constexpr double kNever = std::numeric_limits<double>::infinity();

const BoardFaultKind* find(const std::string& name) {
  for (const BoardFaultKind& kind : board_fault_kinds())
    if (kind.name == name) return &kind;
  return nullptr;
}

class FaultyBoard final : public Dut {
 public:
  FaultyBoard(std::unique_ptr<Dut> inner, const std::map<std::string, double>& faults, std::uint64_t seed)
      : inner_(std::move(inner)), faults_(faults), rng_(seed, "board_faults") {}

  Result<DutInfo> open(const DutSession& session) override {
    rate_Hz_ = session.rate_Hz;
    spoiled_ = {};
    last_ = 0.0F;
    late_.assign(static_cast<std::size_t>(magnitude("link_late", 0.0) * rate_Hz_), 0.0F);
    return inner_->open(session);
  }

  Result<void> process(std::uint32_t first_index, std::span<const std::uint16_t> adc,
                       std::span<float> force_N, std::span<std::uint8_t> flags) override {
    const double end_s = (static_cast<double>(first_index) + static_cast<double>(adc.size())) / rate_Hz_;
    if (const double at_s = magnitude("board_dead", kNever); end_s > at_s)
      return fail(ErrorCode::timeout, "the board gives no answer since " + shortest(at_s) + " s", "board",
                  "look at power, cable and connector");
    if (const double at_s = magnitude("board_reset", kNever); end_s > at_s)
      return fail(ErrorCode::device,
                  "the board restarted at " + shortest(at_s) + " s: it greets again, cause of reset: supply",
                  "board", "look at its supply");
    FORCEGATE_CHECK_OK(inner_->process(first_index, adc, force_N, flags));
    for (std::size_t at = 0; at < adc.size(); at += kFrame) {
      const std::size_t n = std::min(kFrame, adc.size() - at);
      const bool lost = hit("link_loss"), bad = hit("link_corrupt"), stale = hit("board_stale");
      if (lost) spoiled_.frames_dropped += 1, spoiled_.indices_lost += n;
      if (bad) spoiled_.frames_bad += 1, spoiled_.indices_lost += n;
      if (stale) spoiled_.indices_lost += n;  // a first index that was seen before
      for (std::size_t i = at; i < at + n; ++i) {
        if (lost || bad || stale)
          force_N[i] = last_;
        else
          last_ = force_N[i];
        if (late_.empty()) continue;
        std::swap(force_N[i], late_[late_at_]);
        late_at_ = (late_at_ + 1) % late_.size();
        spoiled_.overruns += i == at;  // answers carry an index that should have come long ago
      }
    }
    return {};
  }

  Result<DutInfo> restart(const DutSession& session) override {
    last_ = 0.0F;
    std::fill(late_.begin(), late_.end(), 0.0F);
    return inner_->restart(session);
  }

  Result<DutCounters> close() override {
    FORCEGATE_TRY(DutCounters counters, inner_->close());
    counters.frames_dropped += spoiled_.frames_dropped;
    counters.frames_bad += spoiled_.frames_bad;
    counters.indices_lost += spoiled_.indices_lost;
    counters.overruns += spoiled_.overruns;
    return counters;
  }

 private:
  double magnitude(const char* name, double none) const {
    const auto at = faults_.find(name);
    return at == faults_.end() ? none : at->second;
  }
  bool hit(const char* name) {
    const double share = magnitude(name, 0.0);
    return share > 0.0 && rng_.uniform() < share;
  }

  std::unique_ptr<Dut> inner_;
  std::map<std::string, double> faults_;
  Rng rng_;
  double rate_Hz_ = 1000.0;
  float last_ = 0.0F;
  std::vector<float> late_;
  std::size_t late_at_ = 0;
  DutCounters spoiled_;
};

}  // namespace

const std::vector<BoardFaultKind>& board_fault_kinds() {
  static const std::vector<BoardFaultKind> kinds{
      {"board_dead", "instant from which the board is silent, s", 0, 1e9, kNever},
      {"board_reset", "instant at which the board restarts, s", 0, 1e9, kNever},
      {"board_stale", "share of answers that repeat the one before", 0, 1, 0},
      {"link_corrupt", "share of answers that arrive damaged", 0, 1, 0},
      {"link_late", "delay of the answers, s", 0, 10, 0},
      {"link_loss", "share of answers that never arrive", 0, 1, 0},
  };
  return kinds;
}

std::map<std::string, double> rig_faults(const std::map<std::string, double>& faults) {
  std::map<std::string, double> of_rig;
  for (const auto& [name, magnitude] : faults)
    if (find(name) == nullptr) of_rig[name] = magnitude;
  return of_rig;
}

Result<void> check_board_faults(const std::map<std::string, double>& faults) {
  for (const auto& [name, magnitude] : faults) {
    const BoardFaultKind* kind = find(name);
    if (kind == nullptr) continue;
    if (!(magnitude >= kind->minimum && magnitude <= kind->maximum))
      return fail(
          ErrorCode::config, "fault " + name + " = " + shortest(magnitude) + " is out of range", {},
          "it is the " + kind->doc + ", from " + shortest(kind->minimum) + " to " + shortest(kind->maximum));
    if (magnitude == kind->none)
      return fail(ErrorCode::config, "fault " + name + " = " + shortest(magnitude) + " changes nothing: the board would be sound", {},
                  "it is the " + kind->doc + "; give another magnitude, or leave the fault out");
  }
  return {};
}

std::unique_ptr<Dut> with_board_faults(std::unique_ptr<Dut> dut, const std::map<std::string, double>& faults,
                                       std::uint64_t seed) {
  const bool any =
      std::any_of(faults.begin(), faults.end(), [](const auto& f) { return find(f.first) != nullptr; });
  if (!any) return dut;
  return std::make_unique<FaultyBoard>(std::move(dut), faults, seed);
}

}  // namespace forcegate
