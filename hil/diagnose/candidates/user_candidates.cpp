#include "hil/diagnose/candidates/user_candidates.h"

#include <algorithm>
#include <cmath>

#include "hil/model/user_equation.h"

namespace forcegate::diagnose {

namespace {

constexpr const char* kShare = "share";
constexpr double kNoBound = 1e299;

ParameterSpec spec_of(const ModelParameter& p) {
  ParameterSpec out{p.name, p.unit, p.minimum, p.maximum, p.value, ""};
  const Reach reach = reach_of(p);
  out.minimum = reach.low;
  out.maximum = reach.high;
  return out;
}

UserEffect with_value(UserEffect effect, std::size_t parameter, double value) {
  effect.parameters[parameter].value = value;
  return effect;
}

// Records on which proportionality is tried: all would cost more and tell no more.
constexpr std::size_t kTried = 4;

// At a value, at twice it and at its negative.
bool is_proportional(const UserEffect& effect, std::size_t parameter, const CampaignInput& input) {
  constexpr double kRounding = 1e-9;
  const double written = effect.parameters[parameter].value, value = written != 0.0 ? written : 1.0;
  bool moves = false;
  for (std::size_t r = 0; r < std::min(kTried, input.records.size()); ++r) {
    const RecordInput& record = input.records[r];
    const auto at = user_effect_N(with_value(effect, parameter, value), record), twice = user_effect_N(with_value(effect, parameter, 2.0 * value), record),
               negative = user_effect_N(with_value(effect, parameter, -value), record);
    if (!at || !twice || !negative) return false;
    double largest = 0.0;
    for (const double x : *at) largest = std::max(largest, std::abs(x));
    moves |= largest > 0.0;
    for (std::size_t i = 0; i < at->size(); ++i)
      if (std::abs((*twice)[i] - 2.0 * (*at)[i]) > kRounding * largest || std::abs((*negative)[i] + (*at)[i]) > kRounding * largest) return false;
  }
  return moves;
}

// All `parameters` zero but one.
UserEffect one_alone(UserEffect effect, const std::vector<std::size_t>& parameters, std::size_t one, double value) {
  for (const std::size_t k : parameters) effect.parameters[k].value = k == one ? value : 0.0;
  return effect;
}

// The output is the sum of what each parameter gives alone, and each is proportional to it: k1 x + k2 y.
bool is_sum_of(const std::vector<std::size_t>& parameters, const UserEffect& effect, const CampaignInput& input) {
  constexpr double kRounding = 1e-9;
  for (std::size_t r = 0; r < std::min(kTried, input.records.size()); ++r) {
    const RecordInput& record = input.records[r];
    const auto whole = user_effect_N(effect, record);
    if (!whole) return false;
    std::vector<double> sum(whole->size(), 0.0);
    double largest = 0.0;
    for (const std::size_t k : parameters) {
      const auto part = user_effect_N(one_alone(effect, parameters, k, 1.0), record);
      if (!part) return false;
      for (std::size_t i = 0; i < sum.size(); ++i) {
        const double given = effect.parameters[k].value * (*part)[i];
        sum[i] += given;
        largest = std::max(largest, std::abs(given));
      }
    }
    for (std::size_t i = 0; i < sum.size(); ++i)
      if (std::abs(sum[i] - (*whole)[i]) > kRounding * largest) return false;
  }
  return true;
}

// A second difference of nothing.
bool is_straight(const UserEffect& effect, std::size_t parameter, const CampaignInput& input) {
  constexpr double kRounding = 1e-9;
  const double written = effect.parameters[parameter].value, value = written != 0.0 ? written : 1.0;
  for (std::size_t r = 0; r < std::min(kTried, input.records.size()); ++r) {
    const RecordInput& record = input.records[r];
    const auto none = user_effect_N(with_value(effect, parameter, 0.0), record), once = user_effect_N(with_value(effect, parameter, value), record),
               twice = user_effect_N(with_value(effect, parameter, 2.0 * value), record);
    if (!none || !once || !twice) return false;
    for (std::size_t i = 0; i < once->size(); ++i) {
      const double size = std::abs((*none)[i]) + std::abs((*twice)[i]);
      if (std::abs((*none)[i] - 2.0 * (*once)[i] + (*twice)[i]) > kRounding * std::max(1.0, size)) return false;
    }
  }
  return true;
}

// The equation as shape and strengths: one that the output is proportional to, several that it is a sum of, or none.
struct Parts {
  std::vector<std::size_t> shape, strength;  // numbers of parameters
};

Parts parts_of(const UserEffect& effect, const CampaignInput& input) {
  Parts out;
  std::vector<std::size_t> straight;
  for (std::size_t k = 0; k < effect.parameters.size(); ++k) {
    if (is_proportional(effect, k, input)) {
      if (out.strength.empty() || effect.parameters[k].name == kShare) out.strength = {k};  // a share of an earlier fit goes on being it
      continue;
    }
    out.shape.push_back(k);
    if (is_straight(effect, k, input)) straight.push_back(k);
  }
  if (!out.strength.empty() || straight.size() < 2 || !is_sum_of(straight, effect, input)) return out;
  out.strength = straight;
  std::erase_if(out.shape, [&](std::size_t k) { return std::ranges::find(straight, k) != straight.end(); });
  return out;
}

// The point that the user wrote, and each parameter a factor of three up and down.
std::vector<std::vector<double>> grid_of(const UserEffect& effect, const std::vector<std::size_t>& shape) {
  std::vector<double> centre;
  for (const std::size_t k : shape) centre.push_back(effect.parameters[k].value);
  std::vector<std::vector<double>> out{centre};
  if (is_fitted(effect)) return out;
  for (std::size_t k = 0; k < centre.size(); ++k)
    for (const double factor : {1.0 / 3.0, 3.0}) {
      const ParameterSpec spec = spec_of(effect.parameters[shape[k]]);
      std::vector<double> moved = centre;
      moved[k] = std::clamp(factor * centre[k], spec.minimum, spec.maximum);
      if (moved[k] != centre[k]) out.push_back(std::move(moved));
    }
  return out;
}

EffectForm form_of(const UserEffect& effect, const CampaignInput& input) {
  const Parts parts = parts_of(effect, input);
  EffectForm form;
  form.name = "equation";
  for (const std::size_t k : parts.shape) form.shape.push_back(spec_of(effect.parameters[k]));
  if (parts.strength.empty()) {
    std::string name = kShare;
    while (std::ranges::find(effect.parameters, name, &ModelParameter::name) != effect.parameters.end()) name += "_";
    form.strength.push_back({name, "1", -1e3, 1e3, 0.0, "factor on the whole output of the equation"});
  }
  for (const std::size_t k : parts.strength) {
    const ModelParameter& p = effect.parameters[k];
    form.strength.push_back(
        {p.name, p.unit, p.minimum, p.maximum, 0.0,
         parts.strength.size() == 1 ? "the output is proportional to it" : "a part of the output is proportional to it"});
  }
  if (parts.strength.size() == 1) {
    const ModelParameter& p = effect.parameters[parts.strength.front()];
    if (p.minimum > -kNoBound) form.least = p.minimum;
    if (p.maximum < kNoBound) form.most = p.maximum;
    if (p.minimum >= 0.0) form.sign = StrengthSign::positive;
    if (p.maximum <= 0.0) form.sign = StrengthSign::negative;
  }
  form.grid = [grid = grid_of(effect, parts.shape)](const CampaignInput&) { return grid; };
  form.columns = [unit = effect, parts](const CampaignInput&, const RecordInput& record, std::span<const double> shape, ColumnsRef columns) {
    columns.setZero();
    UserEffect at = unit;
    for (std::size_t k = 0; k < parts.shape.size(); ++k) at.parameters[parts.shape[k]].value = shape[k];
    const auto column_of = [&](Eigen::Index j, const UserEffect& part) {
      const auto added = user_effect_N(part, record);
      if (!added) return;  // a shape at which the equation has no value is no candidate
      for (std::size_t i = 0; i < added->size(); ++i) columns(static_cast<Eigen::Index>(i), j) = (*added)[i];
    };
    if (parts.strength.empty()) column_of(0, at);
    for (std::size_t j = 0; j < parts.strength.size(); ++j) column_of(static_cast<Eigen::Index>(j), one_alone(at, parts.strength, parts.strength[j], 1.0));
  };
  return form;
}

ModelParameter* parameter_of(UserEffect& effect, const std::string& name) {
  const auto found = std::ranges::find(effect.parameters, name, &ModelParameter::name);
  return found == effect.parameters.end() ? nullptr : &*found;
}

}  // namespace

Reach reach_of(const ModelParameter& p) {
  constexpr double kDecades = 100.0;
  const double written = std::isfinite(p.written) ? p.written : p.value;
  if (written == 0.0) return {p.minimum, p.maximum};
  const double a = written / kDecades, b = written * kDecades;  // the sign does not change
  return {std::max(p.minimum, std::min(a, b)), std::min(p.maximum, std::max(a, b))};
}

bool is_fitted(const UserEffect& effect) {
  return std::any_of(effect.parameters.begin(), effect.parameters.end(),
                     [](const ModelParameter& p) { return p.se > 0.0; });
}

Result<std::vector<std::unique_ptr<EffectKind>>> make_user_kinds(const std::vector<UserEffect>& effects,
                                                                 const CampaignInput& input) {
  std::vector<std::unique_ptr<EffectKind>> out;
  for (const UserEffect& effect : effects) {
    for (const RecordInput& record : input.records) FORCEGATE_CHECK_OK(user_effect_N(effect, record));
    auto kind = std::make_unique<EffectKind>();
    kind->name = effect.name;
    kind->side = "sensor";
    kind->summary = "the equation of the model file";
    kind->equation = "dF = " + effect.output;
    kind->source = "model file";
    kind->separates = "a stimulus that moves its states and not those of its rivals";
    kind->forms.push_back(form_of(effect, input));
    out.push_back(std::move(kind));
  }
  return out;
}

namespace {

bool moves_at_all(const std::vector<Eigen::MatrixXd>& columns, Eigen::Index j) {
  return std::ranges::any_of(columns, [&](const Eigen::MatrixXd& of_record) { return !of_record.col(j).isZero(0.0); });
}

// Least squares of column j on what the law has, W and 1, over all records: the share of its squares that is left.
double left_by_the_law(const CampaignInput& input, const std::vector<Eigen::MatrixXd>& columns, Eigen::Index j) {
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  for (std::size_t r = 0; r < columns.size(); ++r) {
    const RecordInput& record = input.records[r];
    for (std::size_t i = 0; i < record.rows(); ++i) {
      const double W = record.decay.empty() ? record.F_N[i] : record.base_force_N(i);
      const Eigen::Vector3d x(W, 1.0, columns[r](static_cast<Eigen::Index>(i), j));
      if (record.ok[i] != 0) gram += x * x.transpose();
    }
  }
  const Eigen::Vector2d beta = gram.topLeftCorner<2, 2>().ldlt().solve(gram.topRightCorner<2, 1>());
  return (gram(2, 2) - beta.dot(gram.topRightCorner<2, 1>())) / gram(2, 2);
}

bool moves(const std::vector<double>& x, double& low, double& high) {
  constexpr double kStill = 1e-9;
  for (const double v : x)
    if (std::isfinite(v)) low = std::min(low, v), high = std::max(high, v);
  return high - low > kStill * std::max(1.0, std::abs(high));
}

// What an equation asks for and these records hold at one value.
std::string still_input(const UserEffect& effect, const CampaignInput& input) {
  const auto equation = UserEquation::make(effect);
  if (!equation) return {};
  const auto stands_still = [&](const char* name, const std::vector<double> RecordInput::* channel) {
    double low = 1e300, high = -1e300;
    return (*equation)->uses(name) && std::ranges::none_of(input.records, [&](const RecordInput& r) { return moves(r.*channel, low, high); });
  };
  if (stands_still("T", &RecordInput::temp_C)) return "T";
  return stands_still("th", &RecordInput::theta_rad) ? "th" : "";
}

}  // namespace

Result<void> check_excited(const UserEffect& effect, const EffectKind& kind, const CampaignInput& input) {
  constexpr double kRounding = 1e-9;  // of squares
  const EffectForm& form = kind.forms.front();
  bool any = false;
  for (const std::vector<double>& shape : form.grid(input)) {
    std::vector<Eigen::MatrixXd> columns;
    double largest = 0.0;
    for (const RecordInput& record : input.records) {
      Eigen::MatrixXd column(static_cast<Eigen::Index>(record.rows()), static_cast<Eigen::Index>(form.strength.size()));
      form.columns(input, record, shape, column);
      largest = std::max(largest, column.cwiseAbs().maxCoeff());
      columns.push_back(column);
    }
    any |= largest > 0.0;
    for (Eigen::Index j = 0; j < columns.front().cols(); ++j)
      if (moves_at_all(columns, j) && left_by_the_law(input, columns, j) > kRounding) return {};
  }
  if (const std::string still = still_input(effect, input); any && !still.empty())
    return fail(ErrorCode::config,
                "the equation of " + effect.name + " depends on " + still +
                    ", which does not move in these records: gain and offset of the law are that already",
                input.name, std::string("records at several ") + (still == "T" ? "temperatures" : "angles") + " tell");
  if (any)
    return fail(ErrorCode::config, "the equation of " + effect.name + " is a straight line in the force on these records: gain and offset of the law are that already",
                input.name, "let it depend on dF, t, T, th or a state, or bend with F");
  std::string zero;
  for (const ModelParameter& p : effect.parameters)
    if (p.value == 0.0) zero += (zero.empty() ? "" : ", ") + p.name;
  return fail(ErrorCode::config, "the equation of " + effect.name + " gives 0 on every record: there is nothing to fit", input.name,
              zero.empty() ? "a state begins at 0, and one whose derivative is 0 there stays there; or the records do not reach where the equation acts"
                           : "begin with another value than 0 for " + zero);
}

UserEffect with_fit(const UserEffect& effect, const EffectForm& form, std::span<const Estimate> shape, std::span<const Estimate> strength) {
  UserEffect out = effect;
  for (ModelParameter& p : out.parameters) p.se = 0.0;
  for (std::size_t k = 0; k < shape.size(); ++k)
    if (ModelParameter* p = parameter_of(out, form.shape[k].name)) {
      if (!std::isfinite(p->written)) p->written = p->value;
      p->value = shape[k].value;
      p->se = shape[k].se;
    }
  for (std::size_t j = 0; j < form.strength.size(); ++j) {
    const ParameterSpec& spec = form.strength[j];
    ModelParameter* factor = parameter_of(out, spec.name);
    if (factor == nullptr) {
      out.output = spec.name + " * (" + out.output + ")";
      out.parameters.push_back({spec.name, spec.unit, 1.0, 0.0, spec.minimum, spec.maximum, 1.0});
      factor = &out.parameters.back();
    }
    factor->value = std::clamp(strength[j].value, factor->minimum, factor->maximum);
    factor->se = strength[j].se;
  }
  return out;
}

}  // namespace forcegate::diagnose
