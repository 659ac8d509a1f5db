#include "hil/diagnose/candidates/signatures.h"

#include <algorithm>
#include <cmath>

#include "hil/base/largest_first.h"
#include "hil/diagnose/base/base_fit.h"
#include "hil/diagnose/base/repeatability.h"
#include "hil/diagnose/workspace.h"
#include "hil/model/rows.h"
#include "hil/model/states.h"

namespace forcegate::diagnose {

namespace {

constexpr std::size_t kRowLimit = 2500;
constexpr double kPriorShare = 0.03;  // an effect of 3 % of the span is nothing unusual
constexpr int kSpareColumns = 24;  // at a time

// The candidate's columns on the chosen rows of record k and of all other blocks of the same recording. `room` is kept from
// candidate to candidate.
void write_columns(const CampaignInput& input, ResidualChannel& channel, std::size_t k, const Candidate& c,
                   Eigen::MatrixXd& room) {
  const RecordInput& r = input.records[channel.record_of[k]];
  const auto n = static_cast<Eigen::Index>(r.rows());
  if (room.rows() != n || room.cols() < c.count) room.resize(n, c.count);
  auto full = room.leftCols(c.count);
  r.for_each_wanted([&](std::size_t i) { full.row(static_cast<Eigen::Index>(i)).setZero(); });
  c.form->columns(input, r, c.shape, full);
  for (std::size_t b = k;
       b < channel.rows.size() && input.records[channel.record_of[b]].recording == r.recording; ++b) {
    RecordRows& rows = channel.rows[b];
    for (int j = 0; j < c.count; ++j)
      for (std::size_t i = 0; i < rows.row.size(); ++i) {
        const double v = full(static_cast<Eigen::Index>(rows.row[i]), j);
        rows.matrix(static_cast<Eigen::Index>(i), channel.problem.nz + c.first + j) =
            std::isfinite(v) ? v * channel.column_factor : 0.0;
      }
  }
}

// First block of every recording.
std::vector<std::size_t> recordings(const CampaignInput& input, const ResidualChannel& channel) {
  std::vector<std::size_t> out;
  for (std::size_t k = 0; k < channel.rows.size(); ++k)
    if (k == 0 ||
        input.records[channel.record_of[k]].recording != input.records[channel.record_of[k - 1]].recording)
      out.push_back(k);
  return out;
}

// All candidates; a single recording is divided by candidates, many recordings by recordings.
void write_all_columns(const CampaignInput& input, ResidualChannel& channel, unsigned threads) {
  const std::vector<std::size_t> first = recordings(input, channel);
  std::vector<std::size_t> cost(channel.candidates.size(), 1);
  if (first.size() > 1) {
    cost.clear();
    for (const std::size_t k : first) cost.push_back(input.records[channel.record_of[k]].rows());
  }
  parallel_for_largest_first(cost, threads, [&](std::size_t p) {
    Eigen::MatrixXd room;
    const auto write = [&](std::size_t k, const Candidate& c) {
      if (c.is_read) write_columns(input, channel, k, c, room);
    };
    if (first.size() == 1) {
      write(first.front(), channel.candidates[p]);
      return;
    }
    for (const Candidate& c : channel.candidates) write(first[p], c);
  });
}

double column_prior(const MixedProblem& p, int column) {
  double mean_square = 0.0;
  for (const RecordGram& g : p.records) mean_square += g.gram(p.nz + column, p.nz + column);
  const double rms = std::sqrt(mean_square / std::max<double>(1.0, static_cast<double>(p.records.size())));
  return rms > 1e-9 ? std::min(3.0, kPriorShare / rms) : 1e-6;
}

// Rows of one record but for the candidates' columns.
void start_record(ResidualChannel& channel, std::size_t k, const Eigen::MatrixXd& Z,
                  const std::vector<double>& y) {
  RecordRows& rows = channel.rows[k];
  const auto n = static_cast<Eigen::Index>(rows.row.size());
  const int nz = channel.problem.nz, ns = channel.problem.ns;
  rows.matrix = Eigen::MatrixXd::Zero(n, nz + ns + 1);
  rows.matrix.leftCols(nz) = Z;
  for (Eigen::Index i = 0; i < n; ++i) rows.matrix(i, nz + ns) = y[static_cast<std::size_t>(i)];
}

void finish_record(ResidualChannel& channel, std::size_t k) {
  const Eigen::MatrixXd& A = channel.rows[k].matrix;
  Eigen::MatrixXd& G = channel.problem.records[k].gram;
  G = Eigen::MatrixXd::Zero(A.cols(), A.cols());
  if (A.rows() == 0) return;  // Eigen divides by the number of rows
  G.selfadjointView<Eigen::Lower>().rankUpdate(A.transpose(),
                                               1.0 / std::max<double>(1.0, static_cast<double>(A.rows())));
  G.triangularView<Eigen::StrictlyUpper>() = G.transpose();
}

void finish_records(const CampaignInput& input, ResidualChannel& channel, unsigned threads) {
  write_all_columns(input, channel, threads);
  parallel_for(channel.rows.size(), threads, [&](std::size_t k) { finish_record(channel, k); });
}

void reserve_spare(ResidualChannel& channel) {
  channel.first_spare = channel.problem.ns;
  channel.problem.ns += kSpareColumns;
}

// Empty columns before the last, which is y.
void insert_columns(Eigen::MatrixXd& matrix, Eigen::Index count) {
  const Eigen::Index last = matrix.cols() - 1;
  if (last < 0) return;
  matrix.conservativeResize(Eigen::NoChange, last + count + 1);
  matrix.col(last + count) = Eigen::VectorXd(matrix.col(last));
  matrix.middleCols(last, count).setZero();
}

void widen(ResidualChannel& channel, int columns) {
  MixedProblem& p = channel.problem;
  for (RecordRows& rows : channel.rows) insert_columns(rows.matrix, columns);
  for (RecordGram& record : p.records) {
    insert_columns(record.gram, columns);
    record.gram.transposeInPlace();
    insert_columns(record.gram, columns);
  }
  p.ns += columns;
  p.column_prior_sd.conservativeResizeLike(Eigen::VectorXd::Zero(p.ns));
  if (p.column_prior_mean.size() > 0) p.column_prior_mean.conservativeResizeLike(Eigen::VectorXd::Zero(p.ns));
  if (!p.grows_with_gain.empty()) p.grows_with_gain.resize(static_cast<std::size_t>(p.ns), GrowsWithGain::never);
}

void tell_what_grows(ResidualChannel& channel, const Candidate& c) {
  std::vector<GrowsWithGain>& grows = channel.problem.grows_with_gain;
  if (grows.empty()) return;
  const EffectTraits& t = c.kind->traits;
  std::fill_n(grows.begin() + c.first, c.count, t.at_voltages ? GrowsWithGain::never : t.between_records ? GrowsWithGain::is_gain : GrowsWithGain::with_it);
}

void set_column_priors(ResidualChannel& channel) {
  MixedProblem& p = channel.problem;
  p.column_prior_sd.resize(p.ns);
  p.column_prior_mean = Eigen::VectorXd::Zero(p.ns);
  for (int j = 0; j < p.ns; ++j) p.column_prior_sd[j] = column_prior(p, j);
  for (const Candidate& c : channel.candidates)
    for (std::size_t j = 0; j < c.written.size(); ++j) p.column_prior_mean[c.first + static_cast<int>(j)] = c.written[j] * channel.gain_of_unit;
}

}  // namespace

void want_rows(CampaignInput& input, const RowsOfRecords& rows) {
  // blocks of one recording read the columns of its first block
  for (std::size_t first = 0, end = 0; first < input.records.size(); first = end) {
    std::vector<std::uint32_t> wanted;
    for (end = first; end < input.records.size() && input.records[end].recording == input.records[first].recording; ++end)
      for (const std::size_t row : rows[end]) wanted.push_back(static_cast<std::uint32_t>(row));
    std::ranges::sort(wanted);
    wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
    for (std::size_t k = first; k < end; ++k) input.records[k].wanted = wanted;
  }
}

void choose_wanted_rows(CampaignInput& input) {
  RowsOfRecords rows;
  for (const RecordInput& r : input.records) rows.push_back(choose_rows(r, kRowLimit));
  want_rows(input, rows);
}

void fill_candidate(const CampaignInput& input, ResidualChannel& channel, const Candidate& c,
                    unsigned threads, const std::vector<int>* beside) {
  const int nz = channel.problem.nz;
  std::vector<int> with;  // of Z, of S, y
  if (beside != nullptr) {
    for (int j = 0; j < nz; ++j) with.push_back(j);
    for (const int j : *beside) with.push_back(nz + j);
    for (int j = 0; j < c.count; ++j) with.push_back(nz + c.first + j);
    with.push_back(channel.problem.y_index());
  }
  const std::vector<std::size_t> first = recordings(input, channel);
  parallel_for(first.size(), threads, [&](std::size_t p) {
    Eigen::MatrixXd room;
    write_columns(input, channel, first[p], c, room);
  });
  parallel_for(channel.rows.size(), threads, [&](std::size_t k) {
    const Eigen::MatrixXd& A = channel.rows[k].matrix;
    Eigen::MatrixXd& G = channel.problem.records[k].gram;
    const double n = std::max<double>(1.0, static_cast<double>(A.rows()));
    if (beside != nullptr) {
      for (int j = nz + c.first; j < nz + c.first + c.count; ++j)
        for (const int i : with) G(i, j) = G(j, i) = A.col(i).dot(A.col(j)) / n;
      return;
    }
    const Eigen::MatrixXd cross = A.transpose() * A.middleCols(nz + c.first, c.count) / n;
    G.middleCols(nz + c.first, c.count) = cross;
    G.middleRows(nz + c.first, c.count) = cross.transpose();
  });
  for (int j = 0; j < c.count; ++j)
    channel.problem.column_prior_sd[c.first + j] = column_prior(channel.problem, c.first + j);
  tell_what_grows(channel, c);
}

std::vector<int> columns_of(const Candidate& c) {
  std::vector<int> out;
  for (int j = 0; j < c.count; ++j) out.push_back(c.first + j);
  return out;
}

int place_candidate(ResidualChannel& channel, Candidate candidate) {
  if (channel.first_spare + candidate.count > channel.problem.ns) widen(channel, std::max(kSpareColumns, candidate.count));
  candidate.first = channel.first_spare;
  channel.first_spare += candidate.count;
  channel.candidates.push_back(std::move(candidate));
  return static_cast<int>(channel.candidates.size()) - 1;
}

void list_candidates(const Workspace& w, EffectChannel which, bool drift_in_output, ResidualChannel& out,
                     const std::vector<std::string>* only, const std::vector<Candidate>& of_model) {
  const auto add = [&](const EffectKind& kind) {
    // one recording has no other to be compared with
    if (w.input.single && kind.traits.needs_records) return;
    if (only != nullptr && std::find(only->begin(), only->end(), kind.name) == only->end()) return;
    // the drive has a channel of its own
    if (only == nullptr && kind.name == "motor") return;
    const RigShows rig = which == EffectChannel::output && kind.name == "reference_drift" ? w.rig_shows : RigShows::nothing;
    for (const EffectForm& form : kind.forms) {
      if (form.after_rig != RigShows::nothing && form.after_rig != rig) continue;
      if (!form.beside.empty() && std::ranges::none_of(of_model, [&](const Candidate& c) { return c.kind->name == form.beside; })) continue;
      for (const std::vector<double>& shape : form.grid(w.input)) {
        Candidate c{&kind, &form, shape, out.problem.ns, static_cast<int>(form.strength.size())};
        const int index = static_cast<int>(out.candidates.size());
        const std::vector<int> all = columns_of(c);
        // courses that the rig shows better are there to be carried along, or asked of what it does not show; banks of what acts together to soak
        // up: they do not compete
        const bool only_soaks = form.bank && !form.beside.empty(), is_shown = rig != RigShows::nothing && form.after_rig != rig;
        if (!only_soaks && !(is_shown && rig == RigShows::zero_of_records)) {
          out.variants.push_back({index, all, is_shown});
          if (form.singles && c.count > 1)
            for (int j : all) out.variants.push_back({index, {j}, is_shown});
        }
        out.problem.ns += c.count;
        out.candidates.push_back(std::move(c));
      }
    }
  };
  for (const EffectKind& kind : EffectRegistry::instance().all()) {
    const bool drift = drift_in_output && kind.name == "reference_drift";
    if (drift || (kind.channel == which && is_available(kind, w.input))) add(kind);
  }
  if (which == EffectChannel::output)
    for (const auto& kind : w.user_kinds) add(*kind);
}

ResidualChannel output_channel(const Workspace& w, unsigned threads, const std::vector<Candidate>& of_model, const ListedOnly* only,
                               const RowsOfRecords* rows) {
  ResidualChannel channel;
  channel.scale = w.input.U_range_V;
  channel.unit = w.output.unit;
  set_repeatability(channel.problem, w.input.single, w.zero_wanders, w.tells_swing);
  list_candidates(w, EffectChannel::output, true, channel, only != nullptr ? &only->families : nullptr, of_model);
  if (only != nullptr && only->is_read)
    for (Candidate& c : channel.candidates) c.is_read = only->is_read(c);
  for (Candidate c : of_model) {
    c.first = channel.problem.ns;
    channel.problem.ns += c.count;
    channel.candidates.push_back(std::move(c));
  }
  reserve_spare(channel);
  channel.signs_known = !w.input.generic;
  // where the output hardly follows the input, its slope is no measure of an effect
  const double whole = w.input.U_range_V / w.input.range_N;
  const double gain = w.input.generic && std::abs(w.gain_V_per_N) < 0.2 * whole
                          ? std::copysign(0.2 * whole, w.gain_V_per_N)
                          : w.gain_V_per_N;
  channel.column_factor = gain / channel.scale;
  channel.gain_of_unit = gain != 0.0 ? w.gain_V_per_N / gain : 1.0;
  const std::size_t n = w.input.records.size();
  channel.rows.resize(n);
  channel.problem.records.resize(n);
  for (std::size_t k = 0; k < n; ++k) channel.record_of.push_back(k);
  parallel_for(n, threads, [&](std::size_t k) {
    const RecordInput& r = w.input.records[k];
    channel.rows[k].row = rows != nullptr ? (*rows)[k] : choose_rows(r, kRowLimit);
    const Eigen::MatrixXd Z = repeatability_columns(w, k, channel.rows[k].row);
    std::vector<double> y;
    for (std::size_t j = 0; j < channel.rows[k].row.size(); ++j) {
      const auto row = static_cast<Eigen::Index>(j);
      y.push_back(r.U_V[channel.rows[k].row[j]] / channel.scale + Z(row, 2) * w.shifts[k].log_b +
                  Z(row, 3) * w.shifts[k].log_q);
    }
    RecordGram& gram = channel.problem.records[k];
    gram.name = r.name;
    gram.n_eff = effective_samples(y.size());
    gram.noise_variance = std::pow(w.white_V[k] / channel.scale, 2) + 1e-8;
    gram.allowed_variance = std::pow(w.noise_V[k] / channel.scale, 2) + 1e-8;
    gram.smoothed_variance = std::pow(w.smoothed_V[k] / channel.scale, 2);
    gram.heldout = r.heldout && w.judges == JudgedBy::heldout;
    start_record(channel, k, Z, y);
  });
  finish_records(w.input, channel, threads);
  set_column_priors(channel);
  const bool decays = w.law.decays && std::ranges::any_of(w.input.records, &RecordInput::dynamic);
  if (decays) size_swing(channel.problem);
  // beside a decay the swing of a record has a size of its own, and most of what effects add goes with that
  if (w.input.generic || decays) return channel;
  channel.problem.grows_with_gain.assign(static_cast<std::size_t>(channel.problem.ns), GrowsWithGain::never);
  for (const Candidate& c : channel.candidates) tell_what_grows(channel, c);
  return channel;
}

void build_output_channel(Workspace& w, unsigned threads, const std::vector<Candidate>& of_model, const ListedOnly* only) {
  std::string unit = std::move(w.output.unit);
  w.output = ResidualChannel{};
  w.output.unit = std::move(unit);
  w.output = output_channel(w, threads, of_model, only);
}

void fill_channel(const Workspace& w, ResidualChannel& channel, unsigned threads, const FillRows& fill, const LeaveOutRows& leave_out) {
  MixedProblem& p = channel.problem;
  reserve_spare(channel);
  channel.column_factor = 1.0 / channel.scale;
  const std::size_t n = channel.record_of.size();
  channel.rows.resize(n);
  p.records.resize(n);
  parallel_for(n, threads, [&](std::size_t k) {
    const RecordInput& r = w.input.records[channel.record_of[k]];
    channel.rows[k].row = choose_rows(r, kRowLimit);
    if (leave_out) leave_out(r, channel.rows[k].row);
    const auto& rows = channel.rows[k].row;
    Eigen::MatrixXd Z = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows.size()), p.nz);
    std::vector<double> y;
    fill(r, rows, Z, y);
    RecordGram& gram = p.records[k];
    gram.name = r.name;
    gram.n_eff = effective_samples(y.size());
    const RecordHealth* h =
        channel.record_of[k] < w.health.size() ? &w.health[channel.record_of[k]] : nullptr;
    const double step = h != nullptr ? h->lsb_F_N : 0.0, white = h != nullptr ? h->noise_F_N : 0.0;
    const double per_row = std::max<double>(1.0, r.row_begin[1] - r.row_begin[0]);
    gram.allowed_variance =
        (step * step / 12.0 + white * white / per_row) / (channel.scale * channel.scale) + 1e-7;
    gram.noise_variance = 0.25 * gram.allowed_variance;
    gram.heldout = r.heldout && w.judges == JudgedBy::heldout;
    start_record(channel, k, Z, y);
  });
  finish_records(w.input, channel, threads);
  set_column_priors(channel);
}

}  // namespace forcegate::diagnose
