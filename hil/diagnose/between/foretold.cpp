#include "hil/diagnose/between/foretold.h"

#include <algorithm>

#include "hil/diagnose/between/mounting_places.h"

namespace forcegate::diagnose {

namespace {

// The first column that a record of the mounting has; -1: of the first mounting.
int mounting_of(const ResidualChannel& channel, const Variant& variant, std::size_t record) {
  const Eigen::MatrixXd& gram = channel.problem.records[record].gram;
  for (const int column : variant.columns)
    if (const int j = channel.problem.nz + column; gram(j, j) > 0.0) return column;
  return -1;
}

}  // namespace

void set_unforetold_aside(const ResidualChannel& channel, int variant, JudgedBy by, std::vector<double>& mean_square) {
  constexpr double kFewest = 0.5;
  const Variant& of = channel.variants[static_cast<std::size_t>(variant)];
  const Candidate& candidate = channel.candidates[static_cast<std::size_t>(of.candidate)];
  if (by == JudgedBy::whole || (!candidate.form->groups && unknown_steps(candidate) == 0)) return;
  const auto& records = channel.problem.records;
  const auto judges = [&](std::size_t k) { return by != JudgedBy::heldout || records[k].heldout; };
  const auto speaks = [&](std::size_t k) { return by != JudgedBy::heldout || !records[k].heldout; };
  std::vector<int> mounting;
  for (std::size_t k = 0; k < records.size(); ++k) mounting.push_back(mounting_of(channel, of, k));
  double sum = 0.0, foretold = 0.0, judging = 0.0;
  std::vector<std::size_t> aside;
  for (std::size_t k = 0; k < records.size(); ++k) {
    if (!judges(k)) continue;
    judging += 1.0;
    bool told = false;
    for (std::size_t other = 0; other < records.size(); ++other) told = told || (other != k && speaks(other) && mounting[other] == mounting[k]);
    if (told) sum += mean_square[k], foretold += 1.0;
    else aside.push_back(k);
  }
  if (foretold < kFewest * judging || foretold == 0.0) return;
  for (const std::size_t k : aside) mean_square[k] = sum / foretold;
}

}  // namespace forcegate::diagnose
