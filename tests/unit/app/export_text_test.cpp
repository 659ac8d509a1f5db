// What the check of an exported header says to people.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/app/export/export.h"

namespace forcegate {
namespace {

using testing::HasSubstr;

TEST(ExportText, SaysWhatEveryNumberOfAReplayedRecordIs) {
  for (const bool bare : {true, false}) {
    ExportResult r;
    if (!bare) r.compensator.effects = {"creep"};
    r.check.emplace();
    r.check->lsb_N = 0.01;
    ReplayedRecord record;
    record.record = "r05", record.seconds = 200.0, record.largest_N = 0.02, record.plain_rms_N = record.compensated_rms_N = 0.18;
    r.check->records = {record};
    const std::string text = export_text(r);
    EXPECT_THAT(text, HasSubstr("against recorded force and the largest difference from the model's own inverse, RMS in mN (the law alone"));
    EXPECT_THAT(text, HasSubstr(bare ? " s    180.0, difference 2 LSB" : " s    180.0 -> 180.0, difference 2 LSB"));
  }
}

}  // namespace
}  // namespace forcegate
