// What the pieces of a next experiment excite.

#include "hil/diagnose/next/segments.h"

#include <gtest/gtest.h>

namespace forcegate::diagnose {
namespace {

double largest(const CampaignInput& campaign, const RecordInput& record, const EffectForm& form, const std::vector<double>& shape) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(record.rows()), static_cast<Eigen::Index>(form.strength.size()));
  form.columns(campaign, record, shape, columns);
  return columns.cwiseAbs().maxCoeff();
}

TEST(Segments, AJumpOfTheFrequencyMayBump) {
  Workspace w;
  w.input.range_N = 4.0;
  w.input.records.emplace_back();
  const EffectKind& bump = *EffectRegistry::instance().find("frequency_bump");
  double most = 0.0;
  for (const Segment& s : segments()) {
    const RecordInput played = simulate(w, s);
    for (const EffectForm& form : bump.forms)
      for (const std::vector<double>& shape : form.grid(w.input)) most = std::max(most, largest(w.input, played, form, shape));
  }
  EXPECT_GT(most, 0.1);
}

TEST(Segments, TellTheForceThatTheyTouch) {
  Workspace w;
  w.input.range_N = 40.0;
  w.input.records.emplace_back();
  for (const Segment& s : segments()) {
    const RecordInput played = simulate(w, s);
    const auto numbers = numbers_of(s, played);
    if (!numbers.contains("F_top_N")) continue;
    EXPECT_NEAR(numbers.at("F_top_N"), 0.12 * 0.95 * 40.0, 0.01);
    return;
  }
  ADD_FAILURE() << "no segment touches";
}

}  // namespace
}  // namespace forcegate::diagnose
