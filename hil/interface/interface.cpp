#include <cmath>

#include "hil/base/text.h"
#include "hil/interface/check.h"
#include "hil/interface/dut.h"
#include "hil/interface/run_result.h"
#include "hil/interface/weight_bench.h"

namespace forcegate {

std::string_view to_string(CalibrationLevel level) {
  switch (level) {
    case CalibrationLevel::nominal: return "nominal";
    case CalibrationLevel::statical: return "static";
    case CalibrationLevel::identified: return "identified";
  }
  return {};
}

std::string_view to_string(Verdict v) {
  switch (v) {
    case Verdict::pass: return "pass";
    case Verdict::marginal: return "marginal";
    case Verdict::fail: return "fail";
    case Verdict::inconclusive: return "inconclusive";
    case Verdict::rig_error: return "rig_error";
    case Verdict::not_run: return "not_run";
    case Verdict::waived: return "waived";
  }
  return {};
}

std::string_view to_string(DecisionKind d) {
  switch (d) {
    case DecisionKind::accept: return "ACCEPT";
    case DecisionKind::reject: return "REJECT";
    case DecisionKind::no_decision: return "NO-DECISION";
  }
  return {};
}

std::string_view to_string(Blame b) {
  switch (b) {
    case Blame::none: return "none";
    case Blame::firmware: return "firmware";
    case Blame::sensor: return "sensor";
    case Blame::rig: return "rig";
    case Blame::reference: return "reference";
    case Blame::link: return "link";
    case Blame::calibration: return "calibration";
    case Blame::user: return "user";
    case Blame::harness: return "harness";
    case Blame::recording: return "recording";
  }
  return {};
}

std::string_view to_string(Limit::Kind k) {
  switch (k) {
    case Limit::Kind::none: return "none";
    case Limit::Kind::upper: return "upper";
    case Limit::Kind::lower: return "lower";
    case Limit::Kind::equal: return "equal";
  }
  return {};
}

namespace {

Result<const StimulusKind*> find_stimulus(const std::string& name) {
  if (const StimulusKind* kind = Registry<StimulusKind>::instance().find(name)) return kind;
  const auto names = Registry<StimulusKind>::instance().names();
  const std::string near = nearest_name(name, names);
  return fail(ErrorCode::usage, "there is no stimulus named '" + printable_utf8(name) + "'", {},
              near.empty() ? "choose one of: " + join(names, ", ") : "did you mean '" + near + "'?");
}

Result<void> check_names(const StimulusSpec& spec, const StimulusKind& kind) {
  std::vector<std::string> known;
  for (const StimulusParameter& p : kind.parameters) known.push_back(p.name);
  const auto refuse_unknown = [&](const std::string& name) -> Result<void> {
    for (const std::string& k : known)
      if (k == name) return {};
    const std::string near = nearest_name(name, known);
    return fail(ErrorCode::usage,
                "stimulus '" + spec.name + "' has no parameter '" + printable_utf8(name) + "'", {},
                near.empty() ? "it has: " + join(known, ", ") : "did you mean '" + near + "'?");
  };
  for (const auto& [name, value] : spec.numbers) FORCEGATE_CHECK_OK(refuse_unknown(name));
  for (const auto& [name, value] : spec.lists) FORCEGATE_CHECK_OK(refuse_unknown(name));
  for (const auto& [name, value] : spec.texts) FORCEGATE_CHECK_OK(refuse_unknown(name));
  return {};
}

// Checks one parameter, or fills in what it is where nothing is given.
class ParameterCheck {
 public:
  ParameterCheck(StimulusSpec& spec, const StimulusParameter& parameter) : spec_(spec), p_(parameter) {}

  Result<void> run() {
    if (!p_.is_text && spec_.texts.contains(p_.name))
      return fail(ErrorCode::usage, "stimulus '" + spec_.name + "': " + p_.name + " is text, and must be a number", {}, "write it without quotes");
    return p_.is_text ? text() : p_.is_list ? list() : number();
  }

 private:
  Result<void> text() {
    if (spec_.texts.contains(p_.name)) return {};
    if (is_required()) return missing();
    spec_.texts[p_.name] = "";
    return {};
  }

  Result<void> list() {
    if (const auto n = spec_.numbers.find(p_.name); n != spec_.numbers.end()) {
      spec_.lists[p_.name] = {n->second};  // a single number is a list of one
      spec_.numbers.erase(n);
    }
    if (!spec_.lists.contains(p_.name)) {
      if (is_required()) return missing();
      spec_.lists[p_.name] = {};
    }
    for (const double v : spec_.lists[p_.name])
      if (!is_in_range(v)) return out_of_range(v);
    return {};
  }

  Result<void> number() {
    const auto [at, added] = spec_.numbers.try_emplace(p_.name, p_.fallback);
    if (added && std::isnan(at->second)) return missing();
    if (!is_in_range(at->second)) return out_of_range(at->second);
    return {};
  }

  bool is_required() const { return std::isnan(p_.fallback); }
  bool is_in_range(double v) const { return v >= p_.minimum && v <= p_.maximum; }  // nan is not
  Unexpected missing() const { return fail(ErrorCode::usage, "stimulus '" + spec_.name + "' needs " + p_.name, {}, p_.doc); }
  Unexpected out_of_range(double v) const {
    return fail(ErrorCode::usage,
                "stimulus '" + spec_.name + "': " + p_.name + " = " + shortest(v) + " is out of range", {},
                "give a value from " + shortest(p_.minimum) + " to " + shortest(p_.maximum) + " " + p_.unit);
  }

  StimulusSpec& spec_;
  const StimulusParameter& p_;
};

// The facts of a profile are those of its settled part: a record must reach it.
Result<void> check_reaches_settled_part(const StimulusSpec& spec) {
  const auto ramp = spec.numbers.find("ramp_s"), duration = spec.numbers.find("duration_s");
  if (ramp == spec.numbers.end() || duration == spec.numbers.end() || !(ramp->second > 0.0 && ramp->second >= duration->second)) return {};
  return fail(ErrorCode::usage,
              "stimulus '" + spec.name + "' ends at " + shortest(duration->second) + " s, inside its loading ramp of " + shortest(ramp->second) + " s", {},
              "raise duration_s, which counts the ramp, or lower ramp_s");
}

}  // namespace

Result<std::unique_ptr<Stimulus>> make_stimulus(StimulusSpec spec) {
  FORCEGATE_TRY(const StimulusKind* const kind, find_stimulus(spec.name));
  FORCEGATE_CHECK_OK(check_names(spec, *kind));
  for (const StimulusParameter& p : kind->parameters) FORCEGATE_CHECK_OK(ParameterCheck(spec, p).run());
  FORCEGATE_CHECK_OK(check_reaches_settled_part(spec));
  return kind->make(spec);
}

Unexpected wrong_rate(double image_Hz, double session_Hz, const std::string& where) {
  if (!(image_Hz > 0.0)) return fail(ErrorCode::firmware, "the image announces a rate of " + shortest(image_Hz) + " Hz", where, "mend what it announces");
  const auto a_thousand = [](double ratio) { return ratio > 999.0 && ratio < 1001.0; };
  const std::string unit = a_thousand(image_Hz / session_Hz)   ? "where the clock of the recording counts milliseconds: --map COLUMN=t_ms; else "
                           : a_thousand(session_Hz / image_Hz) ? "where the clock of the recording, read as milliseconds, counts seconds: --map COLUMN=t_s; else "
                                                               : "";
  return fail(ErrorCode::config, "the image runs at " + shortest(image_Hz) + " Hz, what it is to follow at " + shortest(session_Hz) + " Hz", where,
              unit + "gate it on a recording at " + shortest(image_Hz) + " Hz (forcegate record --rate " + shortest(image_Hz) +
                  " makes one, gate --record plays it) or on a bench whose board samples so, or build the image for " + shortest(session_Hz) + " Hz");
}

Result<void> check_echo(const DutEcho& echo, const DutSession& session, const std::string& who, const std::string& where) {
  if (echo.protocol_major != kProtocolMajor)
    return fail(ErrorCode::firmware, who + " speaks an unknown protocol major " + std::to_string(echo.protocol_major) + ", not " + std::to_string(kProtocolMajor), where);
  if (echo.nonce != session.nonce)
    return fail(ErrorCode::firmware, who + " does not echo the nonce: stale output is never judged", where);
  // Before the calibration: an image that refuses a rate need not have looked at it.
  if (echo.rate_Hz != session.rate_Hz) return wrong_rate(echo.rate_Hz, session.rate_Hz, where);
  if (!echo.calibration) return fail(ErrorCode::firmware, who + " does not echo the calibration", where);
  return {};
}

Result<const RigKind*> find_rig(const std::string& name) {
  if (const RigKind* kind = Registry<RigKind>::instance().find(name)) return kind;
  const auto names = Registry<RigKind>::instance().names();
  const std::string near = nearest_name(name, names);
  return fail(ErrorCode::usage, "there is no rig named '" + printable_utf8(name) + "'", "--rig",
              near.empty() ? "choose one of: " + join(names, ", ") : "did you mean '" + near + "'?");
}

Result<std::unique_ptr<Rig>> make_rig(const std::string& name,
                                      const std::map<std::string, std::string>& options) {
  FORCEGATE_TRY(const RigKind* const kind, find_rig(name));
  return kind->make(options);
}

Result<std::unique_ptr<WeightBench>> make_weight_bench(const std::string& name,
                                                       const std::map<std::string, std::string>& options) {
  const WeightBenchKind* kind = Registry<WeightBenchKind>::instance().find(name);
  if (kind == nullptr) {
    const auto names = Registry<WeightBenchKind>::instance().names();
    return fail(ErrorCode::usage, "there is no bench of weights named '" + printable_utf8(name) + "'", {},
                "choose one of: " + join(names, ", "));
  }
  return kind->make(options);
}

}  // namespace forcegate
