#include "hil/diagnose/answer/decay_course.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "hil/base/parallel.h"
#include "hil/base/plain_number.h"
#include "hil/diagnose/base/own_decay.h"
#include "hil/diagnose/diagnosis.h"
#include "hil/model/decay_clock.h"

namespace forcegate::diagnose {

namespace {

void tell_of_one_recording(const Workspace& w, Diagnosis& out) {
  const RecordInput& r = w.input.records.front();
  if (!w.law.decays || !r.dynamic || r.decay.empty()) return;
  const double by_law = decay_factor(DecayClock(r, w.law.loading_share)(r.rows() - 1), w.law.decay_rate_per_s(r.f_Hz), w.law.depth_ratio(r.A_N));
  out.notes.push_back(fmt::format("its swing goes down to {:.3g} % by the end of the recording, which is taken for the decay of the base law; by the model's constants it would be {:.3g} %",
                                  100.0 * r.decay.back(), 100.0 * by_law));
}

struct Course {
  std::size_t record = 0;
  double left_V = 0.0, beside_V = 0.0;  // RMS
};

// Effects of the library as the file writes them, and fitted equations of the user's own.
bool has_effects(const Workspace& w, const MixedFit& fit) {
  const auto is_users = [&](const Candidate& c) { return std::ranges::any_of(w.user_kinds, [&](const auto& kind) { return kind.get() == c.kind; }); };
  return std::ranges::any_of(w.output.candidates, [&](const Candidate& c) {
    return c.of_model || (is_users(c) && std::ranges::any_of(fit.columns, [&](int column) { return c.owns(column); }));
  });
}

// A change of frequency is not counted: how the decay goes on after it differs from law to law. Nor is a record asked where the model has
// effects of its own: what a lag leaves of a straight line is no matter of the decay.
std::vector<Course> not_exponential(const Workspace& w, const MixedFit& fit, unsigned threads) {
  constexpr double kLeast = 1e-3;  // of the span
  if (has_effects(w, fit)) return {};
  std::vector<Course> all(w.output.record_of.size());
  parallel_for(all.size(), threads, [&](std::size_t i) {
    const RecordInput& r = w.input.records[w.output.record_of[i]];
    const RecordGram& gram = w.output.problem.records[i];
    if (!r.dynamic || !r.frequency_jumps_s.empty()) return;
    const double beside = std::sqrt(std::max(fit.adapted[i], gram.allowed_variance + gram.smoothed_variance)), left = std::sqrt(left_by_decay(r)) / w.output.scale;
    if (left > kFarAboveNoise * beside && left > kLeast) all[i] = {w.output.record_of[i], left * w.output.scale, beside * w.output.scale};
  });
  std::erase_if(all, [](const Course& c) { return c.left_V == 0.0; });
  return all;
}

}  // namespace

void tell_decay(const Workspace& w, const MixedFit& fit, unsigned threads, Diagnosis& out) {
  if (w.input.single) return tell_of_one_recording(w, out);
  constexpr std::size_t kSeveral = 2, kNamed = 3;
  if (out.verdict == DiagnosisVerdict::known || w.input.generic || !fit.valid) return;
  const std::vector<Course> courses = not_exponential(w, fit, threads);
  const bool bears_law = w.law.decays && courses.size() < kSeveral;
  if (w.decays_otherwise && !bears_law && out.verdict == DiagnosisVerdict::none) {
    out.verdict = DiagnosisVerdict::unknown;
    out.depends_on = {"time"};
    out.follows = {"the decay of the maxima, which has another course than the model's"};
  }
  if (courses.size() < kSeveral) return;
  const PrintedUnit unit = printed_unit(w.output.unit);
  std::string which;
  for (std::size_t k = 0; k < std::min(kNamed, courses.size()); ++k)
    which += fmt::format("{}{} ({} {} beside {})", k == 0 ? "" : ", ", w.input.records[courses[k].record].name, plain_number(courses[k].left_V * unit.factor),
                         unit.name, plain_number(courses[k].beside_V * unit.factor));
  if (courses.size() > kNamed) which += fmt::format(" and {} more", courses.size() - kNamed);
  out.notes.push_back("the decay of the maxima is no single exponential: one of any rate and depth leaves more than the noise in " + which +
                      "; each record's own course is taken for it, so the error of one law for all is larger");
}

}  // namespace forcegate::diagnose
