// Errors and floor that stand in one sentence are compared there.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hil/report/diagnosis_html.h"
#include "tests/support/sample_diagnosis.h"

namespace forcegate {
namespace {

using testing::HasSubstr;

TEST(DiagnosisPage, one_sentence_has_one_unit) {
  Diagnosis d = sample::diagnosis();
  d.error_before = d.error_after = 0.449;
  d.floor = 0.144;
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("Held-out error 449 mV; noise floor 144 mV"));
  d.floor = 0.0006;
  d.error_after = 0.3;
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("Held-out error 449 mV falls to 300 mV"));
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("noise floor 0.6 mV"));
  d.floor = 1e-7;
  EXPECT_THAT(diagnosis_html(d, {}), HasSubstr("Held-out error 0.449 V falls to 0.3 V"));
}

}  // namespace
}  // namespace forcegate
