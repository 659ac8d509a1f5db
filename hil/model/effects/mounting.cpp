// Mounting: hardness and curvature of the contacting surface change the gain; one gain for each mounting.
//   dU = g (c_k W + o_k R) in the k-th mounting, R the force span; where nobody wrote the mountings down, one to three steps:
//   dU = g (c W + o R) for all records from number k on, counted from one.  Sensors 20 (2020) 6863.

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "hil/model/effect.h"

namespace forcegate {
namespace {

constexpr int kMostMountings = 6;

// Gains, zeros, or both, of the second to the last mounting over the first. More mountings than there is room for: the last ones share.
EffectForm declared(const char* name, bool gain, bool zero) {
  EffectForm form;
  form.name = name;
  form.groups = true;
  form.whole = gain && zero;
  form.cause = {"mounting, in order", "1", [](const RecordInput& r) { return r.mounting + 1.0; }, 1.0};
  const auto add = [&](ParameterSpec strength) {
    for (int k = 1; k < kMostMountings; ++k) {
      const std::string number = std::to_string(k + 1);
      form.strength.push_back(strength);
      form.strength.back().name += number;
      form.strength.back().doc += number;
    }
  };
  if (gain) add({"c_", "1", -0.9, 9.0, 0.0, "relative change of gain in mounting "});
  if (zero) add({"o_", "1", -1.0, 1.0, 0.0, "change of zero, share of the force span, in mounting "});
  form.grid = [](const CampaignInput& c) {
    return c.mountings > 1 ? std::vector<std::vector<double>>{{}} : std::vector<std::vector<double>>{};
  };
  form.columns = [gain, zero](const CampaignInput& c, const RecordInput& r, std::span<const double>, ColumnsRef out) {
    out.setZero();
    if (r.mounting < 1) return;
    const int column = std::min(r.mounting, kMostMountings - 1) - 1;
    r.for_each_wanted([&](std::size_t i) {
      const auto row = static_cast<Eigen::Index>(i);
      if (gain) out(row, column) = r.base_force_N(i);
      if (zero) out(row, column + (gain ? kMostMountings - 1 : 0)) = c.range_N;
    });
  };
  return form;
}

// Several mountings that nobody wrote down, each with its gain and zero over the first. The grid holds the place of one candidate, which the
// diagnosis moves to where the records jump (hil/diagnose/between/mounting_places.h).
EffectForm undeclared(const char* name, int steps) {
  EffectForm form;
  form.name = name;
  form.refine = false;
  for (int k = 0; k < steps; ++k) {
    const std::string number = std::to_string(k + 2);
    form.shape.push_back({"record_" + number, "1", 2.0, 1e6, 2.0 + k, "first record of mounting " + number + ", counted from one"});
    form.strength.push_back({"c_" + number, "1", -0.9, 9.0, 0.0, "relative change of gain in mounting " + number});
    form.strength.push_back({"o_" + number, "1", -1.0, 1.0, 0.0, "change of zero, share of the force span, in mounting " + number});
  }
  form.grid = [steps](const CampaignInput& c) {
    // more have too many places to be asked
    constexpr std::size_t kFewestRecords = 6, kMostWithTwo = 25, kMostWithThree = 14;
    std::vector<std::vector<double>> out;
    if (c.mountings > 0 || c.records.size() < kFewestRecords || c.records.size() > (steps == 2 ? kMostWithTwo : kMostWithThree)) return out;
    const double each = static_cast<double>(c.records.size()) / (steps + 1.0);
    std::vector<double> even;
    for (int k = 1; k <= steps; ++k) even.push_back(std::floor(each * k) + 1.0);
    out.push_back(even);
    return out;
  };
  form.columns = [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
    out.setZero();
    const auto mounting = std::ranges::upper_bound(shape, static_cast<double>(r.index + 1)) - shape.begin();
    if (mounting == 0) return;
    r.for_each_wanted([&](std::size_t i) {
      out(static_cast<Eigen::Index>(i), 2 * mounting - 2) = r.base_force_N(i);
      out(static_cast<Eigen::Index>(i), 2 * mounting - 1) = c.range_N;
    });
  };
  return form;
}

const Registration<EffectKind> kRegistered{EffectKind{
    .name = "mounting",
    .side = "sensor",
    .summary = "gain and zero are new from one record on and stay, as after mounting the sensor anew (or an overload)",
    .equation = "dU = g (c_k W + o_k R) in mounting k; not written down: one to three steps, each from a record on, counted from one",
    .source = "Sensors 20 (2020) 6863",
    .look_alikes = {"wear", "thermal", "bias", "slow_recovery"},
    .separates = "the same ramp before and after touching the mounting, and again without touching it",
    .needs = {},
    .traits = {.between_records = true, .needs_records = true},
    .forms = {
        {.name = "step",
         .shape = {{"record", "1", 2.0, 1e6, 2.0, "first record of the new mounting, counted from one"}},
         .strength = {{"c", "1", -0.9, 9.0, 0.0, "relative change of gain"},
                      {"o", "1", -1.0, 1.0, 0.0, "change of zero, share of the force span"}},
         .sign = StrengthSign::either,
         .grid =
             [](const CampaignInput& c) {
               std::vector<std::vector<double>> out;
               if (c.mountings > 0) return out;
               // one record that stands apart is an odd record
               for (std::size_t k = 2; k + 2 <= c.records.size(); ++k) out.push_back({static_cast<double>(k + 1)});
               return out;
             },
         .columns =
             [](const CampaignInput& c, const RecordInput& r, std::span<const double> shape, ColumnsRef out) {
               const bool after = static_cast<double>(r.index + 1) >= shape[0];
               r.for_each_wanted([&](std::size_t i) {
                 out(static_cast<Eigen::Index>(i), 0) = after ? r.base_force_N(i) : 0.0;
                 out(static_cast<Eigen::Index>(i), 1) = after ? c.range_N : 0.0;
               });
             },
         .refine = false,
         .singles = true},
        undeclared("two_steps", 2), undeclared("three_steps", 3), declared("declared_gain", true, false), declared("declared_zero", false, true),
        declared("declared", true, true)}}};

}  // namespace
}  // namespace forcegate
