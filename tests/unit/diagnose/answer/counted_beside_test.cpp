// Records that an effect helps: two that hide each other help fewer of them in the order in which they entered.

#include "hil/diagnose/answer/findings.h"
#include "tests/unit/diagnose/chosen_by_hand.h"

namespace forcegate::diagnose {
namespace {

class CountedBeside : public ChosenByHand {
 protected:
  // Of the loop, which had helped `improved` of 8 when it entered.
  Finding loop_that_entered_with(int improved) {
    selection_.chosen = {taken("lag", 1.0, ""), taken("hysteresis", 1.0, "")};
    std::vector<int> columns = selection_.base.columns;
    for (const ChosenEffect& c : selection_.chosen) add_columns(columns, columns_of(w_->output, c));
    selection_.claimed = selection_.final = fit_mixed(w_->output.problem, columns, &selection_.base, 20, RecordUse::all_records);
    for (ChosenEffect& c : selection_.chosen) c.fit = selection_.claimed;
    CrossFit& entered = selection_.chosen[1].left_out;
    entered = {};
    entered.excited = 8;
    entered.improved = improved;
    Diagnosis out;
    add_findings(*w_, w_->output, selection_, 1.0, out);
    const auto found = std::ranges::find(out.findings, std::string("hysteresis"), &Finding::effect);
    return found == out.findings.end() ? Finding{} : *found;
  }
};

TEST_F(CountedBeside, TheOtherWhereItHelpedFew) {
  const Finding f = loop_that_entered_with(3);
  EXPECT_EQ(f.effect, "hysteresis");
  EXPECT_GT(f.records_excited, 2);
  EXPECT_EQ(f.records_improved, f.records_excited);
  EXPECT_NE(f.evidence.find(std::to_string(f.records_improved) + " of " + std::to_string(f.records_excited) + " "), std::string::npos) << f.evidence;
}

TEST_F(CountedBeside, AsItEnteredWhereItHelpedAll) {
  const Finding f = loop_that_entered_with(8);
  EXPECT_EQ(f.records_improved, 8);
  EXPECT_EQ(f.records_excited, 8);
}

}  // namespace
}  // namespace forcegate::diagnose
