#pragma once

#include <memory>

#include "hil/diagnose/choose/select.h"
#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {

// A lag of 30 ms, and a play of 0.4 N beside it.
inline std::vector<double> late_with_a_loop(const std::vector<double>& t, const std::vector<double>& F, int) {
  std::vector<double> U;
  double slow = F[0], play = 0.0;
  for (std::size_t i = 0; i < F.size(); ++i) {
    slow += (F[i] - slow) * -std::expm1(-(i == 0 ? 0.0 : t[i] - t[i - 1]) / 0.03);
    play = std::min(std::max(play, F[i] - 0.4), F[i] + 0.4);
    U.push_back(2.0 * slow + 0.15 * play + 0.2);
  }
  return U;
}

class ChosenByHand : public ::testing::Test {
 protected:
  void SetUp() override {
    options_.threads = 1;
    auto made = prepare(make_campaign(71, late_with_a_loop), options_);
    ASSERT_TRUE(made.has_value()) << made.error().to_text();
    w_ = std::move(*made);
    selection_.first = screen(w_->output, {}, {}, nullptr, 1);
    selection_.base = selection_.final = selection_.first.base;
  }

  // As if the forward choice had taken it at a time when it stood beside nothing.
  ChosenEffect taken(const std::string& name, double share, const std::string& rival) const {
    for (const FamilyScore& family : selection_.first.families)
      if (family.kind->name == name) {
        ChosenEffect out = as_chosen(w_->input, w_->output, selection_.first.base, family, rules_);
        out.share_of_family = share;
        if (!rival.empty()) out.rivals = {{rival, 1.0 - share}};
        return out;
      }
    ADD_FAILURE() << name << " is no candidate";
    return {};
  }

  EngineOptions options_;
  SelectionRules rules_;
  std::unique_ptr<Workspace> w_;
  Selection selection_;
};

}  // namespace forcegate::diagnose
