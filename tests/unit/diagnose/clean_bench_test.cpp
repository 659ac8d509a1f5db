// Honest benches of many kinds: slow loggers, few codes, staircases, walkers. Nothing is missing on any of them.

#include <numbers>

#include "tests/unit/diagnose/made_campaign.h"

namespace forcegate::diagnose {
namespace {

struct Bench {
  std::string name;
  std::function<double(double t, int record)> force;
  double rate_Hz = 20.0, duration_s = 60.0;
  double noise_N = 0.002, step_N = 0.001;          // of the reference
  double noise_V = 0.003, low_V = 0.0, high_V = 10.0;
  int bits = 12;
  bool says_noise = true, says_step = true;
  int records = 6;
  double command_s = 0.0;  // that a command comes before its force; 0: there is none
};

void PrintTo(const Bench& b, std::ostream* out) { *out << b.name; }

Campaign measured(const Bench& b, std::uint64_t seed) {
  Campaign c = make_campaign(seed, straight, 0.0);
  c.records.resize(static_cast<std::size_t>(b.records));
  Rng rng(seed, b.name);
  const double lsb_V = (b.high_V - b.low_V) / std::exp2(b.bits);
  for (std::size_t k = 0; k < c.records.size(); ++k) {
    Trace& trace = c.records[k].trace;
    std::vector<double>&t = trace.time_bases[0].t_s, &F = trace.channels[0].value, &U = trace.channels[1].value;
    t.clear(), F.clear(), U.clear();
    std::vector<double> command;
    const double gain = 0.15 * b.high_V * (1.0 + 0.003 * rng.normal()), zero = 0.03 * b.high_V + 0.003 * rng.normal();
    for (int i = 0; i < static_cast<int>(b.duration_s * b.rate_Hz); ++i) {
      t.push_back((i + 0.2 * rng.uniform(-1.0, 1.0)) / b.rate_Hz);
      const double f = b.force(t.back(), static_cast<int>(k));
      F.push_back(std::round((f + b.noise_N * rng.normal()) / b.step_N) * b.step_N);
      U.push_back(std::clamp(std::round((gain * f + zero + b.noise_V * rng.normal()) / lsb_V) * lsb_V, b.low_V, b.high_V));
      if (b.command_s > 0.0) command.push_back(b.force(t.back() + b.command_s, static_cast<int>(k)));
    }
    if (!command.empty()) trace.channels.push_back({"F_cmd", "N", "force", 0, std::move(command), {}});
  }
  c.bench = {};
  if (b.says_noise) c.bench.reference_noise_N = b.noise_N;
  if (b.says_step) c.bench.reference_resolution_N = b.step_N;
  c.bench.voltage_min_V = b.low_V;
  c.bench.voltage_max_V = b.high_V;
  c.bench.adc_bits = b.bits;
  return c;
}

double stairs(double t, int record) {
  const double level_s = 5.0 + record, level = std::floor(std::min(t, 60.0 - t) / level_s);
  return 0.5 + 0.5 * level;
}

double walk(double t, int record) {
  const double phase = std::fmod(t * (0.8 + 0.05 * record), 1.0);
  return phase < 0.6 ? 4.0 * std::sin(std::numbers::pi * phase / 0.6) : 0.0;
}

double hand(double t, int record) {
  double out = 2.2;
  for (const double f : {0.11, 0.23, 0.57, 0.91}) out += 0.5 * std::sin(2.0 * std::numbers::pi * f * t + record * f * 31.0);
  return out;
}

double hold(double t, int record) { return t < 10.0 ? 0.3 : t < 40.0 ? 2.0 + 0.3 * record : 1.1; }

class CleanBench : public ::testing::TestWithParam<Bench> {};

TEST_P(CleanBench, MissesNothing) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Diagnosis d = answer(measured(GetParam(), seed));
    EXPECT_EQ(d.verdict, DiagnosisVerdict::none) << told(d);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Benches, CleanBench,
    ::testing::Values(Bench{.name = "a walker logged slowly", .force = walk, .rate_Hz = 5.0},
                      Bench{.name = "a walker", .force = walk, .rate_Hz = 20.0},
                      Bench{.name = "a hand logged slowly", .force = hand, .rate_Hz = 5.0, .noise_V = 0.03, .bits = 8},
                      Bench{.name = "a noisy reference in a hand", .force = hand, .rate_Hz = 10.0, .noise_N = 0.04, .step_N = 0.04},
                      Bench{.name = "a walking machine that is late", .force = walk, .rate_Hz = 25.0, .command_s = 0.045},
                      Bench{.name = "a walking machine logged slowly", .force = walk, .rate_Hz = 10.0, .command_s = 0.03},
                      Bench{.name = "a staircase read coarsely", .force = stairs, .rate_Hz = 100.0, .noise_N = 0.001, .step_N = 0.0167, .noise_V = 0.01, .low_V = -10.0, .bits = 8},
                      Bench{.name = "a staircase and nobody says how it is rounded", .force = stairs, .step_N = 0.0224, .says_step = false},
                      Bench{.name = "a staircase and a noisy output", .force = stairs, .rate_Hz = 25.0, .noise_V = 0.02, .bits = 10, .says_noise = false, .records = 3},
                      Bench{.name = "few levels of eight bits", .force = stairs, .rate_Hz = 25.0, .noise_V = 0.002, .bits = 8},
                      Bench{.name = "holds of eight bits", .force = hold, .rate_Hz = 20.0, .noise_V = 0.001, .bits = 8}),
    [](const auto& made) {
      std::string name = made.param.name;
      std::ranges::replace(name, ' ', '_');
      return name;
    });

}  // namespace
}  // namespace forcegate::diagnose
