#include "hil/characterize/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "hil/base/text.h"
#include "hil/trace/decimate.h"

namespace forcegate::characterize {

const std::vector<float>* Curve::find(std::string_view column) const {
  for (std::size_t k = 0; k < columns.size(); ++k)
    if (columns[k] == column) return &data[k];
  return nullptr;
}

const Measurement* SessionSheet::find(std::string_view key) const {
  for (const Measurement& m : values)
    if (m.key == key) return &m;
  return nullptr;
}

double SessionSheet::value(std::string_view key) const {
  const Measurement* m = find(key);
  return m != nullptr ? m->value : std::numeric_limits<double>::quiet_NaN();
}

SessionSheet run_session(Session& session, const std::vector<std::string>& procedures) {
  session.sheet.specimen = session.bench.setup().specimen;
  session.sheet.session = session.bench.setup().session;
  const auto& once = session.plan.once;
  for (const std::string& name : procedures) {
    if (session.sheet.session != 0 && std::find(once.begin(), once.end(), name) != once.end()) continue;
    const ProcedureKind* kind = Registry<ProcedureKind>::instance().find(name);
    Result<void> ran = kind == nullptr
                           ? Result<void>(fail(ErrorCode::config, "there is no procedure '" + name + "'"))
                       : kind->needs_calibration && !session.calibrated
                           ? Result<void>(fail(ErrorCode::config, "procedure '" + name + "' needs G and F0",
                                               {}, "list static_calibration before it"))
                           : kind->run(session);
    if (!ran) {
      Error error = ran.error();
      if (error.where.empty()) error.where = session.sheet.specimen + ", " + name;
      session.sheet.failure = std::move(error);
      break;
    }
  }
  session.sheet.samples = session.bench.samples();
  return std::move(session.sheet);
}

struct CurveSink::Impl {
  std::string name;
  bool closed_loop;
  double volts_per_code, first_s, last_s;
  M4Accumulator m4;
  std::vector<float> volts;
};

CurveSink::CurveSink(std::string name, double first_s, double last_s, double volts_per_code, bool closed_loop,
                     std::size_t columns)
    : impl_(new Impl{std::move(name),
                     closed_loop,
                     volts_per_code,
                     first_s,
                     last_s,
                     M4Accumulator(columns, first_s, last_s, closed_loop ? 4 : 3, {1, 2}),
                     {}}) {}
CurveSink::~CurveSink() = default;

void CurveSink::operator()(const RigBlock& block, std::size_t n, std::span<const float> estimate_N) {
  std::size_t from = 0, to = n;  // rows outside the span would all fall into its border columns
  while (from < to && block.t_s[from] < impl_->first_s) ++from;
  while (to > from && block.t_s[to - 1] > impl_->last_s) --to;
  if (from == to) return;
  impl_->volts.resize(std::max(impl_->volts.size(), n));
  for (std::size_t i = from; i < to; ++i)
    impl_->volts[i] = static_cast<float>(impl_->volts_per_code * block.adc[i]);
  const float* channels[4] = {block.setpoint_N.data() + from, block.force_ref_N.data() + from,
                              impl_->volts.data() + from,
                              estimate_N.empty() ? nullptr : estimate_N.data() + from};
  impl_->m4.push({block.t_s.data() + from, to - from}, {channels, impl_->closed_loop ? 4u : 3u});
}

Curve CurveSink::finish() {
  DecimatedRows rows = impl_->m4.rows();
  Curve c;
  c.name = impl_->name;
  c.columns = {"t_s", "setpoint_N", "ati_N", "sensor_V"};
  if (impl_->closed_loop) c.columns.emplace_back("estimate_N");
  c.data.push_back(std::move(rows.t_s));
  for (auto& value : rows.value) c.data.push_back(std::move(value));
  return c;
}

Result<DecayRecord> play_decay(Session& session, const std::string& set, const StimulusSpec& spec,
                               double prominence, const BlockSink& also, Extrema* keep) {
  Extrema extrema;
  FORCEGATE_TRY(DecayRecord d, measure_decay(session.bench, set, spec, prominence, also, &extrema));
  if (session.curves) {
    const std::string prefix = "extrema/" + set + "_";
    const auto before = std::count_if(session.sheet.curves.begin(), session.sheet.curves.end(),
                                      [&](const Curve& c) { return c.name.starts_with(prefix); });
    session.sheet.curves.push_back(extrema_curve(prefix + fmt::format("{:02d}", before + 1), extrema));
  }
  if (keep != nullptr) *keep = std::move(extrema);
  return d;
}

Curve extrema_curve(std::string name, const Extrema& extrema) {
  Curve c;
  c.name = std::move(name);
  c.columns = {"t_s", "setpoint_N", "ati_N", "sensor_V", "maximum"};
  c.data.resize(5);
  for (const bool maximum : {true, false}) {
    const Turns& t = maximum ? extrema.maxima : extrema.minima;
    for (std::size_t i = 0; i < t.size(); ++i) {
      c.data[0].push_back(static_cast<float>(t.t_s[i]));
      c.data[1].push_back(static_cast<float>(t.setpoint_N[i]));
      c.data[2].push_back(static_cast<float>(t.ati_N[i]));
      c.data[3].push_back(static_cast<float>(t.sensor_V[i]));
      c.data[4].push_back(maximum ? 1.0F : 0.0F);
    }
  }
  return c;
}

}  // namespace forcegate::characterize
