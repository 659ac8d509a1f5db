#include "hil/app/gate/weight_gate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "hil/app/files/find_plan.h"
#include "hil/app/gate/accepted_build.h"
#include "hil/app/gate/bundle.h"
#include "hil/app/gate/gate_jobs.h"
#include "hil/app/gate/same_conditions.h"
#include "hil/app/play/weight_session.h"
#include "hil/base/rng.h"
#include "hil/base/text.h"

namespace forcegate {
namespace {

using namespace characterize;

constexpr const char* kBench = "dead_weight";

std::string sensor_name(const WeightGatePlan& plan, std::size_t sensor) {
  return fmt::format("pack{}-sensor{}", plan.pack, sensor + 1);
}

Result<PackFrames> frames_of(const WeightGatePlan& plan, const std::string& bench,
                             const std::map<std::string, std::string>& options) {
  return play_pack(plan, [&](double rate_Hz) {
    auto own = options;
    if (rate_Hz > 0.0) own["rate_Hz"] = shortest(rate_Hz);
    return make_weight_bench(bench, own);
  });
}

DutSession session_of(const WeightGatePlan& plan, const WeightBenchInfo& bench, std::size_t sensor,
                      const std::filesystem::path& image, const std::string& image_sha256) {
  DutSession session;
  session.image = image;
  session.rate_Hz = bench.rate_Hz;
  session.calibration.v_range_V = 2.0 * bench.range_V;
  session.calibration.adc_bits = bench.adc_bits;
  session.calibration.id = fmt::format("{}/{}/{}", plan.study.seed, plan.pack, sensor + 1);
  session.nonce = static_cast<std::uint32_t>(
      mix_seed(plan.study.seed, image_sha256 + sensor_name(plan, sensor)) & 0xFFFFFFFFu);
  return session;
}

constexpr std::string_view kOption = "option ", kLaneOption = "lane option ";

using Options = std::map<std::string, std::string>;

RigInfo rig_of(const WeightBenchInfo& bench, const Options& options, const Options& lane_options) {
  RigInfo rig;
  rig.name = bench.name;
  rig.id = fmt::format("{} sensors under weights", bench.sensors);
  rig.version = bench.version;
  rig.rate_Hz = bench.rate_Hz;
  rig.adc_bits = bench.adc_bits;
  rig.v_range_V = 2.0 * bench.range_V;
  rig.force_max_N = bench.force_max_N;
  rig.reference_resolution_N = 0.0;
  rig.reference_u_rel = bench.force_u_rel;
  rig.emulated = bench.emulated;
  rig.details["reference"] = "weights";
  rig.details["feedback resistor"] = shortest(bench.feedback_ohm) + " ohm";
  rig.details["amplifier saturates at"] = shortest(bench.rail_V) + " V";
  for (const auto& [name, value] : options) rig.details[std::string(kOption) + name] = value;
  for (const auto& [name, value] : lane_options) rig.details[std::string(kLaneOption) + name] = value;
  return rig;
}

class WeightGateRun {
 public:
  WeightGateRun(const GateRequest& request, WeightGatePlan plan, std::string lane,
                const std::atomic<bool>* cancelled)
      : request_(request), lane_(std::move(lane)), cancelled_(cancelled) {
    m_.plan = std::move(plan);
  }

  Result<RunResult> run(const GateProgress& progress) {
    FORCEGATE_TRY(const std::string sha256, image_sha256(request_.firmware));
    FORCEGATE_TRY(evidence_, read_evidence(request_, m_.plan.path, m_.plan.goldens));
    std::optional<RunFolder> folder;
    if (!request_.output.empty()) {
      FORCEGATE_TRY(RunFolder opened, RunFolder::open(request_.output, {request_.firmware, request_.accepted, m_.plan.path, m_.plan.study.path, request_.waivers}));
      folder.emplace(std::move(opened));
    }
    if (progress) progress(0.0, "training and frames");
    FORCEGATE_TRY(
        pack_, frames_of(m_.plan, request_.rig == "emulated" ? kBench : request_.rig, request_.rig_options));
    head(sha256);
    FORCEGATE_CHECK_OK(choose_sensors());
    if (!request_.accepted.empty()) FORCEGATE_CHECK_OK(open_the_accepted());
    FORCEGATE_CHECK_OK(play(progress));
    m_.cancelled = cancelled_ != nullptr && cancelled_->load();
    std::vector<GoldenMargins> margins;
    RunResult result = judged_run(m_, evidence_, m_.head.notes, &margins);
    if (folder && result.decision.exit_code != kInterrupted)
      if (auto published = publish_run(*folder, {m_.plan.path, request_.firmware, {}, request_.waivers, evidence_, request_.plan}, m_, margins, result); !published)
        note_not_written(result, std::move(published.error()));
    return result;
  }

 private:
  static constexpr int kInterrupted = 130;

  void head(const std::string& sha256) {
    m_.sensors = pack_.sensors.size();
    RunResult& h = m_.head;
    h = run_head(request_, sha256, lane_);
    h.plan_name = m_.plan.name;
    h.plan_sha256 = m_.plan.sha256;
    h.seed = m_.plan.study.seed;
    h.rig = rig_of(pack_.bench, request_.rig_options, request_.lane_options);
    h.decision_rule = m_.plan.rule.to_text();
    state_conditions(request_, h);
    h.notes.push_back(fmt::format(
        "eq. (11) compares with the conductance model of the same {} training loadings; the networks belong to pack {} of seed {}",
        m_.plan.study.training, m_.plan.pack, m_.plan.study.seed));
  }

  Result<void> choose_sensors() {
    std::vector<std::string> names;
    for (std::size_t s = 0; s < m_.sensors; ++s) names.push_back(sensor_name(m_.plan, s));
    FORCEGATE_CHECK_OK(known_cases(request_.only_cases, names, m_.plan.path.string()));
    for (std::size_t s = 0; s < m_.sensors; ++s)
      if (request_.only_cases.empty() || std::find(request_.only_cases.begin(), request_.only_cases.end(),
                                                   names[s]) != request_.only_cases.end()) {
        SensorRecord& record = m_.records.emplace_back();
        record.sensor = s;
        record.frames = pack_.sensors[s];
        record.frames.codes.clear();
        m_.head.cases.push_back(case_of(s));
      }
    if (m_.records.size() < m_.sensors)
      m_.head.notes.push_back(
          fmt::format("{} of {} sensors were played: what is asked of the whole pack was not judged",
                      m_.records.size(), m_.sensors));
    return {};
  }

  CaseResult case_of(std::size_t s) const {
    const WeightPlan& study = m_.plan.study;
    CaseResult out;
    out.id = sensor_name(m_.plan, s);
    out.title = fmt::format("Sensor {} of pack {}, {} loadings of 0 to {:.0f} N and a saturated amplifier",
                            s + 1, m_.plan.pack, m_.plan.loadings, study.force_max_N);
    out.lane = lane_;
    out.loop = "open";
    out.stimulus =
        fmt::format("weights step_N={} force_max_N={}", shortest(study.step_N), shortest(study.force_max_N));
    out.facts.minimum_N = study.step_N;
    out.facts.maximum_N = study.force_max_N;
    out.facts.mean_N = 0.5 * study.force_max_N;
    out.parameter_source = "Paredes-Madrid 2010, IV";
    out.samples = pack_.sensors[s].codes.size();
    out.duration_s = static_cast<double>(out.samples) / m_.plan.rate_Hz;
    out.lag_s = std::nan("");  // a force a frame under weights that stand
    out.seed = study.seed;
    out.calibration = session_of(m_.plan, pack_.bench, s, {}, {}).calibration;
    out.specimen = out.calibration.id;
    return out;
  }

  Result<void> open_the_accepted() {
    FORCEGATE_TRY(accepted_, open_accepted(request_, nullptr, m_.head));
    m_.head.notes.push_back(accepted_note(*accepted_));
    m_.with_accepted = true;
    if (!accepted_->stored) return {};
    const std::filesystem::path path = accepted_->path;
    auto bundle = read_bundle(path.parent_path());
    if (!bundle)
      return fail(
          ErrorCode::usage,
          "the stored run of the accepted build cannot be compared frame by frame: " + bundle.error().text,
          bundle.error().where, "give the folder of its run as forcegate gate -o wrote it, or its image");
    const auto* theirs = std::get_if<WeightMaterial>(&bundle->material);
    if (theirs == nullptr)
      return fail(ErrorCode::usage, "the stored run is of another kind of gate", accepted_->path);
    for (SensorRecord& own : m_.records)
      for (const SensorRecord& one : theirs->records)
        if (one.sensor == own.sensor) own.accepted_N = one.answers.force_N;
    return {};
  }

  // The candidate's sessions and, in turn with them, those of the accepted image.
  Result<void> play(const GateProgress& progress) {
    std::vector<WeightSession> sessions;
    const bool both = accepted_ && !accepted_->stored;
    for (const SensorRecord& record : m_.records) {
      const auto add = [&](const std::filesystem::path& image, const std::string& sha256,
                           const std::string& lane) {
        sessions.push_back({sensor_name(m_.plan, record.sensor), lane, request_.lane_options,
                            session_of(m_.plan, pack_.bench, record.sensor, image, sha256),
                            &pack_.sensors[record.sensor], m_.plan.frame_samples()});
      };
      add(request_.firmware, m_.head.firmware_sha256, lane_);
      if (both) add(accepted_->path, accepted_->sha256, accepted_lane(lane_, *accepted_));
    }
    WorkerOptions options;
    options.workers = request_.threads;
    options.hang_cpu_s = request_.hang_cpu_s;
    options.cancelled = cancelled_;
    double done = 0.0;
    const WorkerEvents events{{}, [&](std::size_t k) {
                                done += 1.0;
                                if (progress)
                                  progress(done / static_cast<double>(sessions.size()), sessions[k].id);
                              }};
    auto answers = run_weight_sessions(sessions, options, events);
    for (std::size_t i = 0; i < m_.records.size(); ++i) {
      FORCEGATE_CHECK_OK(take(i, std::move(answers[both ? 2 * i : i])));
      if (both && answers[2 * i + 1])
        m_.records[i].accepted_N = std::move(answers[2 * i + 1]->answers.force_N);
    }
    return {};
  }

  Result<void> take(std::size_t i, Result<WeightSessionAnswer> answer) {
    SensorRecord& record = m_.records[i];
    if (answer) {
      CaseResult& c = m_.head.cases[i];
      m_.head.firmware = answer->firmware;
      c.link = answer->link;
      c.digest = std::move(answer->digest);
      record.answers = std::move(answer->answers);
      return {};
    }
    const ErrorCode code = answer.error().code;
    if (code == ErrorCode::usage || code == ErrorCode::config || code == ErrorCode::io)
      return Unexpected(answer.error());
    record.failure = answer.error();
    const std::string note = "no session: " + answer.error().text;
    if (std::find(m_.head.notes.begin(), m_.head.notes.end(), note) == m_.head.notes.end())
      m_.head.notes.push_back(note);
    return {};
  }

  const GateRequest& request_;
  const std::string lane_;
  const std::atomic<bool>* cancelled_;
  RunEvidence evidence_;
  PackFrames pack_;
  WeightMaterial m_;
  std::optional<AcceptedBuild> accepted_;
};

// Options of the other kind of gate, and why they mean nothing here.
Result<void> refuse_what_means_nothing(const GateRequest& request, const WeightGatePlan& plan) {
  const auto refuse = [&](bool given, const char* option, const char* why,
                          const char* help = "leave it out") -> Result<void> {
    if (given) return fail(ErrorCode::usage, std::string(why), option, help);
    return {};
  };
  FORCEGATE_CHECK_OK(
      refuse(!request.faults.empty(), "--fault",
             "the faults are those of the test bench with wheel and ATI; weights have none of them"));
  FORCEGATE_CHECK_OK(refuse(!request.panel.empty(), "--specimen",
                            "the specimens of this plan are the sensors of its pack",
                            "--case pack0-sensor1 takes one of them"));
  FORCEGATE_CHECK_OK(refuse(!request.calibration_file.empty() || request.level, "--cal, --calibration",
                            "the networks are compiled into the image, CAL only names the sensor"));
  FORCEGATE_CHECK_OK(refuse(!request.limits_file.empty(), "--limits",
                            "a gate of conductance and capacitance has no derived limits",
                            "its limits stand in its plan"));
  FORCEGATE_CHECK_OK(refuse(request.rig_options.contains("record"), "--record",
                            "a recording has one channel; this plan needs the codes of both sources"));
  FORCEGATE_CHECK_OK(refuse(request.keep, "--keep", "codes are not kept: the emulated bench gives them again",
                            "forcegate check RUN --replay plays them and compares the digests"));
  return refuse(request.seed && *request.seed != plan.study.seed, "--seed",
                "another seed is another pack, for which the image has no networks");
}

}  // namespace

Result<bool> is_weight_plan(const std::string& plan) {
  FORCEGATE_TRY(const std::filesystem::path path, find_plan(plan));
  const auto kind = plan_kind(path);
  return kind && *kind == kWeightGateKind;
}

Result<RunResult> weight_gate(const GateRequest& request, const GateProgress& progress,
                              const std::atomic<bool>* cancelled) {
  FORCEGATE_TRY(const std::filesystem::path path, find_plan(request.plan));
  FORCEGATE_TRY(WeightGatePlan plan, read_weight_gate_plan(path));
  FORCEGATE_CHECK_OK(refuse_what_means_nothing(request, plan));
  if (!request.goldens.empty())
    plan.goldens = std::filesystem::absolute(request.goldens).lexically_normal().string();
  FORCEGATE_CHECK_OK(image_sha256(request.firmware));
  FORCEGATE_TRY(const std::string lane, choose_lane(request));
  return WeightGateRun(request, std::move(plan), lane, cancelled).run(progress);
}

Result<std::vector<Result<std::string>>> play_weights_again(const WeightMaterial& stored,
                                                            const std::filesystem::path& image, unsigned threads,
                                                            const GateProgress& progress,
                                                            const std::atomic<bool>* cancelled) {
  if (!stored.head.rig.emulated)
    return fail(ErrorCode::usage, "only records of an emulated bench can be played again", image.string(),
                "leave --replay out: what was measured is judged in any case");
  Options options, lane_options;
  for (const auto& [name, value] : stored.head.rig.details) {
    if (name.starts_with(kOption)) options[name.substr(kOption.size())] = value;
    if (name.starts_with(kLaneOption)) lane_options[name.substr(kLaneOption.size())] = value;
  }
  FORCEGATE_TRY(const PackFrames pack, frames_of(stored.plan, stored.head.rig.name, options));
  std::vector<WeightSession> sessions;
  std::vector<Result<std::string>> digests;
  for (std::size_t i = 0; i < stored.records.size(); ++i) {
    const std::size_t s = stored.records[i].sensor;
    if (s >= pack.sensors.size())
      return fail(ErrorCode::parse, "the stored run has a sensor that the bench has not",
                  stored.head.cases[i].id);
    sessions.push_back({stored.head.cases[i].id,
                        stored.head.cases[i].lane,
                        lane_options,
                        session_of(stored.plan, pack.bench, s, image, stored.head.firmware_sha256),
                        &pack.sensors[s],
                        stored.plan.frame_samples()});
  }
  WorkerOptions worker;
  worker.workers = threads;
  worker.cancelled = cancelled;
  double done = 0.0;
  const WorkerEvents events{{}, [&](std::size_t k) {
                              done += 1.0;
                              if (progress)
                                progress(done / static_cast<double>(sessions.size()), sessions[k].id);
                            }};
  auto answers = run_weight_sessions(sessions, worker, events);
  for (auto& answer : answers) {
    if (!answer && answer.error().code == ErrorCode::cancelled) return Unexpected(answer.error());
    digests.push_back(answer ? Result<std::string>(std::move(answer->digest)) : Unexpected(answer.error()));
  }
  return digests;
}

}  // namespace forcegate
