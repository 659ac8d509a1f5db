#include "hil/app/gate/repeats.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/base/plain_number.h"

namespace forcegate {
namespace {

bool lost_anything(const DutCounters& c) { return c.frames_dropped + c.frames_bad + c.indices_lost + c.overruns + c.naks > 0; }

// Largest distance of the firmware's extrema, where both plays have the same ones; else 0.
double farthest_N(const CaseRecord& first, const CaseRecord& again) {
  if (first.pairs.size() != again.pairs.size()) return 0.0;
  double out = 0.0;
  for (std::size_t i = 0; i < first.pairs.size(); ++i)
    if (const double d = std::fabs(first.pairs[i].dut_N - again.pairs[i].dut_N); d > out) out = d;
  return out;
}

}  // namespace

SecondPlay compare_plays(const CaseRecord& first, const CaseRecord& again) {
  using Is = SecondPlay::Is;
  if (again.failure) {
    const CaseFailure& f = *again.failure;
    if (f.error.code == ErrorCode::cancelled || f.stage == CaseFailure::Stage::setup) return {Is::cancelled, {}};
    const bool own = f.stage == CaseFailure::Stage::firmware && f.error.code == ErrorCode::firmware;
    return {own ? Is::other_by_firmware : Is::other, fmt::format("{} was recorded, and cannot be played again: {}", first.id, f.error.text)};
  }
  if (first.digest == again.digest) return {};
  const bool own = first.rig.name == "emulated" && !lost_anything(first.link) && !lost_anything(again.link);
  const double apart_N = farthest_N(first, again);
  return {own ? Is::other_by_firmware : Is::other,
          fmt::format("{}: played again from the same seed {}{}", first.id, own ? "the firmware gives other forces" : "it gives other samples",
                      apart_N > 0.0 ? fmt::format(", extrema up to {:.2g} N apart", apart_N) : std::string())};
}

std::optional<JudgedCheck> repeats_check(std::span<const std::string> found) {
  if (found.empty()) return std::nullopt;
  JudgedCheck j;
  j.judgeable = false;
  Check& c = j.check;
  c.id = kRepeats;
  c.title = "Records that the firmware does not repeat when they are played again";
  c.value = static_cast<double>(found.size());
  c.unit = "1";
  c.n = found.size();
  c.limit = {Limit::Kind::upper, 0.0, "ours: same image, same codes, same forces"};
  c.verdict = Verdict::fail;
  c.blame = Blame::firmware;
  c.evidence = found.front() + (found.size() > 1 ? ", and " + counted(found.size() - 1, "more record") : std::string());
  return j;
}

}  // namespace forcegate
