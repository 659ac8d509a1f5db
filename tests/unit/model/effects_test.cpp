#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <cmath>
#include <functional>

#include "hil/base/rng.h"
#include "hil/model/capacitance_curve.h"
#include "hil/model/effect.h"
#include "hil/model/lagged_channel.h"
#include "hil/model/model.h"
#include "hil/model/play.h"
#include "synthetic.h"
#include "tests/support/campaign_effects.h"

namespace forcegate {
namespace {

CampaignInput input() {
  auto made = make_campaign_input(test::campaign([](double, double F) { return 2.0 * F - 0.2; }));
  EXPECT_TRUE(made.has_value());
  for (RecordInput& r : made->records) r.drive_mean_V = r.index % 2 == 0 ? 5.0 : 3.3;
  made->has_drive = true;
  return std::move(*made);
}

// The campaign with what a form asks for: a humidity channel, a thermometer or an angle that is missing, a recording of another machine.
CampaignInput input_for(const EffectKind& kind, const EffectForm& form) {
  CampaignInput out = input();
  out.has_command = out.has_capacitance = true;
  for (RecordInput& r : out.records) {
    r.F_cmd_N = r.F_N;
    for (std::size_t i = 0; i < r.temp_C.size(); ++i) r.temp_C[i] += 6.0 * r.t_s[i] / r.t_s.back();
    for (const double F : r.F_N) r.C_F.push_back(1e-12 * (22.0 + 3.1 * F));
    // the wheel is a little way off the sensor now and then
    for (std::size_t i = 0; i < r.rows(); ++i) r.rig_force_N.push_back(i % 53 == 0 ? -0.4 : r.F_N[i] - 0.05 * (1.0 - r.F_N[i]));
    r.rig_zero_N.assign(r.rows(), 0.1 * (static_cast<double>(r.index) - 1.0));
  }
  RecordInput& cyclic = out.records[1];
  cyclic.dynamic = true;
  cyclic.onset_s = 1.0;
  cyclic.F_min_N = 0.2;
  for (std::size_t i = 0; i < cyclic.rows(); ++i)
    cyclic.decay[i] = 0.5 + 0.5 * std::exp(-cyclic.t_s[i] / 30.0);
  cyclic.frequency_jumps_s = {20.0};
  cyclic.jump_log_ratio = {0.7};
  cyclic.lost_blocks = {{10.0, 1.0}, {30.0, 2.0}};
  out.block_s = 0.02;
  const auto serves = [&] { return is_available(kind, out) && !form.grid(out).empty(); };
  if (serves()) return out;
  // several mountings that nobody wrote down ask for more records
  const CampaignInput few = out;
  for (std::size_t k = 0; k < 2; ++k) out.records.emplace_back(few.records[k]).index = few.records.size() + k;
  if (serves()) return out;
  out = few;
  for (RecordInput& r : out.records) r.mounting = static_cast<int>(r.index);
  out.mountings = static_cast<int>(out.records.size());
  if (serves()) return out;
  for (RecordInput& r : out.records)
    for (const double T : r.temp_C) r.humidity.push_back(40.0 + 3.0 * std::cos(T));
  out.has_humidity = true;
  if (serves()) return out;
  for (RecordInput& r : out.records) r.temp_C.clear();
  out.has_temp = false;
  if (serves()) return out;
  out.has_theta = false;
  if (serves()) return out;
  out.bench.voltage_min_V = 0.0;
  out.bench.voltage_max_V = 10.0;
  out.generic = out.undeclared = true;
  EXPECT_TRUE(serves()) << kind.name << ", " << form.name;
  return out;
}

ModelEffect at_first_shape(const EffectKind& kind, const EffectForm& form, const CampaignInput& campaign) {
  const std::vector<Estimate> neutral(form.strength.size());
  return model_effect(kind, form, form.grid(campaign).front(), neutral);
}

class EveryForm : public ::testing::TestWithParam<std::pair<std::string, std::string>> {};

std::vector<std::pair<std::string, std::string>> all_forms() {
  std::vector<std::pair<std::string, std::string>> out;
  for (const EffectKind& kind : EffectRegistry::instance().all())
    for (const EffectForm& form : kind.forms) out.emplace_back(kind.name, form.name);
  return out;
}

TEST_P(EveryForm, DocumentsItselfAndItsParameters) {
  const EffectKind& kind = *EffectRegistry::instance().find(GetParam().first);
  const EffectForm& form = *find_form(kind, GetParam().second);
  EXPECT_FALSE(kind.summary.empty() || kind.equation.empty() || kind.source.empty() ||
               kind.separates.empty());
  EXPECT_FALSE(form.strength.empty());
  for (const ParameterSpec& p : form.strength) {
    EXPECT_LT(p.minimum, p.neutral) << p.name;
    EXPECT_GT(p.maximum, p.neutral) << p.name;
    EXPECT_EQ(p.neutral, 0.0) << p.name;
    EXPECT_FALSE(p.unit.empty() || p.doc.empty()) << p.name;
  }
  for (const std::string& other : kind.look_alikes)
    EXPECT_NE(EffectRegistry::instance().find(other), nullptr) << other << " is not an effect of the library";
}

TEST_P(EveryForm, GivesFiniteColumnsAndTheSameOnesTwice) {
  const EffectKind& kind = *EffectRegistry::instance().find(GetParam().first);
  const EffectForm& form = *find_form(kind, GetParam().second);
  const CampaignInput campaign = input();
  for (const auto& shape : form.grid(campaign)) {
    ASSERT_EQ(shape.size(), form.shape.size());
    for (const RecordInput& r : campaign.records) {
      Eigen::MatrixXd a = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(r.rows()),
                                                static_cast<Eigen::Index>(form.strength.size())),
                      b = a;
      form.columns(campaign, r, shape, a);
      form.columns(campaign, r, shape, b);
      EXPECT_TRUE(a.allFinite());
      EXPECT_EQ(a, b);
    }
  }
}

TEST_P(EveryForm, GivesInAFewWantedRowsWhatItGivesThereAmongAll) {
  const EffectKind& kind = *EffectRegistry::instance().find(GetParam().first);
  const EffectForm& form = *find_form(kind, GetParam().second);
  const CampaignInput all = input_for(kind, form);
  CampaignInput few = all;
  for (RecordInput& r : few.records)
    for (std::uint32_t i = 5; i < r.rows(); i += 61) r.wanted.push_back(i);
  for (const auto& shape : form.grid(all))
    for (std::size_t k = 0; k < all.records.size(); ++k) {
      Eigen::MatrixXd a = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(all.records[k].rows()),
                                                static_cast<Eigen::Index>(form.strength.size())),
                      b = a;
      form.columns(all, all.records[k], shape, a);
      form.columns(few, few.records[k], shape, b);
      const double scale = std::max(1.0, a.cwiseAbs().maxCoeff());
      for (const std::uint32_t i : few.records[k].wanted)
        ASSERT_LT((a.row(i) - b.row(i)).cwiseAbs().maxCoeff(), 1e-12 * scale) << "row " << i << " of " << all.records[k].name;
    }
}

TEST_P(EveryForm, ChangesNothingAtItsNeutralValueAndFollowsItsDerivativeElsewhere) {
  const EffectKind& kind = *EffectRegistry::instance().find(GetParam().first);
  const EffectForm& form = *find_form(kind, GetParam().second);
  const CampaignInput campaign = input_for(kind, form);
  const RecordInput& r = campaign.records[1];
  Model plain = *library_model("flexiforce");
  plain.frame = frame_of(campaign);
  const CampaignInFrame in_frame(plain.frame, campaign);
  const auto base = model_output_V(plain, in_frame, r);
  ASSERT_TRUE(base.has_value());
  const ModelEffect effect = at_first_shape(kind, form, campaign);
  Model with = plain;
  with.effects.push_back(effect);
  const auto neutral = model_output_V(with, in_frame, r);
  ASSERT_TRUE(neutral.has_value());
  EXPECT_EQ(*neutral, *base);
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(r.rows()),
                                                  static_cast<Eigen::Index>(form.strength.size()));
  form.columns(campaign, r, form.grid(campaign).front(), columns);
  // at a given reference force the sensor does not see what the rig does to it
  const double seen = kind.channel == EffectChannel::output ? 1.0 : 0.0;
  for (std::size_t j = 0; j < form.strength.size(); ++j) {
    const double step = 1e-3;
    with.effects[0].strength[j].value = step;
    const auto moved = model_output_V(with, in_frame, r);
    with.effects[0].strength[j].value = 0.0;
    for (std::size_t i = 0; i < r.rows(); i += 97)
      EXPECT_NEAR(
          ((*moved)[i] - (*base)[i]) / step,
          seen * columns(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) / plain.law.gain_N_per_V,
          1e-6);
  }
}

TEST_P(EveryForm, MovesSomeRecordOfACampaignThatFitsIt) {
  const EffectKind& kind = *EffectRegistry::instance().find(GetParam().first);
  const EffectForm& form = *find_form(kind, GetParam().second);
  const CampaignInput campaign = input_for(kind, form);
  double largest = 0.0;
  for (const auto& shape : form.grid(campaign))
    for (const RecordInput& r : campaign.records) {
      Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(r.rows()),
                                                      static_cast<Eigen::Index>(form.strength.size()));
      form.columns(campaign, r, shape, columns);
      largest = std::max(largest, columns.cwiseAbs().maxCoeff());
    }
  EXPECT_GT(largest, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Library, EveryForm, ::testing::ValuesIn(all_forms()),
                         [](const auto& form) { return form.param.first + "__" + form.param.second; });

TEST(Library, HoldsEveryEffectThatACampaignMayName) {
  for (const std::string& name : test::kCampaignEffects)
    EXPECT_NE(EffectRegistry::instance().find(name), nullptr) << name;
}

TEST(Play, BeginsARecordingAsTheOnesBeforeEndedOrAnew) {
  CampaignInput campaign = input();
  // two blocks of one recording hold all of its rows
  campaign.records[2] = campaign.records[1];
  campaign.records[2].index = 2;
  for (const bool kept : {true, false})
    for (const double radius : {0.05, 0.4, 1.5, 8.0}) {
      Play all_along(radius, 0.0);
      for (const RecordInput& r : campaign.records) {
        Play found = play_at_start(campaign, r, &RecordInput::F_N, radius, 0.0, kept);
        if (r.index == 2) continue;
        if (r.index == 0 || !kept) all_along = Play(radius, std::max(0.0, r.F_N[0] - radius));
        for (const double F : r.F_N) ASSERT_DOUBLE_EQ(found.step(F), all_along.step(F)) << r.name << ", " << radius << ", " << kept;
      }
    }
}

TEST(LaggedChannel, StaysBehindTheAirAcrossARestAndSettlesInALongOne) {
  CampaignInput campaign = input();
  for (RecordInput& r : campaign.records)
    r.temp_C.assign(r.rows(), 20.0 + 5.0 * static_cast<double>(r.index));
  // record 1 begins 380 s after record 0 has ended; the air warms along a straight line from 20 to 25 degC meanwhile
  const double tau = 200.0, rest = campaign.records[1].start_s - campaign.records[0].start_s -
                                   campaign.records[0].t_s.back();
  const std::vector<double> film = lagged_channel(campaign, campaign.records[1], &RecordInput::temp_C, tau);
  EXPECT_NEAR(film.front(), 25.0 - 5.0 * (tau / rest) * (1.0 - std::exp(-rest / tau)), 0.02);
  EXPECT_LT(film.front(), film.back());
  EXPECT_NEAR(lagged_channel(campaign, campaign.records[1], &RecordInput::temp_C, 2.0).front(), 25.0, 0.05);
  EXPECT_EQ(lagged_channel(campaign, campaign.records[0], &RecordInput::temp_C, tau).back(), 20.0);
  // a film slower than the campaign has not seen the first reading for long: it stands near the mean
  const std::vector<double> slow = lagged_channel(campaign, campaign.records[0], &RecordInput::temp_C, 1e6, FilmStart::mean);
  double mean = 0.0, rows = 0.0;
  for (const RecordInput& r : campaign.records) {
    mean += r.temp_C.front() * static_cast<double>(r.rows());
    rows += static_cast<double>(r.rows());
  }
  EXPECT_NEAR(slow.back(), mean / rows, 0.01 * mean / rows);
}

// Recovered from data made by another form: columns of the effect against the other form's output by least squares.
double explained_by(const std::string& effect, const std::string& form_name, const CampaignInput& campaign,
                    const std::vector<std::vector<double>>& added) {
  const EffectKind& kind = *EffectRegistry::instance().find(effect);
  const EffectForm& form = *find_form(kind, form_name);
  double best = 0.0;
  for (const auto& shape : form.grid(campaign)) {
    const auto p = static_cast<Eigen::Index>(form.strength.size()) + 2;
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(p, p);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(p);
    Eigen::MatrixXd G0 = Eigen::MatrixXd::Zero(2, 2);
    Eigen::VectorXd b0 = Eigen::VectorXd::Zero(2);
    double yy = 0.0;
    for (std::size_t k = 0; k < campaign.records.size(); ++k) {
      const RecordInput& r = campaign.records[k];
      Eigen::MatrixXd X = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(r.rows()), p);
      form.columns(campaign, r, shape, X.leftCols(p - 2));
      Eigen::VectorXd y(static_cast<Eigen::Index>(r.rows()));
      for (std::size_t i = 0; i < r.rows(); ++i) {
        X(static_cast<Eigen::Index>(i), p - 2) = r.F_N[i];
        X(static_cast<Eigen::Index>(i), p - 1) = 1.0;
        y[static_cast<Eigen::Index>(i)] = added[k][i];
      }
      G += X.transpose() * X;
      b += X.transpose() * y;
      G0 += X.rightCols(2).transpose() * X.rightCols(2);
      b0 += X.rightCols(2).transpose() * y;
      yy += y.squaredNorm();
    }
    G.diagonal().array() += 1e-9 * G.trace();
    const double without = yy - b0.dot(G0.ldlt().solve(b0)), with = yy - b.dot(G.ldlt().solve(b));
    best = std::max(best, 1.0 - with / without);
  }
  return best;
}

// The campaign with a recorded capacitance C(F), F.
CampaignInput with_capacitance(const std::function<double(double)>& C) {
  CampaignInput made = input();
  made.has_capacitance = true;
  for (RecordInput& r : made.records) {
    r.C_F.clear();
    for (const double F : r.F_N) r.C_F.push_back(C(F));
  }
  return made;
}

TEST(CapacitanceCurve, IsTheRecordedOneAndNoneThatSaysNothingAboutTheForce) {
  const auto rising = [](double F) { return 1e-12 * (22.0 + 3.1 * F - 0.11 * F * F); };
  const CampaignInput campaign = with_capacitance(rising);
  const auto curve = capacitance_curve(campaign);
  ASSERT_TRUE(curve.has_value());
  for (const double F : {0.5, 2.0, 3.0}) {
    EXPECT_NEAR(curve->at_F(F), rising(F), 1e-16);
    EXPECT_NEAR(curve->slope_F_per_N(F), 1e-12 * (3.1 - 0.22 * F), 1e-16);
  }
  EXPECT_FALSE(capacitance_curve(input()).has_value()) << "nothing is recorded";
  EXPECT_FALSE(capacitance_curve(with_capacitance([](double) { return 22e-12; })).has_value());
  EXPECT_FALSE(capacitance_curve(with_capacitance([](double F) { return 1e-12 * (40.0 - F); })).has_value());
}

// A current V dC/dt of this very C, and a pole of R(F) and this C, against the forms with and without the recorded channel.
TEST(CapacitanceForms, TheRecordedCapacitanceExplainsItsCurrentAndItsPoleBetterThanAnAssumedOne) {
  const CampaignInput campaign =
      with_capacitance([](double F) { return 1e-12 * (2.0 + 0.5 * F + 1.5 * F * F); });
  const double middle = campaign.lowest_N + 0.5 * campaign.range_N;
  std::vector<std::vector<double>> current, pole;
  for (const RecordInput& r : campaign.records) {
    std::vector<double> i_row, p_row;
    const auto C_of = [](double F) { return 2.0 + 0.5 * F + 1.5 * F * F; };
    double y = r.fast_F_N[0], charge = C_of(r.fast_F_N[0]);
    for (std::size_t i = 0; i < r.rows(); ++i) {
      double sum = 0.0, current_sum = 0.0;
      for (std::uint32_t k = r.row_begin[i]; k < r.row_begin[i + 1]; ++k) {
        const double F = r.fast_F_N[k], dt = k > 0 ? r.fast_t_s[k] - r.fast_t_s[k - 1] : 1.0;
        const double tau_s =
            0.03 * (middle / (std::max(F, 0.0) + 0.02 * campaign.range_N)) * C_of(F) / C_of(middle);
        const double moved = k > 0 ? dt / (0.003 + dt) * (C_of(F) - charge) : 0.0;
        charge += moved;
        current_sum += moved / dt;
        if (k > 0) y += dt / (tau_s + dt) * (F - y);
        sum += y;
      }
      i_row.push_back(current_sum / (r.row_begin[i + 1] - r.row_begin[i]));
      p_row.push_back(sum / (r.row_begin[i + 1] - r.row_begin[i]) - r.F_N[i]);
    }
    current.push_back(std::move(i_row));
    pole.push_back(std::move(p_row));
  }
  const double current_measured = explained_by("piezocapacitance", "measured_capacitance", campaign, current),
               current_assumed = explained_by("piezocapacitance", "load_dependent", campaign, current);
  EXPECT_GT(current_measured, 0.9);
  EXPECT_GT(current_measured, current_assumed + 0.02);
  const double pole_measured = explained_by("rc", "measured_capacitance", campaign, pole),
               pole_assumed = explained_by("rc", "load_dependent_pole", campaign, pole);
  EXPECT_GT(pole_measured, 0.9);
  EXPECT_GT(pole_measured, pole_assumed);
}

TEST(Recovery, PlayOperatorsFollowALoopMadeByAPreisachPlane) {
  const CampaignInput campaign = input();
  std::vector<std::vector<double>> added;
  for (const RecordInput& r : campaign.records) {
    std::vector<double> y(r.rows(), 0.0);
    int relays = 0;
    for (double alpha = 0.3; alpha < 4.4; alpha += 0.2)
      for (double beta = 0.1; beta < alpha; beta += 0.2) {
        ++relays;
        bool up = r.F_N[0] >= alpha;
        for (std::size_t i = 0; i < r.rows(); ++i) {
          if (r.F_N[i] >= alpha) up = true;
          if (r.F_N[i] <= beta) up = false;
          y[i] += up ? 1.0 : 0.0;
        }
      }
    for (double& v : y) v /= relays;
    added.push_back(y);
  }
  EXPECT_GT(explained_by("hysteresis", "play_bank", campaign, added), 0.85);
  EXPECT_LT(explained_by("delay", "shift", campaign, added), 0.7);
}

TEST(Recovery, PronySeriesFollowsCreepThatGrowsWithTheLogarithmOfTime) {
  const CampaignInput campaign = input();
  std::vector<std::vector<double>> added;
  for (const RecordInput& r : campaign.records) {
    // superposition of log10(1 + t/1 s) responses to every step of the force, on a coarse grid of steps
    std::vector<double> y(r.rows(), 0.0);
    const std::size_t stride = 10;
    for (std::size_t k = 0; k < r.rows(); k += stride) {
      const double dF = r.F_N[k] - (k >= stride ? r.F_N[k - stride] : 0.0);
      if (std::abs(dF) < 1e-9) continue;
      for (std::size_t i = k; i < r.rows(); ++i) y[i] += 0.03 * dF * std::log10(1.0 + r.t_s[i] - r.t_s[k]);
    }
    added.push_back(y);
  }
  EXPECT_GT(explained_by("creep", "prony", campaign, added), 0.97);
}

TEST(Recovery, OnePoleFollowsADistributedLag) {
  const CampaignInput campaign = input();
  std::vector<std::vector<double>> added;
  for (const RecordInput& r : campaign.records) {
    double a = r.fast_F_N[0], b = a;
    std::vector<double> y(r.rows(), 0.0);
    for (std::size_t i = 0; i < r.rows(); ++i) {
      for (std::uint32_t k = r.row_begin[i]; k < r.row_begin[i + 1]; ++k) {
        a += 0.005 / 0.05 * (r.fast_F_N[k] - a);
        b += 0.005 / 0.03 * (a - b);
        y[i] += b - r.fast_F_N[k];
      }
      y[i] /= r.row_begin[i + 1] - r.row_begin[i];
    }
    added.push_back(y);
  }
  EXPECT_GT(explained_by("lag", "one_pole", campaign, added), 0.9);
}

}  // namespace
}  // namespace forcegate
