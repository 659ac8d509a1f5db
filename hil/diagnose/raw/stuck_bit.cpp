#include "hil/diagnose/raw/stuck_bit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "hil/base/evenly_chosen.h"
#include "hil/base/plain_number.h"
#include "hil/base/quantile.h"
#include "hil/diagnose/raw/force_and_output.h"
#include "hil/trace/static_line.h"

namespace forcegate::diagnose {

namespace {

// Some values of the output of all records, in rising order.
std::vector<double> some_values(const Campaign& campaign) {
  constexpr std::size_t kOfRecord = 8000;
  std::vector<double> out;
  for (const Record& record : campaign.records) {
    const Channel* output = record.trace.find("U");
    if (output == nullptr) continue;
    EvenlyChosen choice(output->value.size(), kOfRecord);
    for (const double U : output->value)
      if (choice.next() && std::isfinite(U)) out.push_back(U);
  }
  std::ranges::sort(out);
  return out;
}

struct Islands {
  double weight_V = 0.0, step_V = 0.0;
  std::vector<double> gaps_V;  // the middle of each, in rising order
};

// Of values in rising order, without the hundredth at either end, where a lost sample or a spike may stand alone.
std::optional<Islands> islands_of(const std::vector<double>& values) {
  constexpr std::size_t kFewest = 200;
  constexpr double kAlike = 0.75, kFilled = 0.25, kWide = 1.1;  // of the widest gap: other gaps, those within an island, an island
  if (values.size() < kFewest) return std::nullopt;
  const std::size_t tail = values.size() / 100, first = tail, last = values.size() - 1 - tail;
  double widest = 0.0;
  for (std::size_t i = first; i < last; ++i) widest = std::max(widest, values[i + 1] - values[i]);
  if (!(widest > 0.0)) return std::nullopt;
  std::vector<double> periods, steps, gaps;
  double island_begins = values[first], gap_begins = 0.0;
  const auto fits = [&](double end, bool whole) {
    const double width = end - island_begins;
    return width <= kWide * widest && (!whole || width >= kAlike * widest);
  };
  for (std::size_t i = first; i < last; ++i) {
    const double gap = values[i + 1] - values[i];
    if (gap < kFilled * widest) {
      if (gap > 0.0) steps.push_back(gap);
      continue;
    }
    if (gap < kAlike * widest || !fits(values[i], !gaps.empty())) return std::nullopt;
    if (!gaps.empty()) periods.push_back(values[i] - gap_begins);
    gaps.push_back(values[i] + 0.5 * gap);
    gap_begins = values[i], island_begins = values[i + 1];
  }
  if (gaps.empty() || steps.empty() || !fits(values[last], false)) return std::nullopt;
  return Islands{periods.empty() ? widest : 0.5 * median(periods), quantile(std::move(steps), 0.0), std::move(gaps)};
}

constexpr double kJump = 0.6, kOfWeight = 0.4;  // of the weight: the signal moves on meanwhile

// Between neighbouring samples.
struct Jumps {
  std::size_t of_weight = 0, within = 0, others = 0;  // within: of these, from one end of an island to the other

  void count(const std::vector<double>& U, const Islands& islands) {
    for (std::size_t i = 1; i < U.size(); ++i) {
      const auto [low, high] = std::minmax(U[i - 1], U[i]);
      const double size = high - low;
      if (!(size > kJump * islands.weight_V)) continue;
      if (std::abs(size - islands.weight_V) >= kOfWeight * islands.weight_V) {
        ++others;
        continue;
      }
      ++of_weight;
      const auto next = std::ranges::lower_bound(islands.gaps_V, low);
      if (next == islands.gaps_V.end() || *next > high) ++within;
    }
  }

  // The signal passes from end to end of an island as often as from one to the next; what only hops between two levels does not.
  bool are_of_bit() const {
    constexpr std::size_t kFewest = 6, kNearly = 9, kWithin = 5;
    return of_weight >= kFewest && others * kNearly <= of_weight && within * kWithin >= of_weight;
  }
};

// U over F.
struct Line {
  double slope = 0.0, level = 0.0;
};

class Mending {
 public:
  Mending(std::vector<ForceAndOutput> samples, double weight_V) : samples_(std::move(samples)), weight_V_(weight_V) {
    for (const ForceAndOutput& record : samples_) lacks_.emplace_back(record.size(), 0);
  }

  void run() {
    constexpr int kRounds = 2;  // the first by the slope that the recorded output has
    for (int round = 0; round < kRounds; ++round) {
      const double slope = line(0, samples_.size()).slope;
      chains_.clear();
      for (std::size_t k = 0; k < samples_.size(); ++k) follow_jumps(k, slope);
      decide_by_force(false);
      decide_by_force(true);
    }
  }

  const ForceAndOutput& samples(std::size_t record) const { return samples_[record]; }
  const std::vector<char>& lacks(std::size_t record) const { return lacks_[record]; }

 private:
  // Of one record: in it every jump is one of the bit.
  struct Chain {
    std::size_t record = 0, begin = 0, end = 0;
  };

  // Of the output as it stands now, through some records.
  Line line(std::size_t first, std::size_t last) const {
    StaticLine sums;
    for (std::size_t k = first; k < last; ++k)
      for (std::size_t i = 0; i < lacks_[k].size(); ++i) {
        const double F = samples_[k].F_N()[i], U = samples_[k].U_V()[i] + (lacks_[k][i] ? weight_V_ : 0.0);
        if (std::isfinite(F + U)) sums.push(U, F);
      }
    if (sums.n() == 0.0) return {};
    const double slope = sums.variance_N2() > 0.0 ? sums.covariance_VN() / sums.variance_N2() : 0.0;
    return {slope, sums.mean_V() - slope * sums.mean_N()};
  }

  // After a jump down, beside what the force does, the bit is missing, after one up it is there.
  void follow_jumps(std::size_t record, double slope) {
    const std::vector<double>&F = samples_[record].F_N(), &U = samples_[record].U_V();
    std::vector<char>& lacks = lacks_[record];
    Chain chain{record, 0, 0};
    bool known = false;
    lacks[0] = 0;
    for (std::size_t i = 1; i < U.size(); ++i) {
      const double step = slope * (F[i] - F[i - 1]);  // of the force; smaller ones are its rounding and noise
      const double change = U[i] - U[i - 1] - (std::abs(step) > weight_V_ ? step : 0.0), size = std::abs(change);
      lacks[i] = lacks[i - 1];
      if (std::abs(size - weight_V_) < kOfWeight * weight_V_) {
        lacks[i] = change < 0.0 ? 1 : 0;
        if (!std::exchange(known, true)) std::fill(lacks.begin() + static_cast<std::ptrdiff_t>(chain.begin), lacks.begin() + static_cast<std::ptrdiff_t>(i), lacks[i] ? 0 : 1);
      } else if (!(size < kJump * weight_V_)) {  // output and reference are not in step there, or samples are missing
        chain.end = i;
        chains_.push_back(chain);
        chain.begin = i, known = false;
      }
    }
    chain.end = U.size();
    chains_.push_back(chain);
  }

  // Whether a chain is the other way about: beside one line for all records, then beside that of each.
  void decide_by_force(bool own_lines) {
    constexpr int kRounds = 8;
    for (int round = 0; round < kRounds; ++round) {
      std::vector<Line> lines(samples_.size());
      if (own_lines)
        for (std::size_t k = 0; k < lines.size(); ++k) lines[k] = line(k, k + 1);
      else
        std::ranges::fill(lines, line(0, samples_.size()));
      bool turned = false;
      for (const Chain& chain : chains_)
        if (lies_better_turned(chain, lines[chain.record])) {
          turned = true;
          for (std::size_t i = chain.begin; i < chain.end; ++i) lacks_[chain.record][i] ^= 1;
        }
      if (!turned) return;
    }
  }

  bool lies_better_turned(const Chain& chain, const Line& line) const {
    const std::vector<double>&F = samples_[chain.record].F_N(), &U = samples_[chain.record].U_V();
    double more_V2 = 0.0;  // squares beside the line, if it were turned
    for (std::size_t i = chain.begin; i < chain.end; ++i) {
      const double beside = U[i] - line.level - line.slope * F[i];
      if (std::isfinite(beside)) more_V2 += (lacks_[chain.record][i] ? -1.0 : 1.0) * weight_V_ * (2.0 * beside + weight_V_);
    }
    return more_V2 < 0.0;
  }

  std::vector<ForceAndOutput> samples_;
  double weight_V_;
  std::vector<std::vector<char>> lacks_;  // the bit, for every sample
  std::vector<Chain> chains_;
};

double beside_line_V2(const std::vector<double>& F, const std::vector<double>& U) {
  const JointSquares s = joint_squares(F, U);
  return s.n > 0.0 ? (s.UU - (s.FF > 0.0 ? s.FU * s.FU / s.FF : 0.0)) / s.n : 0.0;
}

}  // namespace

std::optional<StuckBit> mend_stuck_bit(Campaign& campaign, std::vector<std::string>& notes) {
  constexpr double kSteps = 6.0, kGain = 0.5;
  const std::optional<Islands> islands = islands_of(some_values(campaign));
  if (!islands || islands->weight_V < kSteps * islands->step_V) return std::nullopt;
  const double weight_V = islands->weight_V;
  Jumps jumps;
  for (const Record& record : campaign.records)
    if (const Channel* output = record.trace.find("U")) jumps.count(output->value, *islands);
  if (!jumps.are_of_bit()) return std::nullopt;

  StuckBit out;
  out.weight_V = weight_V, out.step_V = islands->step_V;
  std::vector<ForceAndOutput> samples;
  for (const Record& record : campaign.records) {
    std::optional<ForceAndOutput> of_record = ForceAndOutput::of(record.trace);
    if (!of_record || of_record->size() == 0) return std::nullopt;
    samples.push_back(*std::move(of_record));
  }
  Mending mending(std::move(samples), weight_V);
  mending.run();

  std::vector<std::vector<double>> mended;
  double before_V2 = 0.0, after_V2 = 0.0, lost_V2 = 0.0;
  for (std::size_t k = 0; k < campaign.records.size(); ++k) {
    const ForceAndOutput& record = mending.samples(k);
    mended.push_back(record.U_V());
    double off = 0.0;
    for (std::size_t i = 0; i < record.size(); ++i)
      if (mending.lacks(k)[i]) mended.back()[i] += weight_V, off += 1.0;
    const auto n = static_cast<double>(record.size());
    out.samples += n, out.off += off;
    out.mean_square_V2.push_back(weight_V * weight_V * off / n * (1.0 - off / n));
    before_V2 += n * beside_line_V2(record.F_N(), record.U_V());
    after_V2 += n * beside_line_V2(record.F_N(), mended.back());
    lost_V2 += n * out.mean_square_V2.back();
  }
  if (!(lost_V2 > 0.0) || before_V2 - after_V2 < kGain * lost_V2) return std::nullopt;
  for (std::size_t k = 0; k < mended.size(); ++k)
    if (Channel* output = campaign.records[k].trace.find("U")) {
      mended[k].resize(output->value.size());
      output->value = std::move(mended[k]);
    }
  notes.push_back(fmt::format("one bit of the converter stands still: its weight, {}, was added to {:.2g} % of the samples, which lack it", plain_number(weight_V), 100.0 * out.off / out.samples));
  return out;
}

HealthClaim claim_of_stuck_bit(const StuckBit& bit, const std::string& unit) {
  return {"adc_codes", 0.95,
          fmt::format("one bit of the converter stands still: the values of the output leave gaps as wide as the stretches between them, and it jumps by that width where "
                      "the force passes from one to the next; {:.2g} % of the samples are off by it", 100.0 * bit.off / bit.samples),
          "bit_V", unit, bit.weight_V, std::max(bit.step_V, 0.01 * bit.weight_V)};
}

}  // namespace forcegate::diagnose
