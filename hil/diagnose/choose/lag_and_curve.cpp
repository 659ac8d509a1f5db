#include "hil/diagnose/choose/lag_and_curve.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "hil/diagnose/candidates/signatures.h"
#include "hil/diagnose/choose/late_output.h"
#include "hil/diagnose/choose/refine.h"
#include "hil/diagnose/choose/screen.h"
#include "hil/diagnose/choose/select.h"

namespace forcegate::diagnose {

namespace {

const EffectForm& form_of(const char* effect, const std::string& name) { return *find_form(*EffectRegistry::instance().find(effect), name); }

Candidate in_model(const char* effect, const std::string& form_name, const std::vector<double>& shape) {
  const EffectForm& form = form_of(effect, form_name);
  Candidate c{EffectRegistry::instance().find(effect), &form, shape, 0, static_cast<int>(form.strength.size())};
  c.of_model = true;
  return c;
}

}  // namespace

const Candidate* lag_of_model(const ResidualChannel& channel) {
  const auto at = std::ranges::find_if(channel.candidates, [](const Candidate& c) { return c.of_model && c.kind->name == kLag; });
  return at == channel.candidates.end() ? nullptr : &*at;
}

LagAndCurvePoint LagAndCurveModel::best(const LagWithCurve& forms, const LagAndCurvePoint& start, Delay delay) {
  EffectForm moved;  // of which the climb reads the shapes
  std::vector<double> at;
  const auto add = [&](std::span<const ParameterSpec> specs, std::span<const double> values) {
    moved.shape.insert(moved.shape.end(), specs.begin(), specs.end());
    at.insert(at.end(), values.begin(), values.end());
  };
  constexpr double kShortest_s = 1e-4, kLongest_s = 10.0;
  const std::vector<ParameterSpec> of_delay = {{"delay_s", "s", kShortest_s, kLongest_s, 0.0, ""}};
  if (delay == Delay::moves) add(of_delay, {&start.delay_s, 1});
  const EffectForm &lag = form_of(kLag, forms.lag), &curve = form_of(kCurve, forms.curve);
  add(lag.shape, start.lag);
  add(std::span(curve.shape).subspan(1), std::span(start.curve).subspan(1));
  LagAndCurvePoint out;
  climb(moved, at, [&](const std::vector<double>& shape) {
    auto next = shape.begin();
    LagAndCurvePoint p;
    p.delay_s = delay == Delay::moves ? *next++ : start.delay_s;
    p.lag.assign(next, next + std::ssize(lag.shape));
    p.curve.assign(next + std::ssize(lag.shape), shape.end());
    p.curve.insert(p.curve.begin(), p.lag.front());
    judge(forms, p);
    if (p.evidence > out.evidence) out = p;
    return p.evidence;
  });
  return out;
}

std::vector<double> LagAndCurveModel::curve_at(const LagWithCurve& forms, LagAndCurvePoint point) {
  const MixedFit fit = judge(forms, point);
  if (!fit.valid) return {};
  const double gain = fit.coefficient[0] * own_->output.gain_of_unit;
  std::vector<double> out;
  for (const Candidate& c : own_->output.candidates)
    if (c.kind->name == kCurve)
      for (const int column : columns_of(c)) out.push_back(fit.strength_of(column) / gain);
  return out;
}

MixedFit LagAndCurveModel::judge(const LagWithCurve& forms, LagAndCurvePoint& p) {
  if (!own_ || p.delay_s != delay_s_ || forms != forms_) {
    build(forms, p);
  } else {
    for (Candidate& c : own_->output.candidates) {
      c.shape = c.kind->name == kLag ? p.lag : p.curve;
      fill_candidate(own_->input, own_->output, c, threads_);
    }
  }
  std::vector<int> columns;
  for (const Candidate& c : own_->output.candidates) add_columns(columns, columns_of(c));
  MixedFit fit = fit_mixed(own_->output.problem, columns, nullptr, 15, RecordUse::all_records);
  if (!fit.valid) return fit;
  p.evidence = fit.log_evidence;
  p.left = excess_mean_square(own_->output, fit);
  return fit;
}

void LagAndCurveModel::build(const LagWithCurve& forms, const LagAndCurvePoint& p) {
  own_ = std::make_unique<Workspace>();
  own_->input = w_.input;
  if (decay_ == Decay::none)
    for (RecordInput& r : own_->input.records) std::ranges::fill(r.decay, 1.0);
  if (p.delay_s != 0.0) delay_force(own_->input, p.delay_s);
  own_->law = w_.law;
  own_->zero_wanders = w_.zero_wanders;
  own_->gain_V_per_N = w_.gain_V_per_N;
  own_->shifts = w_.shifts;
  own_->noise_V = w_.noise_V;
  own_->white_V = w_.white_V;
  own_->smoothed_V = w_.smoothed_V;
  own_->judges = w_.judges;
  Candidate lag = in_model(kLag, forms.lag, p.lag);
  lag.written = {1.0};
  const ListedOnly nothing_else{};
  build_output_channel(*own_, threads_, {lag, in_model(kCurve, forms.curve, p.curve)}, &nothing_else);
  delay_s_ = p.delay_s;
  forms_ = forms;
}

}  // namespace forcegate::diagnose
