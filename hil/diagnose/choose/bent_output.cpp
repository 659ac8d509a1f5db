#include "hil/diagnose/choose/bent_output.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "hil/model/effect.h"
#include "hil/model/rows.h"
#include "hil/model/states.h"

namespace forcegate::diagnose {

namespace {

constexpr int kGrid = 401;
constexpr double kNoLag_s = 1e-4;  // beside rows of a second

// Parameters of the chosen form stand alone, those of further forms behind the form's name.
std::optional<double> value_of(const Finding& f, const std::string& form, const std::string& name) {
  const std::string wanted = form == f.form ? name : form + "." + name;
  const auto at = std::ranges::find(f.parameters, wanted, &FoundParameter::name);
  return at == f.parameters.end() ? std::nullopt : std::optional(at->value);
}

// The lag of a curve that lags with the model's is that of the model: here the curve stands still.
std::vector<double> shape_of(const EffectForm& form, const Finding& f) {
  std::vector<double> out;
  for (const ParameterSpec& spec : form.shape)
    if (const auto value = value_of(f, form.name, spec.name)) out.push_back(!form.beside.empty() && spec.name == "tau_s" ? kNoLag_s : *value);
  return out;
}

// A record that rests on every force for a while, and has no decay.
RecordInput on_grid(const CampaignInput& campaign) {
  RecordInput out;
  out.row_step_s = 1.0;
  for (int k = 0; k < kGrid; ++k) {
    const auto row = static_cast<std::uint32_t>(k);
    out.t_s.push_back(k);
    out.F_N.push_back(campaign.lowest_N + campaign.range_N * k / (kGrid - 1));
    out.row_begin.push_back(row);
  }
  out.row_begin.push_back(kGrid);
  out.fast_t_s = out.t_s;
  out.fast_F_N = out.F_N;
  out.F_min_N = campaign.lowest_N;
  out.decay.assign(kGrid, 1.0);
  return out;
}

}  // namespace

double Bend::at(double force_N) const {
  const double step = F_N[1] - F_N[0], place = (force_N - F_N.front()) / step;
  const auto k = static_cast<std::size_t>(std::clamp(std::floor(place), 0.0, static_cast<double>(F_N.size() - 2)));
  return bent_N[k] + (bent_N[k + 1] - bent_N[k]) * (place - static_cast<double>(k));
}

std::optional<Bend> bend_of(const CampaignInput& campaign, const Finding& curve) {
  constexpr double kFlattest = 0.05;  // of the mean slope
  const EffectKind* kind = EffectRegistry::instance().find(curve.effect);
  if (kind == nullptr || !(campaign.range_N > 0.0)) return std::nullopt;
  const RecordInput record = on_grid(campaign);
  Eigen::VectorXd y = Eigen::Map<const Eigen::VectorXd>(record.F_N.data(), kGrid);
  for (const EffectForm& form : kind->forms) {
    const std::vector<double> shape = shape_of(form, curve);
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(kGrid, std::ssize(form.strength));
    bool filled = false;
    for (std::size_t k = 0; k < form.strength.size(); ++k) {
      const auto value = value_of(curve, form.name, form.strength[k].name);
      if (!value) continue;
      if (shape.size() != form.shape.size()) return std::nullopt;
      if (!filled) form.columns(campaign, record, shape, columns);
      filled = true;
      y += *value * columns.col(static_cast<Eigen::Index>(k));
    }
  }
  const double rise = (y[kGrid - 1] - y[0]) / (kGrid - 1);
  std::vector<double> slope;
  for (int k = 0; k + 1 < kGrid; ++k) slope.push_back((y[k + 1] - y[k]) / rise);
  Bend out{record.F_N, {}, 1.0};
  for (int k = 0; k < kGrid; ++k) out.bent_N.push_back(campaign.lowest_N + campaign.range_N * (y[k] - y[0]) / (rise * (kGrid - 1)));
  std::ranges::sort(slope);
  if (!(slope.front() > kFlattest)) return std::nullopt;
  out.slope_ratio = slope[slope.size() * 19 / 20] / slope[slope.size() / 20];
  return out;
}

void bend_force(CampaignInput& campaign, const Bend& bend) {
  const auto each = [&](std::vector<double>& F_N) {
    for (double& F : F_N) F = bend.at(F);
  };
  const RecordInput* whole = nullptr;  // the first block of a recording, which alone has the force at full rate
  for (RecordInput& r : campaign.records) {
    r.wanted.clear();
    each(r.fast_F_N);
    if (!r.fast_F_N.empty()) {
      whole = &r;
      r.F_N = delayed_rows(r, 0.0);
    } else if (whole != nullptr && whole->recording == r.recording) {
      r.F_N = whole->F_N;
    } else {
      each(r.F_N);
    }
    each(r.other_F_min_N);
    r.A_N = 0.5 * (bend.at(r.F_min_N + 2.0 * r.A_N) - bend.at(r.F_min_N));
    r.F_min_N = bend.at(r.F_min_N);
    r.jumps_F_min_N = bend.at(r.jumps_F_min_N);
    set_rates(r);
  }
}

}  // namespace forcegate::diagnose
