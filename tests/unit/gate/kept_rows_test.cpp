// What rig and firmware had said when a block failed is recorded.

#include <gtest/gtest.h>

#include "tests/unit/gate/runner_bench.h"

namespace forcegate::testing {
namespace {

class RowCounter final : public RecordWriter {
 public:
  std::size_t rows = 0;
  double last_t_s = -1.0;
  bool in_order = true, finished = false;
  Result<void> begin(const CaseJob&, const CaseRecord&) override { return {}; }
  Result<void> push(const RigBlock& block, std::span<const float> dut_N, std::span<const std::uint8_t>, const float*,
                    std::size_t from, std::size_t n) override {
    for (std::size_t i = from; i < from + n; ++i) {
      in_order = in_order && block.t_s[i] > last_t_s && std::isfinite(dut_N[i]);
      last_t_s = block.t_s[i];
    }
    rows += n;
    return {};
  }
  Result<void> finish() override {
    finished = true;
    return {};
  }
};

class BreakingRig final : public FakeRig {
 public:
  double breaks_at_s = 0.0;
  Result<std::size_t> run(std::size_t n, RigBlock& out, std::size_t at) override {
    FORCEGATE_TRY(const std::size_t rows, FakeRig::run(n, out, at));
    if (out.t_s[at] >= breaks_at_s) return fail(ErrorCode::device, "the cable came off", "board", "plug it in");
    return rows;
  }
};

TEST(KeptRows, a_rig_that_breaks_in_a_block_loses_none_of_the_rows_before) {
  Bench s;
  s.close_loop();
  BreakingRig rig;
  rig.breaks_at_s = 7.5;  // blocks last 4.09 s
  RowCounter writer;
  RunDevices devices;
  devices.rig = &rig;
  devices.dut = &s.dut;
  devices.writer = &writer;
  const CaseRecord record = run_case(s.job, devices);
  ASSERT_TRUE(record.failure);
  EXPECT_EQ(record.failure->error.text, "the cable came off");
  EXPECT_EQ(writer.rows, 7500U);
  EXPECT_NEAR(writer.last_t_s, 7.499, 1e-9);
  EXPECT_TRUE(writer.in_order);
  EXPECT_TRUE(writer.finished);
}

}  // namespace
}  // namespace forcegate::testing
