#include "hil/diagnose/between/foretold.h"

#include <gtest/gtest.h>

#include <string>

namespace forcegate::diagnose {
namespace {

// Five records: two of a first mounting, one of a second, two of a third, each with a column of its own; `form` of the effect.
ResidualChannel of_mountings(const std::string& effect, const std::string& form) {
  constexpr int kMounting[] = {0, 0, 1, 2, 2};
  ResidualChannel out;
  out.problem.nz = 1;
  out.problem.ns = 2;
  for (const int mounting : kMounting) {
    RecordGram& r = out.problem.records.emplace_back();
    r.gram = Eigen::MatrixXd::Zero(4, 4);
    r.gram(0, 0) = 1.0;
    if (mounting > 0) r.gram(mounting, mounting) = 1.0;
  }
  const EffectKind* kind = EffectRegistry::instance().find(effect);
  out.candidates.push_back({kind, find_form(*kind, form), {}, 0, 2});
  out.variants.push_back({0, {0, 1}});
  return out;
}

TEST(Foretold, TheOnlyRecordOfAMountingTakesTheMeanOfThoseThatTellOfEachOther) {
  std::vector<double> square = {1.0, 1.0, 50.0, 2.0, 2.0};
  set_unforetold_aside(of_mountings("mounting", "declared_gain"), 0, JudgedBy::left_out, square);
  EXPECT_EQ(square, (std::vector<double>{1.0, 1.0, 1.5, 2.0, 2.0}));
}

TEST(Foretold, RecordsThatAreHeldOutAreToldByThoseThatAreNot) {
  ResidualChannel channel = of_mountings("mounting", "declared_gain");
  for (const std::size_t k : {1, 2, 3}) channel.problem.records[k].heldout = true;
  std::vector<double> square = {0.0, 1.0, 50.0, 2.0, 0.0};
  set_unforetold_aside(channel, 0, JudgedBy::heldout, square);
  EXPECT_EQ(square, (std::vector<double>{0.0, 1.0, 1.5, 2.0, 0.0}));
  // none that is held out is told: nobody knows better
  channel.problem.records[0].heldout = channel.problem.records[4].heldout = true;
  square = {0.0, 1.0, 50.0, 2.0, 0.0};
  set_unforetold_aside(channel, 0, JudgedBy::heldout, square);
  EXPECT_EQ(square, (std::vector<double>{0.0, 1.0, 50.0, 2.0, 0.0}));
}

TEST(Foretold, OtherEffectsAreToldByAllRecords) {
  std::vector<double> square = {1.0, 1.0, 50.0, 2.0, 2.0};
  set_unforetold_aside(of_mountings("wear", EffectRegistry::instance().find("wear")->forms.front().name), 0, JudgedBy::left_out, square);
  EXPECT_EQ(square, (std::vector<double>{1.0, 1.0, 50.0, 2.0, 2.0}));
}

}  // namespace
}  // namespace forcegate::diagnose
