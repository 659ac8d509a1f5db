#include "hil/diagnose/candidates/signatures.h"

#include <gtest/gtest.h>

#include "hil/model/effect.h"
#include "tests/unit/diagnose/made_channel.h"

namespace forcegate::diagnose {
namespace {

// Rows of [gain, offset, one column of S, y].
ResidualChannel with_one_column() {
  ResidualChannel channel = channel_of_lines(1, 0.03);
  for (const double at : {0.2, 0.7}) {
    Eigen::MatrixXd rows(3, 4);
    rows << 1.0, 1.0, at, 0.4, 2.0, 1.0, 0.5, at, 3.0, 1.0, 0.1, 0.9;
    add_record(channel, rows, 3.0, 1e-6, 1e-6);
  }
  channel.first_spare = 1;
  return channel;
}

TEST(SpareColumns, AreThereHoweverManyAreTaken) {
  ResidualChannel channel = with_one_column();
  const ResidualChannel before = channel;
  EffectKind kind;
  kind.name = "made";
  for (int taken = 0; taken < 60; taken += 3) {
    EXPECT_EQ(place_candidate(channel, {&kind, nullptr, {}, 0, 3}), taken / 3);
    EXPECT_EQ(channel.candidates.back().first, 1 + taken);
    EXPECT_LE(channel.first_spare, channel.problem.ns);
  }
  const MixedProblem& p = channel.problem;
  EXPECT_EQ(p.column_prior_sd.size(), p.ns);
  EXPECT_EQ(p.column_prior_sd[0], 0.03);
  for (std::size_t k = 0; k < before.rows.size(); ++k) {
    const Eigen::MatrixXd &was = before.rows[k].matrix, &is = channel.rows[k].matrix, &gram = p.records[k].gram;
    ASSERT_EQ(is.cols(), p.nz + p.ns + 1);
    EXPECT_EQ(is.leftCols(3), was.leftCols(3));
    EXPECT_EQ(is.rightCols(1), was.rightCols(1)) << "y stays the last";
    EXPECT_TRUE(is.middleCols(3, p.ns - 1).isZero(0.0));
    ASSERT_EQ(gram.cols(), is.cols());
    EXPECT_TRUE(gram.isApprox(is.transpose() * is / 3.0, 1e-14));
  }
}

TEST(SpareColumns, OfACandidateThatIsWiderThanWhatIsAddedAtATime) {
  ResidualChannel channel = with_one_column();
  EffectKind kind;
  kind.name = "made";
  place_candidate(channel, {&kind, nullptr, {}, 0, 100});
  EXPECT_GE(channel.problem.ns, 101);
  EXPECT_EQ(channel.rows.front().matrix.cols(), channel.problem.nz + channel.problem.ns + 1);
}

}  // namespace
}  // namespace forcegate::diagnose
