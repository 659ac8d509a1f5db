#include "hil/gate/decision.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <iterator>
#include <string_view>
#include <vector>

#include "hil/base/text.h"

namespace forcegate {
namespace {

// A pass must be one: the label alone is not believed.
bool truly_passed(const Check& c, const DecisionRule& rule) {
  const bool label = c.verdict == Verdict::pass || (c.verdict == Verdict::marginal && rule.name == "simple");
  if (!label || !std::isfinite(c.value) || !(c.u >= 0.0)) return false;
  switch (c.limit.kind) {
    case Limit::Kind::upper: return c.value <= c.limit.value;
    case Limit::Kind::lower: return c.value >= c.limit.value;
    case Limit::Kind::equal: return c.value == c.limit.value;
    case Limit::Kind::none: return true;
  }
  return false;
}

// Titles that say how it should be; beside what happened they would read as the opposite of the decision.
bool title_is_a_promise(const Check& c) {
  constexpr std::string_view kPromises[] = {"firmware_runs", "session", "rig_runs", "safety_stop", "time_base", "record"};
  return std::find(std::begin(kPromises), std::end(kPromises), c.id) != std::end(kPromises);
}

std::string title_and_evidence(const Check& c) {
  if (c.evidence.empty() || !title_is_a_promise(c)) return c.evidence.empty() ? c.title : c.title + ": " + c.evidence;
  return c.evidence;
}

// Bytes and counts in full, as the tables have them.
std::string exact(double value) {
  return value == std::floor(value) && std::fabs(value) < 1e15 ? fmt::format("{:.0f}", value) : fmt::format("{:.6g}", value);
}

std::string named(const Check& c) { return c.case_id.empty() ? "" : fmt::format(" in {}", c.case_id); }

std::string more(std::size_t n) { return n > 1 ? fmt::format(" (and {} more)", n - 1) : std::string(); }

// The check to name first: what ended the record, then one of the whole run, then the one furthest beyond its limit. Of a limit of 0
// the count itself is how far: one sample in thousands is no headline before a value that is thousands of times its limit.
const Check* worst(const std::vector<const Check*>& checks) {
  const auto rank = [](const Check& c) {
    const double scale = c.limit.value != 0.0 ? std::fabs(c.limit.value) : 1.0;
    const double beyond = std::fabs(c.value - c.limit.value) / scale;
    return std::pair(title_is_a_promise(c) ? 2 : c.case_id.empty() ? 1 : 0, std::isfinite(beyond) ? beyond : 0.0);
  };
  return *std::max_element(checks.begin(), checks.end(),
                           [&](const Check* a, const Check* b) { return rank(*a) < rank(*b); });
}

// A value that could not be judged says less than what made it so.
const Check* cause(const std::vector<const Check*>& checks, std::initializer_list<std::string_view> ids) {
  for (const std::string_view id : ids)
    for (const Check* c : checks)
      if (c->id.starts_with(id)) return c;
  return nullptr;
}

bool is_algorithm_check(const Check& c) {
  return c.id.starts_with("mre_") || c.id.starts_with("mae_") || c.id.starts_with("promise_");
}

// An acceptance tells which comparison was asked for and left out.
std::string left_out(std::span<const Check* const> checks) {
  constexpr std::pair<std::string_view, std::string_view> kComparisons[] = {
      {"conformance", "conformance"}, {"rig_golden", "comparison with the golden traces"}, {"golden_firmware", "firmware against its golden trace"}};
  std::string text;
  for (const auto& [id, name] : kComparisons) {
    const auto is_left_out = [&id = id](const Check* c) { return c != nullptr && c->id == id && c->verdict == Verdict::not_run && !c->required; };
    const auto first = std::find_if(checks.begin(), checks.end(), is_left_out);
    if (first != checks.end()) text += fmt::format("; {} was not run: {}", name, (*first)->evidence);
  }
  return text;
}

// How far it lies from its limit, and what keeps it from being decided. Of a part of a record the number says nothing that the evidence does not.
std::string value_and_evidence(const Check& c) {
  const bool part = c.id == "coverage" || c.id == "extrema_count";
  if (part || c.evidence.empty() || title_is_a_promise(c) || c.limit.kind == Limit::Kind::none || !std::isfinite(c.value))
    return c.evidence.empty() ? check_in_words(c) : title_and_evidence(c);
  return check_in_words(c) + ": " + c.evidence;
}

Decision no_decision(Blame blame, int exit_code, std::string reason) {
  Decision d;
  d.kind = DecisionKind::no_decision;
  d.blame = blame;
  d.exit_code = exit_code;
  d.reason = std::move(reason);
  return d;
}

Decision reject(const std::vector<const Check*>& failed, std::span<const Check* const> all,
                const RunEvents& events) {
  Decision d;
  d.kind = DecisionKind::reject;
  d.exit_code = 1;
  // A waiver past its day says nothing about the build: what the build fails in comes first.
  std::vector<const Check*> of_build, of_user;
  std::ranges::partition_copy(failed, std::back_inserter(of_user), std::back_inserter(of_build), [](const Check* c) { return c->blame == Blame::user; });
  const std::vector<const Check*>& judged = of_build.empty() ? failed : of_build;
  const Check& first = *worst(judged);
  d.blame = first.blame == Blame::none ? Blame::firmware : first.blame;
  d.reason = check_in_words(first) + named(first) + more(failed.size());
  // Below level `identified` an image that does what its algorithm says fails for want of calibration.
  const bool only_algorithm =
      std::all_of(judged.begin(), judged.end(), [](const Check* c) { return is_algorithm_check(*c); });
  const bool conforms = std::any_of(all.begin(), all.end(), [](const Check* c) {
    return c->id == "conformance" && c->verdict == Verdict::pass;
  });
  const bool unknown = std::any_of(all.begin(), all.end(), [](const Check* c) {
    return c->id == "conformance" && c->verdict == Verdict::not_run;
  });
  if (events.level == CalibrationLevel::nominal && only_algorithm && unknown && judged.size() == failed.size())
    return no_decision(Blame::calibration, 3,
                       "firmware or calibration, it cannot be told at level 'nominal' of an algorithm that only the image knows: " +
                           d.reason + "; calibrate the specimen (--calibration identified, for a recording --cal FILE)");
  if (events.calibration_given && events.level == CalibrationLevel::identified && only_algorithm && conforms && judged.size() == failed.size())
    return no_decision(Blame::calibration, 3,
                       "the firmware does what its algorithm says of the calibration that was given, which may not be this specimen's: " + d.reason +
                           "; calibrate the specimen (on a rig leave out --cal; for a recording forcegate bench calibrate)");
  if (events.level != CalibrationLevel::identified && only_algorithm && conforms) {
    d.blame = Blame::calibration;
    d.reason = fmt::format(
        "calibration level '{}' is the cause, the firmware does what its algorithm says: {}; "
        "calibrate the specimen (--calibration identified, for a recording --cal FILE)",
        to_string(events.level), d.reason);
  }
  if (!of_build.empty() && !of_user.empty()) d.reason += "; besides, " + title_and_evidence(*of_user.front());
  if (events.safety_stop && !events.safety_text.empty() && d.reason.find(events.safety_text) == std::string::npos)
    d.reason += "; " + events.safety_text;
  return d;
}

struct SortedChecks {
  std::vector<const Check*> required, failed, rig, open;
};

SortedChecks sorted(std::span<const Check* const> checks, const DecisionRule& rule) {
  SortedChecks out;
  for (const Check* c : checks) {
    if (c == nullptr || !c->required) continue;
    out.required.push_back(c);
    if (c->verdict == Verdict::fail)
      out.failed.push_back(c);
    else if (c->verdict == Verdict::rig_error)
      out.rig.push_back(c);
    else if (c->verdict != Verdict::waived && !truly_passed(*c, rule))
      out.open.push_back(c);
  }
  return out;
}

Decision rig_at_fault(const std::vector<const Check*>& rig, const RunEvents& events) {
  const Check* root = cause(rig, {"rig_", "link_", "time_base", "coverage", "firmware_runs", "session", "safety_stop"});
  const Check& first = root != nullptr ? *root : *worst(rig);
  Blame blame = first.blame == Blame::none ? Blame::rig : first.blame;
  if (events.of_recording && (blame == Blame::link || blame == Blame::rig)) blame = Blame::recording;
  const std::string reason = first.evidence.empty() ? check_in_words(first) : title_and_evidence(first);
  return no_decision(blame, events.of_recording ? 3 : 4, reason + named(first) + more(rig.size()));
}

std::string why_open(const Check& c) {
  if (c.verdict == Verdict::marginal) return "inside the limit by less than its uncertainty: " + check_in_words(c);
  if (c.verdict == Verdict::not_run) return "not run: " + title_and_evidence(c);
  return "not decided: " + value_and_evidence(c);
}

Decision left_open(const std::vector<const Check*>& open) {
  // Something that is missing explains more than something that was close.
  const auto missing =
      std::find_if(open.begin(), open.end(), [](const Check* c) { return c->verdict == Verdict::not_run; });
  const Check* root = cause(open, {"rig_calibration_fits", "coverage", "extrema_count"});
  const Check& first = root != nullptr ? *root : missing != open.end() ? **missing : *worst(open);
  const Blame blame = first.blame == Blame::none ? Blame::user : first.blame;
  return no_decision(blame, 3, why_open(first) + named(first) + more(open.size()));
}

Decision accept(const std::vector<const Check*>& required, std::span<const Check* const> all) {
  Decision d;
  d.kind = DecisionKind::accept;
  d.blame = Blame::none;
  d.exit_code = 0;
  const auto waived = static_cast<std::size_t>(std::count_if(
      required.begin(), required.end(), [](const Check* c) { return c->verdict == Verdict::waived; }));
  d.reason = waived == 0
                 ? fmt::format("all {} required checks passed", required.size())
                 : fmt::format("{} required checks passed, {} waived", required.size() - waived, waived);
  d.reason += left_out(all);
  return d;
}

}  // namespace

std::string check_in_words(const Check& c) {
  const std::string title = !c.title.empty() ? c.title : !c.id.empty() ? c.id : "a check without a name";
  if (c.limit.kind == Limit::Kind::none || !std::isfinite(c.value))
    return c.evidence.empty() ? title : title_is_a_promise(c) ? c.evidence : title + ": " + c.evidence;
  const bool good = c.limit.kind == Limit::Kind::upper   ? c.value <= c.limit.value
                    : c.limit.kind == Limit::Kind::lower ? c.value >= c.limit.value
                                                         : c.value == c.limit.value;
  const char* relation = c.limit.kind == Limit::Kind::upper   ? (good ? "<=" : ">")
                         : c.limit.kind == Limit::Kind::lower ? (good ? ">=" : "<")
                                                              : (good ? "=" : "is not");
  const std::string unit = c.unit == "1" ? "" : " " + c.unit;
  const std::string value = c.u > 0.0 ? with_uncertainty(c.value, c.u) : exact(c.value);
  return fmt::format("{} {}{} {} {}{} ({})", title, value, unit, relation, exact(c.limit.value), unit, c.limit.source);
}

Decision decide(std::span<const Check* const> checks, const DecisionRule& rule, const RunEvents& events) {
  if (events.cancelled) return no_decision(Blame::user, 130, "interrupted before all records were judged");
  if (events.harness_error)
    return no_decision(Blame::harness, 6,
                       events.harness_text.empty() ? "internal error of the harness" : events.harness_text);
  const SortedChecks all = sorted(checks, rule);
  const bool undecided_stop = events.safety_stop && !events.safety_cause_decided;
  const auto with_stop = [&](Decision d) {
    d.safety_stop = events.safety_stop;
    return d;
  };
  // One file tells all records of a run what their sensor is: where it fits one of them badly, errors of another that it happens to fit better are its too.
  const bool misfit = std::ranges::any_of(all.open, [](const Check* c) { return c->id == "rig_calibration_fits"; });
  const bool could_be_misfit = misfit && std::ranges::all_of(all.failed, [](const Check* c) { return is_algorithm_check(*c); });
  if (!all.failed.empty() && !could_be_misfit) {
    Decision d = reject(all.failed, checks, events);
    if (d.kind == DecisionKind::reject || !undecided_stop) return with_stop(std::move(d));
  }
  if (undecided_stop)
    return with_stop(no_decision(
        Blame::rig, 5, events.safety_text.empty() ? "safety stop of undecided cause" : events.safety_text));
  if (!all.rig.empty()) return with_stop(rig_at_fault(all.rig, events));
  if (!all.open.empty()) return with_stop(left_open(all.open));
  const bool any_run = std::any_of(all.required.begin(), all.required.end(),
                                   [](const Check* c) { return c->verdict != Verdict::waived; });
  if (!any_run) return with_stop(no_decision(Blame::user, 3, "no required check was run"));
  if (events.safety_stop)
    return with_stop(no_decision(Blame::rig, 5, "a safety stop happened although every check passed"));
  return accept(all.required, checks);
}

}  // namespace forcegate
