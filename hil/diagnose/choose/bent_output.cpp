#include "hil/diagnose/choose/bent_output.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "hil/diagnose/choose/lag_and_curve.h"
#include "hil/model/effect.h"
#include "hil/model/rows.h"
#include "hil/model/states.h"

namespace forcegate::diagnose {

namespace {

using Eigen::VectorXd;

constexpr int kGrid = 2001;
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

// Newtons that a form adds to the force.
VectorXd added_by(const EffectForm& form, const CampaignInput& campaign, const RecordInput& record, const std::vector<double>& shape,
                  const std::vector<double>& strength) {
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(record.rows()), std::ssize(strength));
  form.columns(campaign, record, shape, columns);
  return columns * Eigen::Map<const VectorXd>(strength.data(), std::ssize(strength));
}

// None where it does not rise. At a touch hardly a row tells the slope: it is kept above nothing there.
std::optional<Bend> bend_through(const CampaignInput& campaign, const RecordInput& record, const VectorXd& felt_N) {
  constexpr double kFlattest = 0.05, kOfRange = 0.02;  // of the mean slope; that may be flatter
  const VectorXd step = felt_N.tail(kGrid - 1) - felt_N.head(kGrid - 1);
  const double least = kFlattest * step.mean();
  if (!(least > 0.0) || static_cast<double>((step.array() <= least).count()) > kOfRange * kGrid) return std::nullopt;
  const VectorXd rising = step.cwiseMax(least);
  const double rise = rising.sum();
  Bend out{record.F_N, {campaign.lowest_N}};
  double risen = 0.0;
  for (const double of_step : rising) {
    risen += of_step;
    out.bent_N.push_back(campaign.lowest_N + campaign.range_N * risen / rise);
  }
  for (std::size_t k = 0; k < out.F_N.size(); ++k) out.departure = std::max(out.departure, std::abs(out.bent_N[k] - out.F_N[k]) / campaign.range_N);
  return out;
}

void lag_samples(RecordInput& r, double tau_s) {
  if (r.fast_F_N.empty()) return;
  LowPass film(tau_s, r.fast_F_N.front());
  double before = r.fast_F_N.front();
  for (std::size_t k = 1; k < r.fast_F_N.size(); ++k) {
    const double now = r.fast_F_N[k];
    r.fast_F_N[k] = film.step(before, now, r.fast_t_s[k] - r.fast_t_s[k - 1]);
    before = now;
  }
}

}  // namespace

double Bend::at(double force_N) const {
  const double step = F_N[1] - F_N[0], place = (force_N - F_N.front()) / step;
  const auto k = static_cast<std::size_t>(std::clamp(std::floor(place), 0.0, static_cast<double>(F_N.size() - 2)));
  return bent_N[k] + (bent_N[k + 1] - bent_N[k]) * (place - static_cast<double>(k));
}

std::optional<Bend> bend_of(const CampaignInput& campaign, const Finding& curve) {
  const EffectKind* kind = EffectRegistry::instance().find(curve.effect);
  if (kind == nullptr || !(campaign.range_N > 0.0)) return std::nullopt;
  const RecordInput record = on_grid(campaign);
  VectorXd felt_N = Eigen::Map<const VectorXd>(record.F_N.data(), kGrid);
  for (const EffectForm& form : kind->forms) {
    std::vector<double> strength;
    for (const ParameterSpec& spec : form.strength) strength.push_back(value_of(curve, form.name, spec.name).value_or(0.0));
    if (std::ranges::all_of(strength, [](double c) { return c == 0.0; })) continue;
    const std::vector<double> shape = shape_of(form, curve);
    if (shape.size() != form.shape.size()) return std::nullopt;
    felt_N += added_by(form, campaign, record, shape, strength);
  }
  return bend_through(campaign, record, felt_N);
}

std::optional<LaggedBend> bend_beside_lag(const Workspace& w, unsigned threads) {
  const Candidate* lag = lag_of_model(w.output);
  if (lag == nullptr || lag->form->name != kOnePole || !(w.input.range_N > 0.0)) return std::nullopt;
  LagAndCurveModel model(w, LagAndCurveModel::Decay::of_records, threads);
  const double tau_s = lag->shape.front();
  LagAndCurvePoint best;
  LagWithCurve forms;
  bool after_lag = false;
  for (const bool after : {false, true}) {
    const LagWithCurve tried{kOnePole, after ? "quartic_after_lag" : "quartic_before_lag"};
    const LagAndCurvePoint p = model.best(tried, {0.0, {tau_s}, {tau_s}}, LagAndCurveModel::Delay::stays);
    if (p.evidence > best.evidence) best = p, forms = tried, after_lag = after;
  }
  const std::vector<double> strength = model.curve_at(forms, best);
  if (strength.empty()) return std::nullopt;
  const EffectForm& form = *find_form(*EffectRegistry::instance().find(kCurve), forms.curve);
  const RecordInput record = on_grid(w.input);
  const VectorXd felt_N = Eigen::Map<const VectorXd>(record.F_N.data(), kGrid) + added_by(form, w.input, record, {kNoLag_s}, strength);
  std::optional<Bend> bend = bend_through(w.input, record, felt_N);
  if (!bend) return std::nullopt;
  return LaggedBend{*std::move(bend), best.lag.front(), after_lag};
}

void bend_force(CampaignInput& campaign, const Bend& bend, double lag_s) {
  const auto each = [&](std::vector<double>& F_N) {
    for (double& F : F_N) F = bend.at(F);
  };
  const RecordInput* whole = nullptr;  // the first block of a recording, which alone has the force at full rate
  for (RecordInput& r : campaign.records) {
    r.wanted.clear();
    if (lag_s > 0.0) lag_samples(r, lag_s);
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
