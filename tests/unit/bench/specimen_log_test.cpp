#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "adapters/transport/private_folder.h"
#include "hil/base/utc_clock.h"
#include "hil/rig/specimen_log.h"
#include "tests/support/twin_bench.h"

namespace forcegate {
namespace {

class SpecimenLogTest : public testing::Test {
 protected:
  SpecimenLogTest()
      : folder_(std::move(*PrivateFolder::make())), file_(folder_.path() / "specimens.tsv"), log_(file_) {}
  void write(const std::string& text) { std::ofstream(file_, std::ios::app) << text; }
  PrivateFolder folder_;
  std::filesystem::path file_;
  SpecimenLog log_;
};

TEST_F(SpecimenLogTest, TellsRestRecordsAndCycles) {
  EXPECT_FALSE(log_.rest_s("q50", 1000.0).value().has_value());
  ASSERT_TRUE(log_.begin("q50", 1000.0, 600.0));
  EXPECT_EQ(log_.rest_s("q50", 5000.0).value(), 3400.0);  // no end yet: the planned one
  ASSERT_TRUE(log_.end("q50", 1200.0, 97));
  ASSERT_TRUE(log_.begin("q10", 2000.0, 60.0));
  ASSERT_TRUE(log_.end("q10", 2060.0, 30));
  ASSERT_TRUE(log_.begin("q50", 9000.0, 600.0));
  ASSERT_TRUE(log_.end("q50", 9600.0, 300));
  const auto all = log_.read().value();
  EXPECT_EQ(all.at("q50").records, 2U);
  EXPECT_EQ(all.at("q50").cycles, 397U);
  EXPECT_EQ(log_.rest_s("q50", 9700.0).value(), 100.0);
  EXPECT_EQ(log_.rest_s("q50", 9000.0).value(), 0.0);  // a clock set back
  EXPECT_EQ(log_.rest_s("q10", 9700.0).value(), 7640.0);
}

TEST_F(SpecimenLogTest, ALineCutByACrashIsPassedOverAndSpoilsNothingBehindIt) {
  ASSERT_TRUE(log_.begin("q50", 1000.0, 600.0));
  write("2026-11-21T13:0");
  EXPECT_EQ(log_.read().value().at("q50").records, 1U);
  ASSERT_TRUE(log_.end("q50", 1600.0, 5));
  const auto all = log_.read();
  ASSERT_FALSE(all);  // the torn line is a line now, and nobody knows what it said
  EXPECT_NE(all.error().where.find(":3"), std::string::npos) << all.error().to_text();
}

TEST_F(SpecimenLogTest, ALineThatIsNoneIsNamed) {
  write("2026-11-21T13:00:00Z\tused\tq50\t5\n");
  const auto all = log_.read();
  ASSERT_FALSE(all);
  EXPECT_EQ(all.error().code, ErrorCode::parse);
  EXPECT_NE(all.error().where.find(":1"), std::string::npos);
}

class RestedSpecimen : public SpecimenLogTest {
 protected:
  std::unique_ptr<Rig> rig(const std::string& more) {
    const auto bench = folder_.path() / "bench.toml";
    std::ofstream(bench) << test::bench_text("twin.toml") << "\n[specimens]\nlog = \"specimens.tsv\"\n"
                         << more;
    auto made = Registry<RigKind>::instance().find("bench")->make({{"file", bench.string()}});
    EXPECT_TRUE(made) << made.error().to_text();
    return std::move(*made);
  }
  static void begins(Rig& bench, const RigRecordRequest& request) {
    const auto begun = bench.begin(request);
    EXPECT_TRUE(begun) << begun.error().to_text();
  }
  static RigRecordRequest request() {
    RigRecordRequest q = test::request_of_a_second();
    q.rest_before_s = 7200.0;
    return q;
  }
};

TEST_F(RestedSpecimen, IsRefusedUntilItHasRested) {
  const auto bench = rig("");
  begins(*bench, request());  // never used before
  bench->park();
  const auto again = bench->begin(request());
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().code, ErrorCode::config);
  EXPECT_NE(again.error().text.find("of 2.00 h"), std::string::npos) << again.error().to_text();
  RigRecordRequest other = request();
  other.specimen = "q10";
  begins(*bench, other);
  bench->park();
  RigRecordRequest patient = request();
  patient.rest_before_s = 0.0;  // a plan that asks for none
  begins(*bench, patient);
  bench->park();
  EXPECT_EQ(log_.read().value().at("q50").records, 2U);
}

TEST_F(RestedSpecimen, OrItsUncertaintyIsWidened) {
  const auto bench = rig("short_rest = \"widen\"\nshort_rest_u_rel = 0.02\n");
  begins(*bench, request());
  EXPECT_DOUBLE_EQ(bench->info().reference_u_rel, 0.005);
  bench->park();
  begins(*bench, request());
  EXPECT_DOUBLE_EQ(bench->info().reference_u_rel, std::hypot(0.005, 0.02));
  EXPECT_NE(bench->info().details.at("rest of q50").find("widened by 2 %"), std::string::npos);
  bench->park();
}

}  // namespace
}  // namespace forcegate
