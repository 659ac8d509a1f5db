#include "hil/app/play/weight_session.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "hil/base/digest.h"

namespace forcegate {
namespace {

using nlohmann::json;

constexpr std::size_t kBlock = 800;

// In the child: the whole session of one sensor. Numbers that are none travel as null.
Result<std::string> play(const WeightSession& s) {
  const LaneKind* lane = Registry<LaneKind>::instance().find(s.lane);
  FORCEGATE_TRY(const auto dut, lane->make(s.lane_options));
  auto opened = dut->open(s.session);
  if (!opened) {
    Error e = std::move(opened).error();
    if (e.code == ErrorCode::config) e.code = ErrorCode::firmware;  // the rate is the plan's, and the image must keep it
    return Unexpected(std::move(e));
  }
  const DutInfo info = *opened;
  const std::vector<std::uint16_t>& codes = s.frames->codes;
  std::vector<float> force_N(codes.size());
  std::vector<std::uint8_t> flags(codes.size());
  SampleDigest digest;
  for (std::size_t at = 0; at < codes.size(); at += kBlock) {
    const std::size_t many = std::min(kBlock, codes.size() - at);
    FORCEGATE_CHECK_OK(dut->process(static_cast<std::uint32_t>(at), std::span(codes).subspan(at, many),
                                    std::span(force_N).subspan(at, many),
                                    std::span(flags).subspan(at, many)));
    digest.update(&codes[at], many * sizeof(std::uint16_t));
    digest.update(&force_N[at], many * sizeof(float));
    digest.update(&flags[at], many);
  }
  FORCEGATE_TRY(const DutCounters n, dut->close());
  json out{{"info", {info.board, info.build_id, info.algorithm_id, info.protocol_major, info.protocol_minor}},
           {"link", {n.samples, n.frames_dropped, n.frames_bad, n.indices_lost, n.overruns, n.naks}},
           {"digest", digest.hex()}};
  for (std::size_t i = s.frame_samples - 1; i < codes.size(); i += s.frame_samples) {
    out["force"].push_back(std::isfinite(force_N[i]) ? json(static_cast<double>(force_N[i])) : json(nullptr));
    out["flags"].push_back(flags[i]);
  }
  return out.dump(-1, ' ', false, json::error_handler_t::replace);
}

Result<WeightSessionAnswer> answer_of(const std::string& text, const WeightSession& asked) {
  WeightSessionAnswer out;
  try {  // ends here: the image wrote into what the worker was to say
    const auto in = json::parse(text);
    const auto &info = in.at("info"), &link = in.at("link");
    out.firmware = {info.at(3),
                    info.at(4),
                    info.at(0),
                    info.at(1),
                    info.at(2),
                    asked.session.nonce,
                    asked.session.calibration.adc_bits,
                    asked.session.rate_Hz};
    out.link = {link.at(0), link.at(1), link.at(2), link.at(3), link.at(4), link.at(5)};
    out.digest = in.at("digest");
    for (const auto& v : in.at("force"))
      out.answers.force_N.push_back(v.is_null() ? std::nan("") : v.get<double>());
    for (const auto& v : in.at("flags")) out.answers.flags.push_back(v.get<std::uint8_t>());
  } catch (const json::exception&) {
    return fail(ErrorCode::internal, "a worker's answer cannot be read", asked.id);
  }
  if (out.answers.force_N.size() != asked.frames->codes.size() / asked.frame_samples ||
      out.answers.flags.size() != out.answers.force_N.size())
    return fail(ErrorCode::internal, "a worker's answer is not of the length of its frames", asked.id);
  return out;
}

}  // namespace

std::vector<Result<WeightSessionAnswer>> run_weight_sessions(const std::vector<WeightSession>& sessions,
                                                             const WorkerOptions& options,
                                                             const WorkerEvents& events) {
  std::vector<WatchedTask> tasks;
  for (const WeightSession& s : sessions) tasks.push_back({s.id, [&s](const auto&) { return play(s); }});
  const auto texts = run_watched(tasks, options, events);
  std::vector<Result<WeightSessionAnswer>> out;
  for (std::size_t i = 0; i < sessions.size(); ++i) {
    if (texts[i])
      out.emplace_back(answer_of(*texts[i], sessions[i]));
    else
      out.emplace_back(Unexpected(texts[i].error()));
  }
  return out;
}

}  // namespace forcegate
