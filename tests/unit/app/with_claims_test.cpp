// One error of the law and of what is claimed, whichever verb tells it.

#include "hil/app/diagnose/with_claims.h"

#include <gtest/gtest.h>

#include "hil/app/model/model_input.h"
#include "tests/unit/diagnose/creeping_campaign.h"

namespace forcegate {
namespace {

TEST(WithClaims, PlainErrorsAreThoseOfCompareAndAdd) {
  const Model model = *library_model("flexiforce");
  diagnose::EngineOptions options = engine_options(model, 1);
  options.pictures = false;
  auto found = diagnose::diagnose_campaign_in(diagnose::creeping(1), options);
  ASSERT_TRUE(found) << found.error().to_text();
  ASSERT_FALSE(found->diagnosis.findings.empty());
  ASSERT_EQ(found->diagnosis.findings.front().effect, "creep");
  ASSERT_TRUE(is_plain_refitted(*found->workspace, found->diagnosis));
  tell_plain_as_refitted(*found->workspace, options, with_claims(*found->workspace, model, found->diagnosis, 1), found->diagnosis);

  diagnose::EngineOptions only = options;
  only.search = false;
  const auto w = diagnose::prepare(diagnose::creeping(1), only);
  ASSERT_TRUE(w) << w.error().to_text();
  const auto compared = diagnose::compare_workspace(**w, only);
  const auto added = diagnose::refit_campaign(diagnose::creeping(1), options, model, "creep");
  ASSERT_TRUE(compared && added);
  const Diagnosis& d = found->diagnosis;
  EXPECT_NEAR(d.plain_before, compared->plain_before, 0.02 * compared->plain_before);
  EXPECT_NEAR(d.plain_before, added->plain_before, 0.02 * added->plain_before);
  EXPECT_NEAR(d.plain_after, added->plain_after, 0.1 * added->plain_after);
  for (std::size_t k = 0; k < d.records.size(); ++k) EXPECT_NEAR(d.records[k].plain_before, compared->records[k].plain_before, 0.02 * compared->plain_before);
}

}  // namespace
}  // namespace forcegate
