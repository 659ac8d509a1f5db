#include "hil/diagnose/choose/where_they_differ.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hil/base/parallel.h"
#include "hil/diagnose/base/base_fit.h"
#include "hil/diagnose/candidates/signatures.h"
#include "hil/diagnose/candidates/spare_room.h"
#include "hil/diagnose/choose/refine.h"

namespace forcegate::diagnose {

namespace {

constexpr double kCompetes = 0.05;               // share of the place
constexpr double kNats = 18.0, kOfBest = 0.06;  // by which the best must lead: forms are not quite right

// Those that compete for its place; fewer than two: none do.
std::vector<std::string> timing_rivals(const ChosenEffect& chosen) {
  if (!chosen.kind->traits.timing) return {};
  std::vector<std::string> out = {chosen.kind->name};
  for (const auto& [name, share] : chosen.rivals)
    if (is_timing(name) && share > kCompetes) out.push_back(name);
  return out;
}

// What a family's best variant adds to every row of a recording, in units of the channel.
Eigen::VectorXd answer_on_all_rows(const CampaignInput& input, const ResidualChannel& channel, const RecordInput& recording, const FamilyScore& family) {
  const Candidate& c = candidate_of(channel, family.best.variant);
  const std::vector<int>& columns = columns_of(channel, family.best.variant);
  Eigen::MatrixXd room = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(recording.rows()), c.count);
  c.form->columns(input, recording, c.shape, room);
  const Eigen::VectorXd strengths = family.best.fit.strengths_of(columns);
  Eigen::VectorXd out = Eigen::VectorXd::Zero(room.rows());
  for (std::size_t j = 0; j < columns.size(); ++j)
    out += strengths[static_cast<Eigen::Index>(j)] * channel.column_factor * room.col(columns[j] - c.first);
  return out.unaryExpr([](double x) { return std::isfinite(x) ? x : 0.0; });
}

// How far apart the families' answers are, on every row of every record. All rows of the input are wanted.
std::vector<Eigen::VectorXd> spread_of_answers(const CampaignInput& input, const ResidualChannel& channel, const std::vector<FamilyScore>& families, unsigned threads) {
  std::vector<Eigen::VectorXd> out(input.records.size());
  parallel_for(input.records.size(), threads, [&](std::size_t k) {
    if (k > 0 && input.records[k - 1].recording == input.records[k].recording) return;
    Eigen::VectorXd low, high;
    for (const FamilyScore& family : families) {
      const Eigen::VectorXd answer = answer_on_all_rows(input, channel, input.records[k], family);
      low = low.size() == 0 ? answer : low.cwiseMin(answer);
      high = high.size() == 0 ? answer : high.cwiseMax(answer);
    }
    out[k] = high - low;
  });
  for (std::size_t k = 1; k < out.size(); ++k)
    if (input.records[k - 1].recording == input.records[k].recording) out[k] = out[k - 1];
  return out;
}

RowsOfRecords rows_where_they_differ(const CampaignInput& input, const std::vector<Eigen::VectorXd>& spread) {
  constexpr std::size_t kMost = 1000, kLeast = 200;
  constexpr double kOfLargest = 0.1;
  double largest = 0.0;
  for (const Eigen::VectorXd& s : spread) largest = std::max(largest, s.size() > 0 ? s.maxCoeff() : 0.0);
  RowsOfRecords out;
  for (std::size_t k = 0; k < input.records.size(); ++k) {
    const RecordInput& r = input.records[k];
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < r.rows(); ++i)
      if (r.ok[i] != 0 && spread[k][static_cast<Eigen::Index>(i)] > kOfLargest * largest) rows.push_back(i);
    std::ranges::stable_sort(rows, std::greater<>(), [&](std::size_t i) { return spread[k][static_cast<Eigen::Index>(i)]; });
    rows.resize(std::min(rows.size(), kMost));
    for (const std::size_t i : choose_rows(r, std::max(kLeast, rows.size()))) rows.push_back(i);
    std::ranges::sort(rows);
    rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
    out.push_back(std::move(rows));
  }
  return out;
}

// All rows of an input are wanted, for a while; then those of before.
class Wanted {
 public:
  explicit Wanted(CampaignInput& input) : input_(input) {
    for (RecordInput& r : input_.records) before_.push_back(std::exchange(r.wanted, {}));
  }
  ~Wanted() {
    for (std::size_t k = 0; k < before_.size(); ++k) input_.records[k].wanted = std::move(before_[k]);
  }
  Wanted(const Wanted&) = delete;
  Wanted& operator=(const Wanted&) = delete;

 private:
  CampaignInput& input_;
  std::vector<std::vector<std::uint32_t>> before_;
};

// Candidates of a channel that own some of the columns.
std::vector<const Candidate*> owners_of(const ResidualChannel& channel, const std::vector<int>& columns) {
  std::vector<const Candidate*> out;
  for (const Candidate& c : channel.candidates)
    if (std::ranges::any_of(columns, [&](int j) { return c.owns(j); })) out.push_back(&c);
  return out;
}

// The families `names` alone, beside the same columns, on other rows.
ScreenResult screen_on(const RowsOfRecords& rows, const Workspace& w, const std::vector<std::string>& names, const std::vector<int>& beside, unsigned threads) {
  const std::vector<const Candidate*> owners = owners_of(w.output, beside);
  std::vector<Candidate> copies;
  for (const Candidate* c : owners) copies.push_back(*c);
  const ListedOnly only{names, {}};
  ResidualChannel channel = output_channel(w, threads, copies, &only, &rows);
  // of_model candidates stand behind those that are listed, in their order
  const std::size_t first = channel.candidates.size() - owners.size();
  std::vector<int> present;
  for (const int j : beside)
    for (std::size_t k = 0; k < owners.size(); ++k)
      if (owners[k]->owns(j)) present.push_back(channel.candidates[first + k].first + j - owners[k]->first);
  ScreenResult out = screen(channel, present, {}, nullptr, threads);
  if (out.base.valid) refine_leaders(w.input, channel, present, out, threads);
  return out;
}

}  // namespace

std::vector<std::string> beaten_where_they_differ(Workspace& w, const Selection& selection, const SelectionRules& rules, unsigned threads) {
  if (rules.forms_are_rough) return {};
  for (const ChosenEffect& chosen : selection.chosen) {
    const std::vector<std::string> names = timing_rivals(chosen);
    if (names.size() < 2) continue;
    const std::vector<int> present = columns_beside(w.output, selection.carried, selection.chosen, chosen);
    RowsOfRecords rows;
    {
      const SpareRoom room(w.output);
      ScreenResult even = screen(w.output, present, families_but(w.output, names), &selection.final, threads);
      if (!even.base.valid || even.families.size() < 2) continue;
      refine_leaders(w.input, w.output, present, even, threads);
      const Wanted all(w.input);
      rows = rows_where_they_differ(w.input, spread_of_answers(w.input, w.output, even.families, threads));
    }
    const Wanted others(w.input);
    want_rows(w.input, rows);
    const ScreenResult there = screen_on(rows, w, names, present, threads);
    if (!there.base.valid || there.families.empty() || there.families.front().best.wrong_sign) continue;
    const double top = there.families.front().gain;
    std::vector<std::string> out;
    for (const FamilyScore& f : there.families)
      if (f.gain < top - std::max(kNats, kOfBest * top)) out.push_back(f.kind->name);
    // of three that are alike two are no better known without the third
    if (out.size() + 1 == there.families.size()) return out;
  }
  return {};
}

}  // namespace forcegate::diagnose
