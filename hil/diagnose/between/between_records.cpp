#include "hil/diagnose/between/between_records.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "hil/base/quantile.h"
#include "hil/base/rng.h"
#include "hil/diagnose/base/record_part.h"
#include "hil/diagnose/between/mounting_places.h"
#include "hil/diagnose/between/outlasting.h"
#include "hil/diagnose/between/record_chance.h"
#include "hil/diagnose/between/record_questions.h"
#include "hil/diagnose/choose/probability.h"
#include "hil/model/lagged_channel.h"
#include "hil/model/record_input.h"

namespace forcegate::diagnose {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kFree = 1.0;                        // spread of a gain or zero that may be anything, shares of the span
constexpr double kSession_s = 3600.0;                // a rest of this length begins a new session
constexpr double kTypicalGain = 6e-3, kTypicalZero = 2e-3;  // to which specimens repeat

bool is_unrecorded(const ResidualChannel& channel, int variant) { return candidate_of(channel, variant).form->name == kUnrecorded; }

// Nats. A bench whose description tells of no mounting may have had one between any two records; it is the less likely cause of what a
// course over the campaign explains too.
double prior_of(const ResidualChannel& channel, int variant) { return unknown_steps(candidate_of(channel, variant)) > 0 ? -1.0 : 0.0; }

struct Answer {
  RecordEvidence evidence;
  bool of_gain = true;  // what the best variant moves
  VectorXd added, added_to_other;              // what it adds to that, and the best variant of the other to the other; empty: nothing
  std::vector<std::pair<double, int>> ranked;  // variants, best first
};

// The variant that moves gain and zero at once, where both ask for it.
int whole_of(const ResidualChannel& channel, int variant) {
  const Candidate& part = candidate_of(channel, variant);
  for (std::size_t v = 0; v < channel.variants.size(); ++v) {
    const Candidate& c = candidate_of(channel, static_cast<int>(v));
    if (part.form->groups ? c.kind == part.kind && c.form->whole : &c == &part && channel.variants[v].columns.size() > 1) return static_cast<int>(v);
  }
  return variant;
}

Answer evidence(const ResidualChannel& channel, const RecordLevels& levels, const FamilyQuestion& asked) {
  constexpr double kBoth = 1.0;  // nats in each part
  Answer out;
  std::vector<double> gains;
  double highest = -1e299;
  for (const bool gain : {true, false}) {
    const std::vector<Asked>& part = asked.part(gain);
    const std::vector<RecordScore> scores = scores_of(levels, asked, gain);
    std::vector<double> of_part;
    for (std::size_t a = 0; a < scores.size(); ++a) {
      of_part.push_back(scores[a].gain + part[a].log_weight + prior_of(channel, part[a].variant));
      out.ranked.emplace_back(of_part.back(), part[a].variant);
    }
    if (of_part.empty()) continue;
    gains.push_back(log_mean_exp(of_part));
    const auto top = std::ranges::max_element(of_part);
    const RecordScore& best = scores[static_cast<std::size_t>(top - of_part.begin())];
    if (*top <= highest) {
      out.added_to_other = best.added;
      continue;
    }
    highest = *top;
    out.of_gain = gain;
    out.added_to_other = std::move(out.added);
    out.added = best.added;
    out.evidence.explained = best.explained;
    out.evidence.left_out = best.left_out;
  }
  out.evidence.valid = highest > -1e299;
  if (!out.evidence.valid) return out;
  out.evidence.gain = joint_gain(gains);
  std::stable_sort(out.ranked.begin(), out.ranked.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  if (gains.size() == 2 && std::min(gains[0], gains[1]) > kBoth)
    for (auto& [gain, variant] : out.ranked) variant = whole_of(channel, variant);
  out.evidence.variant = out.ranked.front().second;
  return out;
}

// Variants that the records like by at most so much less than the best one, without it.
std::vector<int> nearly_as_good(const Answer& answer, double nats) {
  constexpr std::size_t kMost = 16;
  std::vector<int> out;
  for (const auto& [gain, variant] : answer.ranked) {
    if (gain < answer.ranked.front().first - nats || out.size() == kMost) break;
    if (variant != answer.evidence.variant && std::ranges::find(out, variant) == out.end()) out.push_back(variant);
  }
  return out;
}

// What the best variant adds, turned over where the scatter has the sign that it cannot have.
VectorXd as_physics_allows(const ResidualChannel& channel, const RecordLevels& levels, const Answer& answer) {
  const std::vector<int>& columns = columns_of(channel, answer.evidence.variant);
  if (candidate_of(channel, answer.evidence.variant).form->sign != StrengthSign::positive || columns.size() != 1) return answer.added;
  const MatrixXd& map = answer.of_gain ? levels.gain_of_column : levels.zero_of_column;
  return answer.added.dot(map.col(columns.front())) < 0.0 ? VectorXd(-answer.added) : answer.added;
}

std::vector<RecordQuestion> questions_of(const RecordLevels& levels, const FamilyQuestion& asked) {
  std::vector<RecordQuestion> out;
  if (!asked.gain.empty()) out.push_back({levels.gain, predictors_of(asked.gain)});
  if (!asked.zero.empty()) out.push_back({levels.zero, predictors_of(asked.zero)});
  return out;
}

// The same questions to the records that are not cyclic; empty where those are all, or too few.
std::vector<RecordQuestion> asked_of_static(const std::vector<RecordQuestion>& questions) {
  constexpr std::size_t kFewest = 5;
  std::vector<Index> rows;
  const std::vector<int>& cyclic = questions.front().series.cyclic;
  for (std::size_t i = 0; i < cyclic.size(); ++i)
    if (cyclic[i] == 0) rows.push_back(static_cast<Index>(i));
  std::vector<RecordQuestion> out;
  if (rows.size() == cyclic.size() || rows.size() < kFewest) return out;
  for (const RecordQuestion& q : questions) {
    RecordQuestion part{{q.series.value(rows), q.series.variance(rows), {}, {}, q.series.typical_scatter}, {}};
    for (const Index i : rows) {
      part.series.session.push_back(q.series.session[static_cast<std::size_t>(i)]);
      if (!q.series.alike.empty()) part.series.alike.push_back(q.series.alike[static_cast<std::size_t>(i)]);
    }
    for (const RecordPredictor& p : q.predictors)
      if (RecordPredictor own{p.column(rows, Eigen::all), p.weight, p.positive, p.alone}; normalise(own) > 0.0) part.predictors.push_back(std::move(own));
    out.push_back(std::move(part));
  }
  return out;
}

// Orders of the records are weighed as the model without the effect weighs them, and that one takes the scatter of the effect for that of all
// records: cyclic ones, of which less is known, then hide what the others show. These are asked alone too, and the chance counts twice
// (Bonferroni).
RecordChance chance_of(const RecordLevels& levels, const FamilyQuestion& asked, const std::string& name, int draws) {
  const std::vector<RecordQuestion> of_all = questions_of(levels, asked);
  if (of_all.empty()) return {};
  const RecordChance all = chance_of_records(of_all, draws, mix_seed(2, name));
  const std::vector<RecordQuestion> of_static = asked_of_static(of_all);
  if (of_static.empty()) return all;
  const RecordChance alone = chance_of_records(of_static, draws, mix_seed(3, name));
  const RecordChance& smaller = alone.of_directions < all.of_directions ? alone : all;
  return {std::min(1.0, 2.0 * smaller.of_orders), std::min(1.0, 2.0 * smaller.of_directions)};
}

// Steps are asked of their own number: an order that has one step more, somewhere, is no better. The smaller numbers were asked before, and the
// chance counts that often.
RecordChance chance(const ResidualChannel& channel, const RecordLevels& levels, FamilyQuestion asked, int variant, const std::string& name, int draws) {
  const int steps = unknown_steps(candidate_of(channel, variant));
  for (std::vector<Asked>* part : {&asked.gain, &asked.zero})
    if (steps > 0) std::erase_if(*part, [&](const Asked& a) { return unknown_steps(candidate_of(channel, a.variant)) != steps; });
  RecordChance out = chance_of(levels, asked, name, draws);
  const double times = std::max(1, steps);
  out.of_orders = std::min(1.0, times * out.of_orders);
  out.of_directions = std::min(1.0, times * out.of_directions);
  return out;
}

// What nobody measured, steps, a smooth course, the loading done, what it left behind: sessions of a bench can look like it.
bool only_goes_with_time(const ResidualChannel& channel, const FamilyScore& family) {
  const Candidate& of = candidate_of(channel, family.records.variant);
  if (of.form->after_rig != RigShows::nothing) return false;
  return of.form->name == kUnrecorded || of.form->outlasts || unknown_steps(of) > 0 || family.kind->name == "wear" || family.kind->name == "reference_drift";
}

// Share of the scatter that is to go away. Two or three levels go through many courses within the scatter that sessions leave: they are steps
// where they stand three times above what is left within them.
double least_explained(const ResidualChannel& channel, int variant, bool with_time, const SelectionRules& rules) {
  constexpr double kOfSeveralSteps = 0.9;
  return unknown_steps(candidate_of(channel, variant)) > 1 ? kOfSeveralSteps : with_time ? rules.between_course_fall : rules.between_fall;
}

// Nats that leave even odds.
double least_gain(const CampaignInput& input, const ResidualChannel& channel, int variant, const SelectionRules& rules) {
  return cause_differs(input, candidate_of(channel, variant)) ? rules.recorded_cause_gain : rules.between_gain;
}

Refusal objection(const CampaignInput& input, const ResidualChannel& channel, const RecordEvidence& records, bool with_time, const SelectionRules& rules) {
  if (!records.valid || records.gain < least_gain(input, channel, records.variant, rules)) return Refusal::too_little_evidence;
  if (records.explained < least_explained(channel, records.variant, with_time, rules)) return Refusal::records_scatter_on;
  if (records.left_out > rules.between_left_out) return Refusal::helps_no_left_levels;
  return Refusal::none;
}

// Few records have few orders: where none does better, they must agree all the more closely. Groups that were declared have fewer still (records
// of one group change places for nothing), and the fewer they are, the more closely.
bool as_good_by_chance(const RecordChance& chance, const EffectForm& form, const SelectionRules& rules) {
  constexpr double kFewOrders = 0.25, kPlainly = 0.001, kTogether = 2.5e-4;
  if (chance.of_orders <= rules.between_chance) return false;
  if (chance.of_orders > kFewOrders) return true;
  return form.groups ? chance.of_orders * chance.of_directions > kTogether : chance.of_directions > kPlainly;
}

// A course that nobody recorded is the less likely cause of what a recorded one explains too, and no two causes because two names would fit it.
void set_priors(const ResidualChannel& channel, ScreenResult& result) {
  constexpr double kRecorded = 4.0;  // times as likely
  const auto unrecorded = [&](const FamilyScore& f) { return f.kind->traits.between_records && f.records.valid && is_unrecorded(channel, f.records.variant); };
  const auto names = static_cast<double>(std::ranges::count_if(result.families, unrecorded));
  for (FamilyScore& family : result.families)
    if (unrecorded(family)) family.records.prior = -std::log(kRecorded * names);
}

// Of beta and all columns of S: what `of_fit` has for those of the fit, 0 for the others.
VectorXd of_all_columns(const MixedProblem& p, const MixedFit& fit, const VectorXd& of_fit) {
  VectorXd out = VectorXd::Zero(p.n_fixed + p.ns);
  out.head(p.n_fixed) = of_fit.head(p.n_fixed);
  for (std::size_t b = 0; b < fit.columns.size(); ++b) out[p.n_fixed + fit.columns[b]] = of_fit[p.n_fixed + static_cast<Index>(b)];
  return out;
}

// A record with all columns of S, its gain going with what it goes with in a fit.
RecordPart whole_record(const MixedProblem& p, const MixedFit& fit, std::size_t record) {
  std::vector<int> all(static_cast<std::size_t>(p.ns));
  std::iota(all.begin(), all.end(), 0);
  RecordPart out(p, record, all);
  if (fit.per_gain.size() > 0) out.set_own_gain(of_all_columns(p, fit, fit.per_gain));
  return out;
}

}  // namespace

bool asks_between_records(const FamilyScore& family) {
  return shows_in_levels(*family.kind) && family.records.valid && family.gain <= family.records.gain;
}

double standing(const FamilyScore& family) { return family.gain + (asks_between_records(family) ? family.records.prior : 0.0); }

RecordLevels record_levels(const CampaignInput& input, const ResidualChannel& channel, const MixedFit& fit) {
  const MixedProblem& p = channel.problem;
  const auto n = static_cast<Index>(p.records.size());
  RecordLevels out;
  out.gain_of_column = out.zero_of_column = MatrixXd::Zero(n, p.ns);
  for (RecordSeries* s : {&out.gain, &out.zero}) s->value = s->variance = VectorXd::Zero(n);
  out.gain.typical_scatter = kTypicalGain;
  out.zero.typical_scatter = kTypicalZero;
  VectorXd sigma2(p.nz);
  for (int j = 0; j < p.nz; ++j) sigma2[j] = fit.variance[p.component_of_z[j]];
  sigma2[0] = sigma2[1] = kFree * kFree;
  const VectorXd of_fit = of_all_columns(p, fit, fit.coefficient);
  int session = 0;
  for (Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const RecordGram& g = p.records[k];
    const double weight = g.n_eff / fit.s2[k];
    const RecordPart record = whole_record(p, fit, k);
    MatrixXd A = weight * record.own_with_own();
    A.diagonal() += sigma2.cwiseInverse();
    const MatrixXd V = A.llt().solve(MatrixXd::Identity(p.nz, p.nz)).topRows(2);
    const MatrixXd with_columns = V * record.own_with_columns();
    const Eigen::Vector2d level = weight * (with_columns.rightCols<1>() - with_columns.leftCols(of_fit.size()) * of_fit);
    const MatrixXd columns = weight * with_columns.middleCols(p.n_fixed, p.ns);
    out.gain.value[i] = level[0];
    out.zero.value[i] = level[1];
    out.gain.variance[i] = V(0, 0);
    out.zero.variance[i] = V(1, 1);
    out.gain_of_column.row(i) = columns.row(0);
    out.zero_of_column.row(i) = columns.row(1);
    if (i > 0 && input.records[channel.record_of[k]].rest_before_s >= kSession_s) ++session;
    out.gain.session.push_back(session);
    out.gain.cyclic.push_back(input.records[channel.record_of[k]].dynamic ? 1 : 0);
    out.start_s.push_back(input.has_start_times ? input.records[channel.record_of[k]].start_s : static_cast<double>(i));
  }
  out.zero.session = out.gain.session;
  out.zero.cyclic = out.gain.cyclic;
  return out;
}

namespace {

// Records whose load travels far more than that of the quiet ones.
std::vector<int> cycled(const CampaignInput& input, const ResidualChannel& channel) {
  constexpr double kFar = 4.0, kQuiet = 0.25, kSlow = 0.02;  // times their speed; the quantile of the campaign that they are; ranges a second: holds have none
  std::vector<double> speed;
  for (const std::size_t k : channel.record_of) {
    const RecordInput& r = input.records[k];
    speed.push_back(r.duration_s > 0.0 && !r.travel_N.empty() ? r.travel_N.back() / r.duration_s : 0.0);
  }
  const double quiet = std::max(quantile(speed, kQuiet), kSlow * input.range_N);
  std::vector<int> out;
  for (const double v : speed) out.push_back(v > kFar * quiet ? 1 : 0);
  return out;
}

RecordLevels levels_for(const EffectKind& kind, const CampaignInput& input, const ResidualChannel& channel, RecordLevels levels) {
  if (kind.traits.of_cycling) levels.gain.alike = levels.zero.alike = cycled(input, channel);
  return levels;
}

}  // namespace

void judge_between_records(const CampaignInput& input, const ResidualChannel& channel, const std::vector<int>& present, const SelectionRules& rules, ScreenResult& result) {
  if (input.single || !result.base.valid) return;
  const RecordLevels of_all = record_levels(input, channel, result.base);
  for (FamilyScore& family : result.families) {
    if (!shows_in_levels(*family.kind)) continue;
    const RecordLevels levels = levels_for(*family.kind, input, channel, of_all);
    const FamilyQuestion asked = ask(channel, levels, *family.kind);
    const Answer answer = evidence(channel, levels, asked);
    family.records = answer.evidence;
    if (!answer.evidence.valid) continue;
    if (!family.kind->traits.between_records && family.gain >= answer.evidence.gain) {
      prefer_what_both_tell(channel, levels, asked, present, result.base, rules, family);
      continue;
    }
    // rows of a course that may be any follow whatever else changes slowly
    if (!family.best.wrong_sign && candidate_of(channel, family.best.variant).form->cause.of_record) family.records.within = std::max(0.0, family.gain);
    // waves of the campaign's time say nothing of what happens within a record
    const bool within = family.best.total_fall >= rules.first_total_fall && !is_unrecorded(channel, family.best.variant);
    if (within && family.gain >= answer.evidence.gain && answer.evidence.gain < rules.between_gain) continue;
    family.gain = within ? std::max(family.gain, answer.evidence.gain) : answer.evidence.gain;
    VariantScore best = score_variant(channel, present, result.base, answer.evidence.variant, nullptr);
    // of forms that the records hardly tell apart the one that the rows within them agree with
    constexpr double kNear = 2.0;  // nats
    const bool may_choose = columns_of(channel, answer.evidence.variant).size() == 1 || candidate_of(channel, answer.evidence.variant).form->singles;
    const auto choose_within = [&](double nats) {
      for (const int near : nearly_as_good(answer, nats)) {
        VariantScore other = score_variant(channel, present, result.base, near, nullptr);
        if (other.gain > best.gain) best = std::move(other);
      }
    };
    if (may_choose && answer.evidence.gain > kNear) choose_within(kNear);
    // where the rows speak against all of these, any that the records alone would pass
    if (may_choose && answer.evidence.gain > rules.between_gain && best.gain < 0.0) choose_within(answer.ranked.front().first - rules.between_gain);
    if (!best.fit.valid || !(best.gain > -1e299)) continue;
    family.records.variant = best.variant;
    family.best = std::move(best);
  }
  set_priors(channel, result);
  std::stable_sort(result.families.begin(), result.families.end(), [&](const FamilyScore& a, const FamilyScore& b) { return standing(a) > standing(b); });
}

RecordTest test_records(const CampaignInput& input, const ResidualChannel& channel, const MixedFit& base, const FamilyScore& family,
                        const SelectionRules& rules) {
  constexpr int kDraws = 19999;
  RecordTest out;
  const bool with_time = only_goes_with_time(channel, family);
  out.objection = objection(input, channel, family.records, with_time, rules);
  if (out.objection == Refusal::none && with_time && family.kind->name != "wear" && family.kind->name != "mounting" && !input.has_start_times)
    out.objection = Refusal::start_unknown;
  if (out.objection != Refusal::none) return out;
  const RecordLevels levels = levels_for(*family.kind, input, channel, record_levels(input, channel, base));
  const RecordChance chances = chance(channel, levels, ask(channel, levels, *family.kind), family.records.variant, family.kind->name, kDraws);
  out.chance = chances.of_directions;
  if (as_good_by_chance(chances, *candidate_of(channel, family.records.variant).form, rules)) out.objection = Refusal::any_order;
  return out;
}

double visible_between_records(const CampaignInput& input, const ResidualChannel& channel, const MixedFit& base, const FamilyScore& family,
                               const SelectionRules& rules) {
  RecordLevels levels = levels_for(*family.kind, input, channel, record_levels(input, channel, base));
  const FamilyQuestion asked = ask(channel, levels, *family.kind);
  const Answer now = evidence(channel, levels, asked);
  if (!now.evidence.valid) return 0.0;
  RecordSeries& series = now.of_gain ? levels.gain : levels.zero;
  if (now.added_to_other.size() > 0) (now.of_gain ? levels.zero : levels.gain).value -= now.added_to_other;
  const VectorXd rest = series.value - now.added, added = as_physics_allows(channel, levels, now);
  const double rms = std::sqrt(added.squaredNorm() / static_cast<double>(added.size()));
  if (!(rms > 0.0)) return 0.0;
  const bool with_time = only_goes_with_time(channel, family);
  constexpr int kDraws = 199;
  const auto passes = [&](double size) {
    series.value = rest + size / rms * added;
    const RecordEvidence shown = evidence(channel, levels, asked).evidence;
    return objection(input, channel, shown, with_time, rules) == Refusal::none &&
           !as_good_by_chance(chance(channel, levels, asked, shown.variant, family.kind->name, kDraws), *candidate_of(channel, shown.variant).form, rules);
  };
  double low = 1e-5, high = 0.5;
  if (!passes(high)) return 0.0;
  for (int step = 0; step < 9; ++step) {
    const double middle = std::sqrt(low * high);
    (passes(middle) ? high : low) = middle;
  }
  double square = 0.0;
  for (Index i = 0; i < added.size(); ++i)
    square += std::pow(high / rms * added[i], 2) * (now.of_gain ? channel.problem.records[static_cast<std::size_t>(i)].gram(0, 0) : 1.0);
  return std::sqrt(square / static_cast<double>(added.size()));
}

}  // namespace forcegate::diagnose
