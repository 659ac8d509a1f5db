// The rig must be physics, not eq. (3)-(5) played back. Each procedure here is run on the emulated rig and on a rig that
// computes the output from the time since the start of the record by the laws: the procedure must tell them apart.

#include <gtest/gtest.h>

#include <cmath>

#include "hil/characterize/sequence.h"
#include "tests/unit/characterize/study.h"

namespace forcegate::test {
namespace {

using namespace characterize;

/// U = (Fmin + r(t) (F - Fmin) - F0) / G with r(t) = (exp(-b t) + q) / (1 + q), b and q by eq. (5) for f = 0.5 Hz and
/// A = 1.5 N, t since the start of the record, Fmin = 1.2 N.
class PlaybackRig final : public Rig {
 public:
  PlaybackRig() : inner_(value_or_abort(make_rig("emulated", {{"session_spread", "off"}}))) {}
  RigInfo info() const override { return inner_->info(); }
  Result<void> begin(const RigRecordRequest& request) override { return inner_->begin(request); }
  Result<void> command_velocity(double v) override { return inner_->command_velocity(v); }
  double theta_rad() const override { return inner_->theta_rad(); }
  double force_ref_N() const override { return inner_->force_ref_N(); }
  void park() noexcept override { inner_->park(); }
  Result<std::size_t> run(std::size_t n, RigBlock& out, std::size_t at) override {
    auto got = inner_->run(n, out, at);
    if (!got) return got;
    const double b = 0.0019 * 0.5 + 0.0056, q = 1.0 / (1.0 + 1.377 * 2.25);
    for (std::size_t i = at; i < at + *got; ++i) {
      const double r = (std::exp(-b * out.t_s[i]) + q) / (1.0 + q),
                   force = static_cast<double>(out.force_ref_N[i]);
      const double volts = (1.2 + r * (force - 1.2) - 0.15) / 0.5;
      out.adc[i] = static_cast<std::uint16_t>(std::lround(std::clamp(volts / 10.0, 0.0, 1.0) * 65535.0));
    }
    return got;
  }

 private:
  std::unique_ptr<Rig> inner_;
};

/// The named procedure on a rig, after a calibration that both rigs share.
SessionSheet play(Rig& rig, const std::string& procedure, StudyPlan plan) {
  BenchProgress progress;
  Bench::Setup setup;
  setup.specimen = "nominal";
  Bench bench(rig, setup, progress);
  const CompensationMaker none;
  Session session(bench, plan, "flexiforce", none, false);
  session.calibrated = true;
  SessionSheet sheet = run_session(session, {procedure});
  EXPECT_FALSE(sheet.failure.has_value()) << (sheet.failure ? sheet.failure->to_text() : "");
  return sheet;
}

struct Both {
  SessionSheet film, playback;
};

Both play_on_both(const std::string& procedure, const StudyPlan& plan) {
  const auto emulated = value_or_abort(make_rig("emulated", {{"session_spread", "off"}}));
  PlaybackRig playback;
  return {play(*emulated, procedure, plan), play(playback, procedure, plan)};
}

TEST(Playback, does_not_recover_at_rest) {
  StudyPlan plan = plan_of_the_paper();
  plan.recovery_s = {7200.0};
  const Both both = play_on_both("recovery", plan);
  EXPECT_NEAR(both.film.value("recovery.7200"), 100.0, 4.0);
  EXPECT_LT(both.playback.value("recovery.7200"), 30.0);
}

TEST(Playback, has_no_bump_at_a_jump_of_the_frequency) {
  const Both both = play_on_both("frequency_jump", plan_of_the_paper());
  EXPECT_GT(both.film.value("jump.bump"), 10.0);
  EXPECT_LT(std::abs(both.playback.value("jump.bump")), 2.0);
}

TEST(Playback, leaves_no_residue_in_the_static_gain) {
  const Both both = play_on_both("cycling_gain", plan_of_the_paper());
  EXPECT_NEAR(both.film.value("cycling.gain"), 7.0, 2.0);
  EXPECT_GT(both.playback.value("cycling.gain"), 100.0);  // the sweep itself is shrunk by the law
}

/// Swing of the maxima in [from_s, to_s) on both rigs.
struct Swings {
  double film = 0, playback = 0;
};

template <class Make>
std::vector<Swings> swings(const Make& make, double low_N,
                           const std::vector<std::pair<double, double>>& spans) {
  std::vector<Swings> out(spans.size());
  const auto emulated = value_or_abort(make_rig("emulated", {{"session_spread", "off"}}));
  PlaybackRig playback;
  for (Rig* rig : {emulated.get(), static_cast<Rig*>(&playback)}) {
    BenchProgress progress;
    Bench bench(*rig, {}, progress);
    Sequence load;
    make(load);
    ExtremaSink sink(0.5, bench.volts_per_code());
    value_or_abort(
        bench.play(load, [&](const RigBlock& b, std::size_t n, std::span<const float> e) { sink(b, n, e); }));
    const Extrema e = sink.finish();
    const double low_V = (low_N - 0.15) / 0.5;
    for (std::size_t k = 0; k < spans.size(); ++k)
      (rig == &playback ? out[k].playback : out[k].film) = e.swing_V(low_V, spans[k].first, spans[k].second);
  }
  return out;
}

std::unique_ptr<Stimulus> of(const StimulusSpec& spec) { return value_or_abort(make_stimulus(spec)); }

TEST(Playback, gives_nothing_back_after_a_rest_in_mid_record) {
  const auto s = swings(
      [](Sequence& load) {
        load.add(of(sine(0.5, 1.5, 2.7, 600.0)), 600.0);
        load.add(of(rest(1.2, 60.0)), 60.0);
        load.add(of(sine(0.5, 1.5, 2.7, 60.0)), 60.0);
      },
      1.2, {{590.0, 600.0}, {672.0, 690.0}});
  EXPECT_GT(s[1].film, 1.15 * s[0].film);
  EXPECT_LT(s[1].playback, s[0].playback);
}

TEST(Playback, cannot_keep_the_ratio_of_the_amplitude_with_which_the_cycling_began) {
  // 0.8 N first: eq. (5) for 0.8 N ends at r = 0.35, the playback was told 1.5 N and ends at 0.2.
  const auto s = swings(
      [](Sequence& load) {
        load.add(of(sine(0.5, 0.8, 2.0, 600.0)), 600.0);
        load.add(of(sine(0.5, 1.5, 2.7, 600.0)), 600.0);
      },
      1.2, {{605.0, 620.0}});
  const double q = 1.0 / (1.0 + 1.377 * 0.64), begun = (std::exp(-0.00655 * 612.0) + q) / (1.0 + q);
  EXPECT_NEAR(s[0].film / 6.0, begun, 0.04);
  EXPECT_GT(std::abs(s[0].playback / 6.0 - begun), 0.1);
}

}  // namespace
}  // namespace forcegate::test
