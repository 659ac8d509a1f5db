// Compare, screening and diagnosis of 10 records with 2.5 M rows, and their parts against bare loops over 1.2 M rows
// that do the same arithmetic, in one run. CPU time, best of some runs; the whole also by the clock on the wall.

#include <sys/resource.h>
#include <unistd.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "hil/app/diagnose/diagnose.h"
#include "hil/app/model/compare.h"
#include "hil/base/rng.h"
#include "hil/diagnose/answer/residual_map.h"
#include "hil/diagnose/answer/remainder.h"
#include "hil/diagnose/base/base_fit.h"
#include "hil/diagnose/candidates/signatures.h"
#include "hil/diagnose/choose/screen.h"
#include "hil/diagnose/engine.h"
#include "hil/model/play.h"
#include "hil/model/rows.h"
#include "hil/model/states.h"
#include "rigs/emulated/hidden/campaign_maker.h"
#include "rigs/emulated/hidden/campaign_writer.h"
#include "tests/speed/best_of.h"

namespace {

using namespace forcegate;
using namespace forcegate::speed;

constexpr std::size_t kRows = 1200000, kCycles = 300;

struct Bench {
  std::vector<double> t_s, F_N, U_V;
};

/// 20 minutes at 1 kHz, 0.25 Hz, decaying as the paper says, with a loop and noise.
Bench bench() {
  Bench b;
  Rng rng(1, "bench");
  Play play(0.2, 2.0);
  for (std::size_t i = 0; i < kRows; ++i) {
    const double t = 1e-3 * static_cast<double>(i), F = 2.2 - 1.6 * std::cos(1.5707963267949 * t);
    const double D = (std::exp(-0.006 * t) + 0.25) / 1.25;
    b.t_s.push_back(t);
    b.F_N.push_back(F);
    b.U_V.push_back(2.0 * (0.6 + D * (F - 0.6)) + 0.1 * play.step(F) + rng.normal(0.0, 0.004));
  }
  return b;
}

void row(const char* what, double bare_s, double ours_s, const char* note) {
  std::printf("%-34s bare %9.2f ms   ours %9.2f ms   ratio %6.2f   %s\n", what, 1e3 * bare_s, 1e3 * ours_s,
              ours_s / bare_s, note);
}

/// Streamed normal equations of 43 terms: powers and products of four signals, plays of ten radii, lags of three.
double bare_screening(const Bench& b) {
  constexpr int kTerms = 43, kChunk = 250;
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(kTerms + 1, kTerms + 1), rows(kChunk, kTerms + 1);
  std::array<double, 10> play{};
  double lag = b.F_N[0];
  for (std::size_t i = 0; i < kRows; i += kChunk) {
    for (std::size_t k = 0; k < kChunk; ++k) {
      const double F = b.F_N[i + k], t = 1e-3 * b.t_s[i + k];
      lag += 0.02 * (F - lag);
      const auto r = static_cast<Eigen::Index>(k);
      int c = 0;
      double power = 1.0;
      for (int p = 0; p < 8; ++p, power *= F)
        rows(r, c++) = power, rows(r, c++) = power * lag, rows(r, c++) = power * t;
      for (std::size_t j = 0; j < play.size(); ++j) {
        const double radius = 0.05 * static_cast<double>(j + 1);
        play[j] = std::min(std::max(play[j], F - radius), F + radius);
        rows(r, c++) = play[j];
      }
      while (c < kTerms) {
        rows(r, c) = rows(r, c - 24) * rows(r, c - 10);
        ++c;
      }
      rows(r, kTerms) = b.U_V[i + k];
    }
    gram.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
  }
  Eigen::MatrixXd A = gram.topLeftCorner(kTerms, kTerms).selfadjointView<Eigen::Lower>();
  A.diagonal().array() += 1e-9 * A.trace();
  return A.llt().solve(gram.row(kTerms).head(kTerms).transpose()).squaredNorm();
}

/// 1000 resamplings of 300 cycles, each with its 43 x 43 normal equations.
double bare_bags() {
  std::vector<Eigen::MatrixXd> gram(kCycles);
  Rng rng(2, "bags");
  for (auto& g : gram) {
    Eigen::MatrixXd x(60, 44);
    for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] = rng.uniform(-1.0, 1.0);
    g = x.transpose() * x;
  }
  return best_cpu_s(1, [&] {
    double sum = 0.0;
    for (int bag = 0; bag < 1000; ++bag) {
      Eigen::MatrixXd total = Eigen::MatrixXd::Zero(44, 44);
      for (std::size_t k = 0; k < kCycles; ++k) total += gram[rng.below(kCycles)];
      sum += total.topLeftCorner(43, 43).llt().solve(total.col(43).head(43))[0];
    }
    sink = sum;
  });
}

/// Levenberg-Marquardt on gain, offset, ln b and ln q over all rows, 13 passes.
double bare_waveform(const Bench& b) {
  Eigen::Vector4d p(2.0, 0.1, std::log(0.004), std::log(0.3));
  for (int pass = 0; pass < 13; ++pass) {
    Eigen::Matrix4d A = Eigen::Matrix4d::Zero();
    Eigen::Vector4d g = Eigen::Vector4d::Zero();
    const double rate = std::exp(p[2]), q = std::exp(p[3]), per = 1.0 / (1.0 + q);
    for (std::size_t i = 0; i < kRows; ++i) {
      const double t = b.t_s[i], e = std::exp(-rate * t), D = (e + q) * per, swing = b.F_N[i] - 0.6;
      const Eigen::Vector4d j(0.6 + D * swing, 1.0, -p[0] * swing * rate * t * e * per,
                              p[0] * swing * q * (1.0 - e) * per * per);
      const double residual = b.U_V[i] - p[0] * j[0] - p[1];
      A.noalias() += j * j.transpose();
      g.noalias() += residual * j;
    }
    p += A.ldlt().solve(g).cwiseMax(-0.5).cwiseMin(0.5);
  }
  return p.sum();
}

double bare_states(const Bench& b) {
  std::array<double, 10> play{};
  double lag = b.F_N[0], sum = 0.0;
  const double keep = std::exp(-1e-3 / 0.05);
  for (std::size_t i = 0; i < kRows; ++i) {
    const double F = b.F_N[i];
    lag = keep * lag + (1.0 - keep) * F;
    for (std::size_t j = 0; j < play.size(); ++j) {
      const double radius = 0.05 * static_cast<double>(j + 1);
      play[j] = std::min(std::max(play[j], F - radius), F + radius);
      sum += play[j];
    }
    sum += lag;
  }
  return sum;
}

double our_states(const Bench& b) {
  std::vector<Play> play;
  for (int j = 0; j < 10; ++j) play.emplace_back(0.05 * (j + 1), 0.0);
  LowPass lag(0.05, b.F_N[0]);
  double sum = 0.0;
  for (std::size_t i = 1; i < kRows; ++i) {
    sum += lag.step(b.F_N[i - 1], b.F_N[i], b.t_s[i] - b.t_s[i - 1]);
    for (Play& p : play) sum += p.step(b.F_N[i]);
  }
  return sum;
}

/// Autocorrelation at 200 lags spread over six decades, and of the residual with the input at as many.
double bare_residual_tests(const Bench& b) {
  double sum = 0.0;
  std::size_t before = 0;
  for (int k = 0; k < 200; ++k) {
    const auto lag = static_cast<std::size_t>(std::pow(10.0, 5.0 * k / 199.0));
    if (lag == before) continue;
    before = lag;
    double own = 0.0, cross = 0.0;
    for (std::size_t i = lag; i < kRows; ++i)
      own += b.U_V[i] * b.U_V[i - lag], cross += b.U_V[i] * b.F_N[i - lag];
    sum += own + cross;
  }
  return sum;
}

double bare_map(const Bench& b) {
  std::array<double, 1600> total{}, count{};
  for (std::size_t i = 0; i < kRows; ++i) {
    const auto x = static_cast<std::size_t>(b.F_N[i] * 10.0), y = static_cast<std::size_t>(b.t_s[i] / 30.001);
    const std::size_t cell = std::min<std::size_t>(1599, 40 * x + y);
    total[cell] += b.U_V[i];
    count[cell] += 1.0;
  }
  return total[7] / (count[7] + 1.0);
}

Campaign campaign_of(const Bench& b) {
  Campaign campaign;
  campaign.name = "bench";
  Record record;
  record.name = "r1";
  record.kind = "sine";
  record.trace.time_bases.push_back({"rig", b.t_s, 1000.0, {}, false});
  record.trace.channels.push_back({"F_ref", "N", "force", 0, b.F_N, {}});
  record.trace.channels.push_back({"U", "V", "voltage", 0, b.U_V, {}});
  campaign.records.push_back(std::move(record));
  return campaign;
}

void parts() {
  const Bench b = bench();
  diagnose::EngineOptions one;
  one.threads = 1;
  one.pictures = false;
  const auto workspace = diagnose::prepare(campaign_of(b), one);
  if (!workspace) std::exit(1);
  diagnose::Workspace& w = **workspace;
  const auto& channel = w.output;
  std::printf("parts on 1.2 M rows (one thread); ours works on %d candidate columns in %zu variants\n",
              channel.problem.ns, channel.variants.size());

  const double gram = best_cpu_s(3, [&] { sink = bare_screening(b); });
  const double build = best_cpu_s(3, [&] { diagnose::build_output_channel(w, 1, {}); });
  const double screening =
      best_cpu_s(3, [&] { sink = diagnose::screen(channel, {}, {}, nullptr, 1).base.log_evidence; });
  row("Gram of 43 terms / our signatures", gram, build, "signatures and Gram matrices of all effects");
  row("  and the screening on them", gram, screening, "every variant fitted with its own variances");

  const diagnose::MixedFit base = diagnose::fit_mixed(channel.problem, {}, nullptr, 20);
  const double bags = bare_bags();
  const double refits = best_cpu_s(1, [&] {
    for (int k = 0; k < 1000; ++k)
      sink = diagnose::fit_mixed(channel.problem, {0, 1, 2, 3}, &base, 9).log_evidence;
  });
  row("1000 bags / 1000 refits", bags, refits, "mixed model with four columns, nine rounds of EM");

  const double waveform = best_cpu_s(2, [&] { sink = bare_waveform(b); });
  const Campaign campaign = campaign_of(b);
  const double base_fit = best_cpu_s(3, [&] {
    auto input = make_campaign_input(campaign);
    if (!input) std::exit(1);
    diagnose::Workspace fresh;
    fresh.input = std::move(*input);
    fresh.judges = JudgedBy::left_out;
    diagnose::fit_base(fresh);
    sink = fresh.gain_V_per_N;
  });
  row("waveform fit, 13 passes", waveform, base_fit, "rows and base law with its repeatability");
  row("lag and 10 plays, 1.2 M steps", best_cpu_s(5, [&] { sink = bare_states(b); }),
      best_cpu_s(5, [&] { sink = our_states(b); }), "");

  const auto residual = diagnose::residual_rows(channel, base);
  row("residual tests, 200 lags", best_cpu_s(1, [&] { sink = bare_residual_tests(b); }),
      best_cpu_s(3, [&] { sink = diagnose::structure_of(channel, diagnose::residual_rows(channel, base)).rms; }),
      "structure against noise, on rows");
  row("a map of 40 x 40", best_cpu_s(5, [&] { sink = bare_map(b); }),
      best_cpu_s(3, [&] { sink = diagnose::residual_maps(w, residual).front().share; }),
      "all coordinates, on rows");
}

double peak_MB() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

/// argv[0] again with a verb, so that each has its own peak of memory.
void whole(const char* self, const char* verb, const std::filesystem::path& folder) {
  const std::string command = std::string(self) + " " + verb + " '" + folder.string() + "'";
  std::fflush(stdout);
  if (std::system(command.c_str()) != 0) std::exit(1);
}

int one(const std::string& verb, const std::string& folder) {
  const CampaignRequest request{folder, "", {}, 0.0, 2};
  double cpu = 1e9;
  const double wall = best_wall_s(3, [&] {
    const double start = cpu_s();
    if (verb == "read") {
      auto campaign = load_campaign(request);
      if (!campaign) std::exit(1);
      sink = static_cast<double>(campaign->records.size());
    } else if (verb == "compare") {
      auto comparison = compare_request(request);
      if (!comparison) std::exit(1);
      sink = comparison->view.floor;
    } else {
      auto diagnosis = diagnose_request(request);
      if (!diagnosis) std::exit(1);
      sink = diagnosis->floor;
    }
    cpu = std::min(cpu, cpu_s() - start);
  });
  std::printf("%-10s 10 records, 2.5 M rows, 2 threads: %6.2f s on the wall, %6.2f s of CPU, peak %4.0f MB\n",
              verb.c_str(), wall, cpu, peak_MB());
  return 0;
}

/// Ten records, long enough for 2.5 M rows in all.
bool write_large(const std::filesystem::path& folder) {
  hidden::CampaignRequest request{3, "large", {"hysteresis"}, hidden::Tier::medium, 50.0};
  for (; request.seed < 4000; ++request.seed) {
    auto quick = hidden::make_campaign_at({request.seed, "large", {}, hidden::Tier::none, 1.0}, {});
    if (!quick || quick->records.size() != 10) continue;
    auto made = hidden::make_campaign_at(request, {1.0});
    if (!made) return false;
    std::size_t rows = 0;
    for (const auto& record : made->records) rows += record.stamp_s.size();
    if (rows < 2400000 || rows > 2700000) continue;
    std::printf("campaign of seed %llu: %zu rows\n", static_cast<unsigned long long>(request.seed), rows);
    return hidden::write_campaign(*made, folder, true).has_value();
  }
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3) return one(argv[1], argv[2]);
  const auto folder =
      std::filesystem::temp_directory_path() / ("forcegate_speed_" + std::to_string(::getpid()));
  if (!write_large(folder)) return 1;
  for (const char* verb : {"read", "compare", "diagnose"}) whole(argv[0], verb, folder);
  std::filesystem::remove_all(folder);
  parts();
}
