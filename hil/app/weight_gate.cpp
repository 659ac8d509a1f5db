#include "hil/app/weight_gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "hil/app/gate_jobs.h"
#include "hil/app/run_folder.h"
#include "hil/app/watched_task.h"
#include "hil/base/digest.h"
#include "hil/base/rng.h"
#include "hil/base/text.h"
#include "hil/characterize/capacitance/weight_gate.h"
#include "hil/gate/decision.h"
#include "hil/interface/dut.h"

namespace forcegate {
namespace {

using namespace characterize;

constexpr std::size_t kBlock = 800;

struct Session {
  DutInfo info;
  FrameAnswers answers;
  DutCounters counters;
  std::string digest;
};

// In the child: a whole session of one sensor.
Result<std::string> play_session(const GateRequest& request, const LaneKind& lane, const WeightGatePlan& plan, const SensorFrames& frames, const DutSession& session) {
  FORCEGATE_TRY(const auto dut, lane.make(request.lane_options));
  FORCEGATE_TRY(const DutInfo info, dut->open(session));
  const std::size_t step = plan.frame_samples(), n = frames.codes.size();
  std::vector<float> force_N(n);
  std::vector<std::uint8_t> flags(n);
  SampleDigest digest;
  for (std::size_t at = 0; at < n; at += kBlock) {
    const std::size_t many = std::min(kBlock, n - at);
    FORCEGATE_CHECK_OK(dut->process(static_cast<std::uint32_t>(at), std::span(frames.codes).subspan(at, many), std::span(force_N).subspan(at, many), std::span(flags).subspan(at, many)));
    digest.update(&frames.codes[at], many * sizeof(std::uint16_t));
    digest.update(&force_N[at], many * sizeof(float));
    digest.update(&flags[at], many);
  }
  FORCEGATE_TRY(const DutCounters counters, dut->close());
  nlohmann::json out{{"info", {info.board, info.build_id, info.algorithm_id, info.protocol_major, info.protocol_minor}},
                     {"counters", {counters.samples, counters.frames_dropped, counters.frames_bad, counters.indices_lost}},
                     {"digest", digest.hex()}};
  for (std::size_t i = step - 1; i < n; i += step) {
    out["force"].push_back(std::isfinite(force_N[i]) ? nlohmann::json(force_N[i]) : nlohmann::json(nullptr));
    out["flags"].push_back(flags[i]);
  }
  return out.dump();
}

Session session_of(const std::string& text, const DutSession& asked) {
  const auto in = nlohmann::json::parse(text);
  Session s;
  s.info = {in["info"][3], in["info"][4], in["info"][0], in["info"][1], in["info"][2], asked.nonce, asked.calibration.adc_bits, asked.rate_Hz};
  s.counters.samples = in["counters"][0], s.counters.frames_dropped = in["counters"][1], s.counters.frames_bad = in["counters"][2], s.counters.indices_lost = in["counters"][3];
  s.digest = in["digest"];
  for (const auto& v : in["force"]) s.answers.force_N.push_back(v.is_null() ? std::numeric_limits<double>::quiet_NaN() : v.get<double>());
  for (const auto& v : in["flags"]) s.answers.flags.push_back(v.get<std::uint8_t>());
  return s;
}

class WeightGateRun {
 public:
  WeightGateRun(const GateRequest& request, WeightGatePlan plan, const LaneKind& lane) : request_(request), plan_(std::move(plan)), lane_(lane) {}

  Result<RunResult> run(const GateProgress& progress, const std::atomic<bool>* cancelled) {
    std::optional<RunFolder> folder;
    if (!request_.output.empty()) {
      FORCEGATE_TRY(RunFolder opened, RunFolder::open(request_.output));
      folder.emplace(std::move(opened));
    }
    const std::string bench = request_.rig == "emulated" ? "dead_weight" : request_.rig;
    FORCEGATE_TRY(pack_, play_pack(plan_, [&](double rate_Hz) {
                    auto options = request_.rig_options;
                    if (rate_Hz > 0.0) options["rate_Hz"] = shortest(rate_Hz);
                    return make_weight_bench(bench, options);
                  }));
    FORCEGATE_CHECK_OK(head());
    for (std::size_t s = 0; s < pack_.sensors.size(); ++s) {
      if (progress) progress(static_cast<double>(s) / static_cast<double>(pack_.sensors.size()), name_of(s));
      cancelled_ = cancelled_ || (cancelled != nullptr && cancelled->load());
      if (!cancelled_ && wanted(s)) FORCEGATE_CHECK_OK(sensor(s));
    }
    conclude();
    if (folder && !cancelled_) FORCEGATE_CHECK_OK(folder->publish(result_));
    return std::move(result_);
  }

 private:
  std::string name_of(std::size_t s) const { return fmt::format("pack{}-sensor{}", plan_.pack, s + 1); }
  bool wanted(std::size_t s) const {
    return request_.only_cases.empty() || std::find(request_.only_cases.begin(), request_.only_cases.end(), name_of(s)) != request_.only_cases.end();
  }

  Result<void> head() {
    result_.tool_version = FORCEGATE_VERSION;
    result_.command_line = request_.command_line;
    result_.started_at = request_.started_at;
    result_.plan_name = plan_.name;
    result_.plan_sha256 = plan_.sha256;
    result_.seed = plan_.study.seed;
    result_.firmware_path = request_.firmware.string();
    FORCEGATE_TRY(result_.firmware_sha256, image_sha256(request_.firmware));
    result_.rig.name = pack_.bench.name;
    result_.rig.version = pack_.bench.version;
    result_.rig.rate_Hz = pack_.bench.rate_Hz;
    result_.rig.adc_bits = pack_.bench.adc_bits;
    result_.rig.v_range_V = 2.0 * pack_.bench.range_V;
    result_.rig.force_max_N = pack_.bench.force_max_N;
    result_.rig.reference_resolution_N = 0.0;
    result_.rig.reference_u_rel = pack_.bench.force_u_rel;
    result_.rig.emulated = pack_.bench.emulated;
    result_.decision_rule = plan_.rule.to_text();
    result_.environment["compiler"] = "GCC " __VERSION__;
    result_.environment["lane"] = lane_.name;
    result_.notes.push_back(fmt::format("eq. (11) compares with the conductance model of the same {} training loadings; the networks belong to pack {} of seed {}", plan_.study.training, plan_.pack, plan_.study.seed));
    return {};
  }

  Result<void> sensor(std::size_t s) {
    const SensorFrames& frames = pack_.sensors[s];
    DutSession session;
    session.image = request_.firmware;
    session.rate_Hz = pack_.bench.rate_Hz;
    session.calibration.v_range_V = 2.0 * pack_.bench.range_V;
    session.calibration.adc_bits = pack_.bench.adc_bits;
    session.calibration.id = fmt::format("{}/{}/{}", plan_.study.seed, plan_.pack, s + 1);
    session.nonce = static_cast<std::uint32_t>(mix_seed(plan_.study.seed, result_.firmware_sha256 + name_of(s)) & 0xFFFFFFFFu);
    CaseResult out = case_of(s, frames, session.calibration);
    const auto text = run_watched({{out.id, [&](const auto&) { return play_session(request_, lane_, plan_, frames, session); }}}, {}).front();
    if (!text) {
      const ErrorCode code = text.error().code;
      if (code == ErrorCode::usage || code == ErrorCode::config || code == ErrorCode::io) return Unexpected(text.error());
      out.note = text.error().text;
      const std::string note = "no session: " + text.error().text;
      if (std::find(result_.notes.begin(), result_.notes.end(), note) == result_.notes.end()) result_.notes.push_back(note);
      failures_.emplace_back(result_.cases.size(), text.error());
      result_.cases.push_back(std::move(out));
      return {};
    }
    Session made = session_of(*text, session);
    result_.firmware = made.info;
    out.link = made.counters;
    out.digest = made.digest;
    out.overview.push_back({"weights", "N", {}, {}});
    out.overview.push_back({"firmware", "N", {}, {}});
    for (std::size_t i = 0; i < frames.force_N.size(); ++i)
      for (std::size_t k = 0; k < 2; ++k) {
        out.overview[k].t_s.push_back(static_cast<float>(static_cast<double>((i + 1) * plan_.frame_samples()) / plan_.rate_Hz));
        out.overview[k].value.push_back(static_cast<float>(k == 0 ? frames.force_N[i] : made.answers.force_N[i]));
      }
    for (JudgedCheck& j : judge_sensor(plan_, frames, made.answers, out.id)) judged_.emplace_back(result_.cases.size(), std::move(j));
    result_.cases.push_back(std::move(out));
    answers_.push_back(std::move(made.answers));
    return {};
  }

  CaseResult case_of(std::size_t s, const SensorFrames& frames, const Calibration& calibration) const {
    CaseResult out;
    out.id = name_of(s);
    out.title = fmt::format("Sensor {} of pack {}, {} loadings of 0 to {:.0f} N and a saturated amplifier", s + 1, plan_.pack, plan_.loadings, plan_.study.force_max_N);
    out.lane = lane_.name;
    out.loop = "open";
    out.stimulus = fmt::format("weights step_N={} force_max_N={}", shortest(plan_.study.step_N), shortest(plan_.study.force_max_N));
    out.facts.minimum_N = plan_.study.step_N;
    out.facts.maximum_N = plan_.study.force_max_N;
    out.facts.mean_N = 0.5 * plan_.study.force_max_N;
    out.parameter_source = "Paredes-Madrid 2010, IV";
    out.samples = frames.codes.size();
    out.duration_s = static_cast<double>(out.samples) / plan_.rate_Hz;
    out.specimen = calibration.id;
    out.seed = plan_.study.seed;
    out.calibration = calibration;
    return out;
  }

  void conclude() {
    for (const auto& [index, error] : failures_) {
      JudgedCheck j;
      j.check = {.id = "session", .case_id = result_.cases[index].id, .title = "The image answers", .value = 0.0, .unit = "1", .limit = {Limit::Kind::lower, 1.0, "docs/protocol.md"},
                 .blame = error.code == ErrorCode::firmware ? Blame::firmware : Blame::harness, .evidence = error.text};
      judged_.emplace_back(index, std::move(j));
    }
    std::vector<JudgedCheck> of_pack;
    if (answers_.size() == pack_.sensors.size()) of_pack = judge_pack(plan_, pack_, answers_);
    std::vector<JudgedCheck*> all;
    for (JudgedCheck& j : of_pack) all.push_back(&j);
    for (auto& [index, j] : judged_) all.push_back(&j);
    apply_rule(plan_.rule, all);
    RunEvents events;
    events.cancelled = cancelled_;
    for (const auto& [index, error] : failures_)
      if (error.code == ErrorCode::internal) events.harness_error = true, events.harness_text = error.text;
    std::vector<const Check*> checks;
    for (const JudgedCheck* j : all) checks.push_back(&j->check);
    result_.decision = decide(checks, plan_.rule, events);
    for (const JudgedCheck& j : of_pack) result_.checks.push_back(j.check);
    for (const auto& [index, j] : judged_) result_.cases[index].checks.push_back(j.check);
  }

  const GateRequest& request_;
  WeightGatePlan plan_;
  const LaneKind& lane_;
  PackFrames pack_;
  RunResult result_;
  std::vector<std::pair<std::size_t, JudgedCheck>> judged_;
  std::vector<std::pair<std::size_t, Error>> failures_;
  std::vector<FrameAnswers> answers_;
  bool cancelled_ = false;
};

}  // namespace

Result<bool> is_weight_gate(const GateRequest& request) {
  FORCEGATE_TRY(const std::filesystem::path path, find_plan(request.plan));
  const auto kind = plan_kind(path);
  return kind && *kind == "capacitance-gate";
}

Result<RunResult> weight_gate(const GateRequest& request, const GateProgress& progress, const std::atomic<bool>* cancelled) {
  if (!request.faults.empty() || !request.panel.empty() || !request.accepted.empty() || !request.calibration_file.empty() || request.level)
    return fail(ErrorCode::usage, "a plan of conductance and capacitance takes no faults, specimens, accepted build or calibration", {}, "leave those options out");
  FORCEGATE_TRY(const std::filesystem::path path, find_plan(request.plan));
  FORCEGATE_TRY(WeightGatePlan plan, read_weight_gate_plan(path));
  if (request.seed && *request.seed != plan.study.seed)
    return fail(ErrorCode::usage, "another seed is another pack, for which the image has no networks", "--seed", "leave it out");
  FORCEGATE_TRY(const std::string lane, choose_lane(request));
  return WeightGateRun(request, std::move(plan), *Registry<LaneKind>::instance().find(lane)).run(progress, cancelled);
}

}  // namespace forcegate
