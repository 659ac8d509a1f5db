#include "hil/diagnose/choose/borne_out.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hil/diagnose/base/judge.h"
#include "hil/diagnose/between/foretold.h"

namespace forcegate::diagnose {

namespace {

// Every record predicted from all others, held-out ones too, and those that tell of each other beside `variant`. NaN where the columns cannot
// be fitted.
double left_out_of_all(const ResidualChannel& channel, int variant, const MixedFit& fit, const MixedFit& freedom) {
  const MixedFit of_all = fit_mixed(channel.problem, fit.columns, &fit, 12, RecordUse::all_records);
  if (!of_all.valid) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> square = leave_one_out(channel.problem, of_all, &freedom).adapted;
  set_unforetold_aside(channel, variant, JudgedBy::left_out, square);
  return channel.scale * std::sqrt(judged(channel, square, JudgedBy::left_out));
}

// Whether the records that `fit` was made from know any of the strengths.
bool knows_strength(const MixedFit& fit, const std::vector<int>& columns) {
  constexpr double kErrors = 2.0;
  return std::ranges::any_of(columns, [&](int column) { return std::abs(fit.strength_of(column)) > kErrors * fit.standard_error_of(column); });
}

// One record alone has the effect: the others, left out or not, know nothing of its strength, and no error moves. Blocks of that record are
// what was left out then.
bool only_blocks_tell(const CrossFit& left_out, const std::vector<double>& before, const std::vector<double>& after) {
  constexpr double kMoves = 0.005;  // of a mean square
  if (!left_out.blocks || left_out.improved < 2 || left_out.improved < left_out.excited || !left_out.helps()) return false;
  for (std::size_t i = 0; i < before.size(); ++i)
    if (std::abs(after[i] - before[i]) > kMoves * before[i]) return false;
  return true;
}

}  // namespace

void measure_left_out(const Workspace& w, const ResidualChannel& channel, Selection& selection, bool stands_in) {
  constexpr double kLeast = 0.88;  // an effect of half the spread of the records leaves this share of their error
  constexpr double kPlainly = 0.7, kHardly = 0.995, kAboutTheSame = 1.02, kPlainlyWorse = 1.2;
  const MixedFit* before = &selection.base;
  for (ChosenEffect& chosen : selection.chosen) {
    const auto squares = [&](const MixedFit& fit) {
      auto out = chosen.between ? judge_levels(channel, fit, selection.base, w.judges) : judge(channel, fit, selection.base, w.judges).adapted;
      set_unforetold_aside(channel, chosen.variant, w.judges, out);
      return out;
    };
    const auto error = [&](const std::vector<double>& square) { return channel.scale * std::sqrt(judged(channel, square, w.judges)); };
    const std::vector<double> squares_before = squares(*before), squares_after = squares(chosen.fit);
    chosen.error_before = error(squares_before);
    chosen.error_after = error(squares_after);
    // what is seen in few held-out records may leave their mean as it was; between records, and where every record is left out in turn, the
    // mean itself is the evidence
    // of one recording every part is asked, and what it has shows in their error
    const bool mean_tells = w.judges == JudgedBy::left_out && !only_blocks_tell(chosen.left_out, squares_before, squares_after);
    const double in_records = w.input.single ? kHardly : mean_tells ? 1.0 : kAboutTheSame;
    const double keeps = chosen.between && !chosen.by_records() ? kLeast : stands_in ? kHardly : in_records;
    chosen.borne_out = chosen.describes_whole || chosen.error_after <= keeps * chosen.error_before;
    // seen in held-out records alone: the fit records know nothing of it, and predict nothing
    if (!chosen.between && w.judges == JudgedBy::heldout && chosen.error_after > kHardly * chosen.error_before)
      chosen.borne_out = chosen.borne_out && knows_strength(chosen.fit, chosen.columns);
    // a handful of fit records does not reach to the held-out ones: each record is asked from all others
    const bool by_levels = chosen.by_records() || chosen.records.same_strength;
    if (!chosen.borne_out && (by_levels || !chosen.between)) {
      const MixedFit freedom = chosen.between ? without_levels(channel, selection.base) : selection.base;
      const double all_before = left_out_of_all(channel, chosen.variant, *before, freedom), all_after = left_out_of_all(channel, chosen.variant, chosen.fit, freedom);
      // where the held-out ones get plainly worse by it, whoever takes it in gets a worse model
      const bool worse = chosen.error_after > kPlainlyWorse * chosen.error_before;
      const bool told = !worse && by_levels && chosen.records.left_out <= kPlainly * kPlainly && all_after < all_before;
      if (told || all_after <= kPlainly * all_before) {
        chosen.error_before = all_before;
        chosen.error_after = all_after;
        chosen.of_every_record = true;
        chosen.borne_out = true;
      }
    }
    if (chosen.borne_out) before = &chosen.fit;
  }
}

std::vector<Finding> not_borne_out(const ResidualChannel& channel, const Selection& selection) {
  std::vector<Finding> out;
  for (const ChosenEffect& chosen : selection.chosen) {
    if (chosen.borne_out) continue;
    Finding f = finding_about(*chosen.kind, channel);
    f.between_records = chosen.between;
    f.probability = chosen.share_of_family;
    f.evidence = chosen.kind->summary;
    f.limit(kNoClaim, kDoesNotFall);
    out.push_back(std::move(f));
  }
  return out;
}

}  // namespace forcegate::diagnose
