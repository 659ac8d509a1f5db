#include "hil/diagnose/answer/unresolved_edges.h"

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

// One record of 1000 rows with an edge every `period` rows; the residual is 1 around the edges and 0 elsewhere.
struct OneRecord {
  CampaignInput input;
  ResidualChannel channel;
  std::vector<std::vector<double>> residual;
};

OneRecord with_edges(std::size_t period, std::size_t samples_of_a_row) {
  OneRecord out;
  RecordInput r;
  ResidualChannel& channel = out.channel;
  RecordRows rows;
  out.residual = {std::vector<double>(1000, 0.0)};
  for (std::size_t i = 0; i < 1000; ++i) {
    r.t_s.push_back(0.02 * static_cast<double>(i));
    r.F_N.push_back(i / period % 2 == 0 ? 1.0 : 3.0);
    rows.row.push_back(i);
    if (i % period < 2 && i >= period) out.residual[0][i] = 1.0;
  }
  r.fast_t_s.assign(1000 * samples_of_a_row, 0.0);
  out.input.range_N = 4.0;
  out.input.records.push_back(std::move(r));
  channel.rows.push_back(std::move(rows));
  channel.record_of = {0};
  return out;
}

std::vector<std::vector<double>> resolved(const OneRecord& one) {
  return without_unresolved_edges(one.input, one.channel, one.residual);
}

double largest(const OneRecord& one) {
  const auto residual = resolved(one);
  return *std::max_element(residual.front().begin(), residual.front().end());
}

TEST(UnresolvedEdges, AreLeftOutWhereARowIsOneSample) {
  const OneRecord one = with_edges(100, 1);
  EXPECT_EQ(largest(one), 0.0);
  EXPECT_GT(resolved(one).front().size(), 900u);
}

TEST(UnresolvedEdges, AreKeptWhereSamplesResolveThem) { EXPECT_EQ(largest(with_edges(100, 10)), 1.0); }

TEST(UnresolvedEdges, AForceThatRunsAllTheTimeHasNone) {
  const OneRecord one = with_edges(4, 1);
  EXPECT_EQ(resolved(one).front().size(), 1000u);
}

}  // namespace
}  // namespace forcegate::diagnose
