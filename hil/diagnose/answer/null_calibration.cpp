#include "hil/diagnose/answer/null_calibration.h"

#include <algorithm>
#include <cmath>

#include "hil/base/parallel.h"
#include "hil/base/rng.h"
#include "hil/diagnose/between/between_records.h"

namespace forcegate::diagnose {

namespace {

constexpr int kFlipIterations = 4;

// The channel without its rows: a screen needs the Gram matrices alone.
ResidualChannel gram_only(const ResidualChannel& channel) {
  ResidualChannel out;
  static_cast<ChannelFacts&>(out) = channel;
  out.problem = channel.problem;
  return out;
}

std::vector<int> draw_signs(Rng& rng, std::size_t n) {
  std::vector<int> out(n, 1);
  for (;;) {
    int turned = 0;
    for (int& s : out) {
      s = rng.below(2) == 0 ? -1 : 1;
      turned += s < 0 ? 1 : 0;
    }
    // all or none is the recording itself
    if (n < 2 || (turned > 0 && turned < static_cast<int>(n))) return out;
  }
}

}  // namespace

NullCalibration calibrate_null(const CampaignInput& input, const ResidualChannel& channel, const MixedFit& final,
                               const std::vector<std::string>& skip,
                               const SelectionRules& rules, int flips, unsigned threads) {
  NullCalibration out;
  if (!final.valid || channel.problem.records.size() < 3) return out;
  ResidualChannel turned = gram_only(channel);
  Rng rng(1, "sign flips");
  for (int flip = 0; flip < flips; ++flip) {
    flip_residuals(turned.problem, final, draw_signs(rng, channel.problem.records.size()));
    ScreenResult result = screen(turned, final.columns, skip, &final, threads, kFlipIterations);
    judge_between_records(input, turned, final.columns, rules, result);
    for (const FamilyScore& family : result.families) {
      double& largest = out.score.try_emplace(family.kind->name, -1e300).first->second;
      largest = std::max(largest, family.gain);
      if (!family.best.wrong_sign && family.gain >= threshold_of(family.kind->name, rules)) out.expected_false += 1.0;
    }
    ++out.flips;
  }
  if (out.flips > 0) out.expected_false /= out.flips;
  return out;
}

}  // namespace forcegate::diagnose
