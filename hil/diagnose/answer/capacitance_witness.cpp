#include "hil/diagnose/answer/capacitance_witness.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <vector>

#include "hil/base/text.h"

namespace forcegate::diagnose {
namespace {

constexpr double kBlock_s = 30.0, kReference = 0.65, kSensor = 0.35;
constexpr std::size_t kFewestBlocks = 8, kFewestRows = 20;

struct Row {
  double F_N, U_V, C_F;
  std::size_t block;
};

std::vector<Row> static_rows(const CampaignInput& input, std::size_t& blocks) {
  std::vector<Row> out;
  for (const RecordInput& r : input.records) {
    if (r.dynamic || r.C_F.empty()) continue;
    const std::size_t first = blocks;
    for (std::size_t i = 0; i < r.rows(); ++i) {
      if (r.ok[i] == 0 || !std::isfinite(r.C_F[i])) continue;
      const std::size_t block = first + static_cast<std::size_t>((r.t_s[i] - r.t_s.front()) / kBlock_s);
      out.push_back({r.F_N[i], r.U_V[i], r.C_F[i], block});
      blocks = std::max(blocks, block + 1);
    }
  }
  return out;
}

// Departure from the parabola over F_ref, as a force, averaged over blocks; NaN for blocks of few rows.
template <class Get>
std::vector<double> departure_N(const std::vector<Row>& rows, std::size_t blocks, double scale_N, Get get) {
  Eigen::MatrixXd X(static_cast<Eigen::Index>(rows.size()), 3);
  Eigen::VectorXd y(X.rows());
  double largest = 0.0;
  for (const Row& r : rows) largest = std::max(largest, std::abs(get(r)));
  for (Eigen::Index i = 0; i < X.rows(); ++i) {
    const Row& r = rows[static_cast<std::size_t>(i)];
    const double x = r.F_N / scale_N;
    X.row(i) << 1.0, x, x * x;
    y[i] = get(r) / largest;
  }
  const Eigen::Vector3d a = (X.transpose() * X).ldlt().solve(X.transpose() * y);
  std::vector<double> sum(blocks, 0.0), n(blocks, 0.0);
  for (Eigen::Index i = 0; i < X.rows(); ++i) {
    const Row& r = rows[static_cast<std::size_t>(i)];
    const double per_N = (a[1] + 2.0 * a[2] * r.F_N / scale_N) / scale_N;
    if (!(std::abs(per_N) > 0.1 * std::abs(a[1]) / scale_N))
      continue;  // where it does not answer to the force
    sum[r.block] += (y[i] - X.row(i).dot(a)) / per_N;
    n[r.block] += 1.0;
  }
  for (std::size_t b = 0; b < blocks; ++b)
    sum[b] = n[b] >= static_cast<double>(kFewestRows) ? sum[b] / n[b] : std::nan("");
  return sum;
}

}  // namespace

CapacitanceWitness hear_capacitance(const CampaignInput& input) {
  CapacitanceWitness out;
  std::size_t blocks = 0;
  const std::vector<Row> rows = static_rows(input, blocks);
  if (blocks < kFewestBlocks || !(input.range_N > 0.0)) return out;
  const auto by_U = departure_N(rows, blocks, input.range_N, [](const Row& r) { return r.U_V; });
  const auto by_C = departure_N(rows, blocks, input.range_N, [](const Row& r) { return r.C_F; });
  double uu = 0, uc = 0;
  for (std::size_t b = 0; b < blocks; ++b) {
    if (!std::isfinite(by_U[b]) || !std::isfinite(by_C[b])) continue;
    uu += by_U[b] * by_U[b];
    uc += by_U[b] * by_C[b];
    ++out.blocks;
  }
  if (out.blocks < kFewestBlocks || !(uu > 0.0)) return out;
  out.share = uc / uu;
  // blocks in a row hang together as far as both what they regress on and what is left do
  double left = 0.0, left_next = 0.0, uu_next = 0.0, before_U = std::nan(""), before = before_U;
  for (std::size_t b = 0; b < blocks; ++b) {
    const double rest = by_C[b] - out.share * by_U[b];
    if (std::isfinite(rest)) left += rest * rest;
    if (std::isfinite(rest * before)) left_next += rest * before, uu_next += by_U[b] * before_U;
    before = rest, before_U = by_U[b];
  }
  constexpr double kMostTogether = 0.95;
  const double together = left > 0.0 ? std::clamp(left_next / left, 0.0, 1.0) * std::clamp(uu_next / uu, 0.0, 1.0) : 0.0, r = std::min(together, kMostTogether);
  out.u_share = std::sqrt(left / static_cast<double>(out.blocks - 1) / uu * (1.0 + r) / (1.0 - r));
  if (out.share - 2.0 * out.u_share > kReference)
    out.side = CapacitanceWitness::Side::reference;
  else if (out.share + 2.0 * out.u_share < kSensor)
    out.side = CapacitanceWitness::Side::sensor;
  return out;
}

void decide_by_capacitance(const CampaignInput& input, Finding& finding) {
  const CapacitanceWitness heard = hear_capacitance(input);
  finding.side_witnessed = heard.side != CapacitanceWitness::Side::unknown;
  const std::string share = with_uncertainty(heard.share, heard.u_share);
  if (heard.side == CapacitanceWitness::Side::reference) {
    finding.side = "reference";
    finding.evidence +=
        "; the capacitance departs from F_ref in the same way (share " + share + "): it is the reference";
  } else if (heard.side == CapacitanceWitness::Side::sensor) {
    finding.side = "sensor";
    finding.evidence += "; the capacitance stays with F_ref (share " + share +
                        "): it is the zero of the sensor's output, not the reference";
  } else if (heard.blocks >= kFewestBlocks) {
    finding.evidence += "; the capacitance shows a share of " + share + " of it, neither plainly all (the reference) nor plainly nothing (the sensor's own zero): the side cannot be told";
  } else if (std::ranges::any_of(input.records, [](const RecordInput& r) { return !r.C_F.empty(); })) {
    finding.evidence += "; static records show the capacitance for too short a time, and the side cannot be told: the sensor's own zero may drift";
  } else {
    finding.evidence += "; without a third channel the side cannot be told: the sensor's own zero may drift";
  }
}

}  // namespace forcegate::diagnose
