#include "hil/characterize/population_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <utility>

#include "hil/base/parallel.h"
#include "hil/base/text.h"
#include "hil/gate/statistics.h"

namespace forcegate::characterize {
namespace {

struct Job {
  std::size_t sensor = 0;
  std::string specimen;
  int session = 0;
  bool exemplar = false;     ///< of the plan: in no statistic
  bool with_curves = false;
};

Spread spread_of(const SensorStudy& study, const Measurement& what) {
  Spread s{what.key, what.title, what.unit};
  std::map<std::string, std::vector<double>> by_specimen;
  std::vector<double> all, means;
  double within = 0.0, dof = 0.0;
  for (const SessionSheet& sheet : study.sheets) {
    const double v = sheet.failure ? std::nan("") : sheet.value(what.key);
    if (!std::isfinite(v)) continue;
    all.push_back(v);
    by_specimen[sheet.specimen].push_back(v);
  }
  for (const auto& [name, values] : by_specimen) {
    const Moments m = moments(values);
    means.push_back(m.mean);
    if (values.size() < 2) continue;
    within += m.sd * m.sd * static_cast<double>(values.size() - 1);
    dof += static_cast<double>(values.size() - 1);
  }
  s.n = all.size();
  s.specimens = means.size();
  const Moments m = moments(means);
  s.mean = m.mean;
  s.sd_specimens = m.sd;
  s.sd_sessions = dof > 0.0 ? std::sqrt(within / dof) : std::nan("");
  s.lowest = sample_quantile(all, 0.0);
  s.q05 = sample_quantile(all, 0.05);
  s.median = sample_quantile(all, 0.5);
  s.q95 = sample_quantile(all, 0.95);
  s.largest = sample_quantile(all, 1.0);
  return s;
}

// By a procedure that later sessions do not repeat.
bool measured_once(const StudyPlan& plan, const SensorStudy& study, const std::string& key) {
  return !plan.once.empty() && std::ranges::none_of(study.sheets, [&](const SessionSheet& s) { return s.session != 0 && s.find(key) != nullptr; });
}

std::vector<std::string> keys_of(const StudyPlan& plan, const std::vector<std::string>& sensors) {
  std::vector<std::string> out;
  for (const std::string& sensor : sensors)
    for (const std::string& name : sensor == "fsr" ? plan.fsr : plan.flexiforce)
      if (const ProcedureKind* kind = Registry<ProcedureKind>::instance().find(name))
        for (std::string& key : kind->keys(plan, sensor))
          if (std::ranges::find(out, key) == out.end()) out.push_back(std::move(key));
  return out;
}

// The procedure that measures it where the plan lists that one.
std::string measured_by(const StudyPlan& plan, const std::string& key) {
  for (const ProcedureKind& kind : Registry<ProcedureKind>::instance().all())
    for (const char* sensor : {"flexiforce", "fsr"})
      if (const auto keys = kind.keys(plan, sensor); std::ranges::find(keys, key) != keys.end()) return fmt::format("{} of {}", kind.name, sensor);
  return {};
}

}  // namespace

Result<void> check_limit_keys(const StudyPlan& plan, const std::vector<std::string>& sensors) {
  const std::vector<std::string> keys = keys_of(plan, sensors);
  for (const StudyLimit& limit : plan.limits) {
    if (std::ranges::find(keys, limit.key) != keys.end()) continue;
    const std::string near = nearest_name(limit.key, keys), by = measured_by(plan, limit.key);
    return fail(ErrorCode::config, fmt::format("no procedure that this run plays measures \"{}\", which a limit is set on", printable_utf8(limit.key)), limit.where,
                !by.empty()     ? fmt::format("that is measured by {}: list it under [procedures] and play that sensor, or take the limit out", by)
                : !near.empty() ? fmt::format("did you mean \"{}\"? forcegate characterize --help names every key", near)
                                : "the procedures of this run measure " + join(keys, ", "));
  }
  return {};
}

void summarise(SensorStudy& study, const StudyPlan& plan) {
  std::vector<std::string> seen;
  for (const SessionSheet& sheet : study.sheets)
    for (const Measurement& m : sheet.values) {
      if (std::find(seen.begin(), seen.end(), m.key) != seen.end()) continue;
      seen.push_back(m.key);
      study.spreads.push_back(spread_of(study, m));
    }
  std::vector<SessionSheet> sound;
  for (const SessionSheet& sheet : study.sheets)
    if (!sheet.failure) sound.push_back(sheet);
  if (study.sensor == "flexiforce") study.laws = study_laws(sound, plan.identification);
}

MeanSd mean_and_sd(const std::vector<double>& values) {
  const Moments m = moments(values);
  return {m.mean, m.sd, m.n};
}

std::vector<LimitResult> check_limits(const std::vector<SensorStudy>& studies, const StudyPlan& plan) {
  std::vector<LimitResult> out;
  for (const StudyLimit& limit : plan.limits) {
    bool measured = false;
    for (const SensorStudy& study : studies) {
      const Spread* spread = study.find(limit.key);
      if (spread == nullptr) continue;
      measured = true;
      LimitResult r;
      r.limit = limit, r.sensor = study.sensor, r.title = spread->title, r.unit = spread->unit;
      double least_room = std::numeric_limits<double>::infinity();
      const bool once = measured_once(plan, study, limit.key);
      for (const SessionSheet& sheet : study.sheets) {
        if (once && sheet.session != 0) continue;
        if (study.of_recordings && sheet.find(limit.key) == nullptr) continue;
        const double v = sheet.failure ? std::nan("") : sheet.value(limit.key);
        ++r.sessions;
        if (!(v >= limit.minimum && v <= limit.maximum)) ++r.outside;
        const double room = std::isnan(v) ? -std::numeric_limits<double>::infinity()
                                          : std::min(v - limit.minimum, limit.maximum - v);
        if (r.sessions == 1 || room < least_room) least_room = room, r.worst = v, r.specimen = sheet.specimen;
      }
      r.kept = r.sessions > 0 && r.outside == 0;
      out.push_back(std::move(r));
    }
    if (!measured)
      out.push_back({limit, "-", limit.key + ": not measured", "", std::nan(""), "-", 0, 0, false});
  }
  return out;
}

const Spread* SensorStudy::find(std::string_view key) const {
  for (const Spread& s : spreads)
    if (s.key == key) return &s;
  return nullptr;
}

SensorStudy::Share SensorStudy::share_where(std::string_view key,
                                            const std::function<bool(double)>& test) const {
  Share out;
  std::size_t hits = 0;
  for (const SessionSheet& sheet : sheets) {
    const Measurement* m = sheet.failure ? nullptr : sheet.find(key);
    if (m == nullptr) continue;
    ++out.n;
    hits += test(m->value) ? 1u : 0u;
  }
  out.share = out.n > 0 ? static_cast<double>(hits) / static_cast<double>(out.n) : std::nan("");
  return out;
}

Result<std::vector<SensorStudy>> run_study(const StudyRequest& request, BenchProgress& progress) {
  const StudyPlan& plan = request.plan;
  std::vector<SensorStudy> studies;
  std::vector<Job> jobs;
  for (std::size_t k = 0; k < request.sensors.size(); ++k) {
    studies.emplace_back().sensor = request.sensors[k];
    FORCEGATE_TRY(const auto probe, request.make_rig(request.sensors[k]));
    (void)probe;
    if (!plan.exemplar.empty() && !request.first_is_exemplar) jobs.push_back({k, plan.exemplar, 0, true, true});
    bool with_curves = request.first_is_exemplar;
    for (const std::string& specimen : plan.specimens)
      for (int session = 0; session < plan.sessions; ++session) jobs.push_back({k, specimen, session, false, std::exchange(with_curves, false)});
  }
  std::vector<SessionSheet> sheets(jobs.size());
  std::atomic<std::size_t> finished{0};
  parallel_for(jobs.size(), request.threads, [&](std::size_t i) {
    const Job& job = jobs[i];
    const std::string& sensor = request.sensors[job.sensor];
    sheets[i].specimen = job.specimen;
    sheets[i].session = static_cast<std::uint64_t>(job.session);
    if (progress.is_cancelled()) return;
    auto rig = request.make_rig(sensor);
    if (!rig) {
      sheets[i].failure = rig.error();
      return;
    }
    Bench::Setup setup;
    setup.specimen = job.specimen;
    setup.seed = plan.seed;
    setup.session = static_cast<std::uint64_t>(job.session);
    setup.rest_s = plan.rest_s;
    Bench bench(**rig, setup, progress);
    Session session(bench, plan, sensor, request.compensation, job.with_curves);
    sheets[i] = run_session(session, sensor == "fsr" ? plan.fsr : plan.flexiforce);
    if (request.progress)
      request.progress(static_cast<double>(++finished) / static_cast<double>(jobs.size()),
                       fmt::format("{} {}, session {}", sensor, job.specimen, job.session));
  });
  if (progress.is_cancelled()) return fail(ErrorCode::cancelled, "interrupted");
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    SensorStudy& study = studies[jobs[i].sensor];
    study.samples += sheets[i].samples;
    if (jobs[i].exemplar) {
      study.exemplar = std::move(sheets[i]);
      continue;
    }
    if (jobs[i].with_curves && !sheets[i].failure) {
      study.exemplar = sheets[i];
      sheets[i].curves.clear();
    }
    study.sheets.push_back(std::move(sheets[i]));
  }
  for (SensorStudy& study : studies) {
    FORCEGATE_TRY(const auto rig, request.make_rig(study.sensor));
    study.rig_time_s = static_cast<double>(study.samples) / rig->info().rate_Hz;
    summarise(study, plan);
  }
  return studies;
}

}  // namespace forcegate::characterize
