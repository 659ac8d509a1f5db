// The effects of the library and those that a campaign may be said to hide are the same, on both sides of the wall; and each is told to
// who diagnoses and to who exports.

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "hil/model/compensator/compensator.h"
#include "hil/model/effect.h"
#include "hil/model/model.h"
#include "tests/support/campaign_effects.h"

namespace forcegate {
namespace {

// No campaign of its own: what leaves the trace of a viscous film on every record is told as such.
const std::set<std::string> kOfTheLibraryOnly = {"viscous"};

TEST(EffectNames, AreThoseOfTheCampaignFormatBothWays) {
  for (const std::string& name : EffectRegistry::instance().names())
    EXPECT_TRUE(kOfTheLibraryOnly.contains(name) || test::kCampaignEffects.contains(name))
        << name << ": hide it in rigs/emulated/hidden/effects and name it in tests/support/campaign_effects.h, or say here why no campaign has it";
  for (const std::string& name : test::kCampaignEffects) EXPECT_NE(EffectRegistry::instance().find(name), nullptr) << name << " is not in hil/model/effects";
  for (const std::string& name : kOfTheLibraryOnly) EXPECT_NE(EffectRegistry::instance().find(name), nullptr) << name << " needs no exception any more";
}

// For a reader on the bench, by the first column of a table: "thermal; humidity", "backlash (rig)".
TEST(EffectNames, AreThoseOfTheTableInTheGuide) {
  std::set<std::string> rows;
  std::ifstream page(FORCEGATE_SOURCE_DIR "/docs/diagnosis.md");
  ASSERT_TRUE(page);
  for (std::string line; std::getline(page, line);)
    if (line.starts_with("| ")) {
      std::istringstream cell(line.substr(2, line.find(" |", 2) - 2));
      for (std::string name; cell >> name;) rows.insert(name.substr(0, name.find(';')));
    }
  for (const std::string& name : EffectRegistry::instance().names()) EXPECT_TRUE(rows.contains(name)) << name << " has no row in docs/diagnosis.md";
}

// A refusal without a reason of its own sends who exports away with nothing.
TEST(EffectNames, HaveAnInverseInCOrAReasonWhyThereIsNone) {
  for (const EffectKind& kind : EffectRegistry::instance().all()) {
    if (kind.forms.empty()) continue;
    const EffectForm& form = kind.forms.front();
    Model model = *library_model("flexiforce");
    std::vector<double> shape;
    for (const ParameterSpec& p : form.shape) shape.push_back(p.neutral);
    model.effects = {model_effect(kind, form, shape, std::vector<Estimate>(form.strength.size()))};
    const auto made = make_compensator(model, {});
    if (made) continue;
    EXPECT_EQ(made.error().text.find("no inverse of it is written"), std::string::npos) << kind.name << ": give it a row in hil/model/compensator/c_term.cpp";
  }
}

}  // namespace
}  // namespace forcegate
