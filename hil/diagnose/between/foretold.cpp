#include "hil/diagnose/between/foretold.h"

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

std::vector<char> foretold_records(const ResidualChannel& channel, int variant, JudgedBy by) {
  constexpr double kFewest = 0.5;
  const Variant& of = channel.variants[static_cast<std::size_t>(variant)];
  const Candidate& candidate = channel.candidates[static_cast<std::size_t>(of.candidate)];
  const auto& records = channel.problem.records;
  std::vector<char> all(records.size(), 1);
  if (by == JudgedBy::whole || (!candidate.form->groups && unknown_steps(candidate) == 0)) return all;
  const auto judges = [&](std::size_t k) { return by != JudgedBy::heldout || records[k].heldout; };
  const auto speaks = [&](std::size_t k) { return by != JudgedBy::heldout || !records[k].heldout; };
  std::vector<int> mounting;
  for (std::size_t k = 0; k < records.size(); ++k) mounting.push_back(mounting_of(channel, of, k));
  std::vector<char> out = all;
  double foretold = 0.0, judging = 0.0;
  for (std::size_t k = 0; k < records.size(); ++k) {
    if (!judges(k)) continue;
    bool told = false;
    for (std::size_t other = 0; other < records.size(); ++other) told = told || (other != k && speaks(other) && mounting[other] == mounting[k]);
    out[k] = told ? 1 : 0;
    judging += 1.0;
    foretold += told ? 1.0 : 0.0;
  }
  return foretold > 0.0 && foretold >= kFewest * judging ? out : all;
}

void set_unforetold_aside(const ResidualChannel& channel, int variant, JudgedBy by, std::vector<double>& mean_square) {
  const std::vector<char> foretold = foretold_records(channel, variant, by);
  double sum = 0.0, n = 0.0;
  for (std::size_t k = 0; k < foretold.size(); ++k)
    if (foretold[k] != 0 && (by != JudgedBy::heldout || channel.problem.records[k].heldout)) sum += mean_square[k], n += 1.0;
  for (std::size_t k = 0; k < foretold.size(); ++k)
    if (foretold[k] == 0) mean_square[k] = sum / n;
}

}  // namespace forcegate::diagnose
