// One case for every reason that an objection gives: the least that makes an effect without a fault one that is refused.

#include "hil/diagnose/choose/objection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "hil/base/rng.h"
#include "tests/unit/diagnose/made_channel.h"

namespace forcegate::diagnose {
namespace {

// Four records, y = F + S/10. The force moves all the time and S goes with it; or it stands at levels, and S comes and goes there.
ResidualChannel channel_of(bool stands) {
  ResidualChannel channel = channel_of_lines(1, 2.0);
  Rng rng(7, "objection");
  for (int k = 0; k < 4; ++k) {
    Eigen::MatrixXd rows(400, 4);
    for (int i = 0; i < 400; ++i) {
      const double F = stands ? 0.2 * (i / 80) : std::abs(std::fmod(0.05 * i, 2.0) - 1.0);
      const double S = stands ? rng.normal() : std::sin(2.0 * std::numbers::pi * F);
      rows.row(i) << F, 1.0, S, F + 0.1 * S + 1e-4 * rng.normal();
    }
    add_record(channel, std::move(rows), 80.0, 1e-8, 1e-8);
  }
  channel.variants = {{0, {0}}};
  return channel;
}

struct Asked {
  EffectKind kind, loop;
  ResidualChannel channel;
  ScreenResult result;
  FamilyScore family;
  ChosenEffect chosen;
  std::vector<ChosenEffect> earlier;
  double removed_before = 0.0;
  SelectionRules rules;

  explicit Asked(bool stands) : channel(channel_of(stands)) {
    kind.name = "creep", loop.name = "hysteresis";
    kind.forms.emplace_back().name = "a form";
    channel.candidates.push_back({&kind, &kind.forms[0], {}, 0, 1});
    result.base = fit_mixed(channel.problem, {}, nullptr, 20, RecordUse::all_records);
    family.kind = chosen.kind = &kind;
    family.gain = 100.0;
    family.best.fall = family.best.total_fall = chosen.fall = 0.9;
    family.best.fit = chosen.fit = fit_mixed(channel.problem, {0}, &result.base, 20, RecordUse::all_records);
    chosen.columns = {0};
    chosen.effect_rms = 0.07;
    CrossFit& left = chosen.left_out;
    left.parts = left.excited = left.improved = left.voting = left.in_favour = 4;
    left.fall = left.log_ratio = 2.0;
    left.standard_error = left.log_ratio_error = 0.1;
    left.share = 0.9;
    result.families = {family};
  }
  Asked(const Asked&) = delete;

  void took(const EffectKind& earlier_kind, bool between) {
    earlier.emplace_back();
    earlier.back().kind = &earlier_kind;
    earlier.back().between = between;
  }
  void acts_between(Refusal not_by_records) {
    chosen.between = true;
    chosen.not_by_records = not_by_records;
    family.best.total_fall = 0.01;  // and is hardly seen within them
  }
};

struct Row {
  Refusal refusal;
  const char* where;
  void (*change)(Asked&);
  bool stands = false;
};

const Row kRows[] = {
    {Refusal::none, "nothing is wrong", [](Asked&) {}},
    {Refusal::none, "between records", [](Asked& a) { a.acts_between(Refusal::none); }},
    {Refusal::unphysical, "", [](Asked& a) { a.family.best.wrong_sign = true; }},
    {Refusal::second_between, "", [](Asked& a) { a.acts_between(Refusal::none), a.took(a.loop, true); }},
    {Refusal::too_small, "between records", [](Asked& a) { a.acts_between(Refusal::none), a.chosen.effect_rms = 1e-5; }},
    {Refusal::too_little_evidence, "between records", [](Asked& a) { a.acts_between(Refusal::too_little_evidence); }},
    {Refusal::records_scatter_on, "", [](Asked& a) { a.acts_between(Refusal::records_scatter_on); }},
    {Refusal::helps_no_left_levels, "", [](Asked& a) { a.acts_between(Refusal::helps_no_left_levels); }},
    {Refusal::start_unknown, "", [](Asked& a) { a.acts_between(Refusal::start_unknown); }},
    {Refusal::any_order, "", [](Asked& a) { a.acts_between(Refusal::any_order); }},
    {Refusal::too_little_evidence, "of any effect", [](Asked& a) { a.family.gain = 13.0; }},
    {Refusal::too_little_evidence, "of its form", [](Asked& a) { a.rules.form_gain["a form"] = 200.0; }},
    {Refusal::leaves_most, "", [](Asked& a) { a.chosen.fall = 0.05, a.family.best.total_fall = 0.01; }},
    {Refusal::few_jumps, "", [](Asked& a) { a.kind.name = "adc_codes", a.chosen.fall = a.family.best.total_fall = 0.25; }},
    {Refusal::too_small, "of the span", [](Asked& a) { a.rules.smallest_rms = 0.2; }},
    {Refusal::too_small, "beside the noise of the reference", [](Asked& a) { for (RecordGram& r : a.channel.problem.records) r.smoothed_variance = 0.1; }},
    {Refusal::too_small, "of time, beside the instruments", [](Asked& a) {
       a.kind.traits.timing = true;
       for (RecordGram& r : a.channel.problem.records) r.noise_variance = r.allowed_variance = 0.1;
       a.chosen.fall = a.family.best.total_fall = 0.9;
     }},
    {Refusal::differs, "of a form that is only nearly right", [](Asked& a) { a.chosen.strength_scatter = 0.6, a.chosen.left_out.improved = 3; }},
    {Refusal::none, "within a half", [](Asked& a) { a.chosen.strength_scatter = 0.45, a.chosen.left_out.improved = 3; }},
    {Refusal::none, "but every record gains", [](Asked& a) { a.chosen.strength_scatter = 1.1; }},
    {Refusal::differs, "of a known form", [](Asked& a) { a.kind.traits.known_form = true, a.chosen.strength_scatter = 0.4, a.chosen.fall = 0.8; }},
    {Refusal::within_form, "", [](Asked& a) { a.kind.name = "static_nonlinearity", a.took(a.loop, false), a.removed_before = 10.0; }},
    {Refusal::in_few_records, "", [](Asked& a) { a.chosen.left_out.blocks = true, a.family.gain = 39.0; }},
    {Refusal::helps_no_records, "", [](Asked& a) { a.chosen.left_out.fall = a.chosen.left_out.log_ratio = -1.0; }},
    {Refusal::helps_no_records, "by next to nothing", [](Asked& a) { a.chosen.left_out.share = 0.01; }},
    {Refusal::none, "but describes the whole recording", [](Asked& a) { a.chosen.left_out.fall = -1.0, a.chosen.describes_whole = true; }},
    {Refusal::helps_no_parts, "", [](Asked& a) { a.chosen.left_out.blocks = true, a.chosen.left_out.fall = -1.0; }},
    {Refusal::jitter, "", [](Asked&) {}, true},
};

TEST(Objection, GivesEachReasonForItsCauseAlone) {
  for (const Row& row : kRows) {
    Asked a(row.stands);
    ASSERT_TRUE(a.result.base.valid && a.family.best.fit.valid);
    row.change(a);
    EXPECT_EQ(traits_of(objection(a.channel, a.result, a.family, a.chosen, a.earlier, a.removed_before, a.rules).why).code, traits_of(row.refusal).code) << row.where;
  }
}

TEST(Objection, HasACaseForEveryReasonThatItGives) {
  std::set<Refusal> tried{Refusal::leads, Refusal::in_step, Refusal::needless};  // told by the choice itself
  for (const Row& row : kRows) tried.insert(row.refusal);
  for (const RefusalRow& row : kRefusals) EXPECT_TRUE(tried.contains(row.refusal)) << row.traits.code;
}

TEST(Objection, ACurveBesideALoopIsJudgedByTheLoopsForm) {
  Asked a(false);
  a.kind.name = "static_nonlinearity";
  a.took(a.loop, false);
  a.removed_before = 0.1;
  EXPECT_EQ(objection(a.channel, a.result, a.family, a.chosen, a.earlier, a.removed_before, a.rules).why, Refusal::none) << "it is larger than a quarter of the loop";
}

}  // namespace
}  // namespace forcegate::diagnose
