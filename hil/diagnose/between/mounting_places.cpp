#include "hil/diagnose/between/mounting_places.h"

#include <algorithm>

#include "hil/diagnose/between/record_questions.h"
#include "hil/diagnose/candidates/signatures.h"
#include "hil/diagnose/choose/screen.h"

namespace forcegate::diagnose {

namespace {

constexpr int kFewestOfOne = 2;       // records, of a mounting that is seen to repeat
constexpr int kSeenToRepeat = 2;      // mountings
constexpr std::size_t kMostSets = 290;  // of places: 25 records with two steps, 14 with three

bool two_repeat(const std::vector<int>& places, int records) {
  int repeat = 0, first = 1;
  for (std::size_t k = 0; k <= places.size(); ++k) {
    const int next = k < places.size() ? places[k] : records + 1;
    repeat += next - first >= kFewestOfOne ? 1 : 0;
    first = next;
  }
  return repeat >= kSeenToRepeat;
}

// By gain and zero together, each part as far as it speaks for them.
std::vector<double> likeliest_places(const RecordLevels& levels, const FamilyQuestion& question, std::size_t steps) {
  std::vector<std::vector<int>> sets;
  std::vector<std::vector<double>> gains;
  for (const bool of_gain : {true, false}) {
    const std::vector<Asked>& part = question.part(of_gain);
    const std::vector<RecordScore> scores = scores_of(levels, question, of_gain);
    for (std::size_t a = 0; a < scores.size(); ++a) {
      if (part[a].places.size() != steps) continue;
      const auto at = std::ranges::find(sets, part[a].places);
      if (at == sets.end()) {
        sets.push_back(part[a].places);
        gains.push_back({scores[a].gain});
      } else gains[static_cast<std::size_t>(at - sets.begin())].push_back(scores[a].gain);
    }
  }
  if (sets.empty()) return {};
  const auto best = std::ranges::max_element(gains, {}, [](const std::vector<double>& of_parts) { return joint_gain(of_parts); }) - gains.begin();
  const std::vector<int>& places = sets[static_cast<std::size_t>(best)];
  return {places.begin(), places.end()};
}

}  // namespace

int unknown_steps(const Candidate& candidate) {
  return candidate.kind->name == "mounting" && !candidate.form->groups ? static_cast<int>(candidate.shape.size()) : 0;
}

std::vector<std::vector<int>> places_of_mountings(Eigen::Index records, int steps) {
  const auto n = static_cast<int>(records);
  std::vector<std::vector<int>> out;
  std::vector<int> places;
  const auto go_on = [&](const auto& self, int from) -> void {
    if (out.size() > kMostSets) return;
    if (std::ssize(places) == steps) {
      if (two_repeat(places, n)) out.push_back(places);
      return;
    }
    for (int k = from; k <= n; ++k) {
      places.push_back(k);
      self(self, k + 1);
      places.pop_back();
    }
  };
  go_on(go_on, 2);
  if (out.size() > kMostSets) out.clear();
  return out;
}

RecordPredictor predictor_of_places(Eigen::Index records, const std::vector<int>& places) {
  Eigen::MatrixXd member = Eigen::MatrixXd::Zero(records, std::ssize(places) + 1);
  for (Eigen::Index i = 0; i < records; ++i) member(i, std::ranges::upper_bound(places, static_cast<int>(i + 1)) - places.begin()) = 1.0;
  return {member, Eigen::VectorXd::Ones(member.cols())};
}

void place_mountings(const CampaignInput& input, ResidualChannel& channel, const MixedFit& fit, unsigned threads) {
  const auto several = [](const Candidate& c) { return unknown_steps(c) > 1 && !c.of_model && c.is_read; };
  const auto first = std::ranges::find_if(channel.candidates, several);
  if (first == channel.candidates.end() || !fit.valid) return;
  const RecordLevels levels = record_levels(input, channel, fit);
  const FamilyQuestion question = ask(channel, levels, *first->kind);
  for (Candidate& c : channel.candidates) {
    if (!several(c)) continue;
    std::vector<double> places = likeliest_places(levels, question, c.shape.size());
    if (places.empty() || places == c.shape) continue;
    c.shape = std::move(places);
    fill_candidate(input, channel, c, threads);
  }
}

void place_mountings(Workspace& w, const std::vector<int>& present, const MixedFit* warm, unsigned threads) {
  constexpr int kIterations = 18;
  place_mountings(w.input, w.output, fit_to_the_end(w.output, present, warm, kIterations, RecordUse::all_records), threads);
}

}  // namespace forcegate::diagnose
