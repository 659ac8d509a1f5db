#include "hil/app/gate/sensor_records.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "hil/base/text.h"

namespace forcegate {
namespace {

using characterize::SensorRecord;
using Json = nlohmann::ordered_json;

Json numbers(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double v : values)
    out.push_back(std::isfinite(v) ? Json(v) : std::isnan(v) ? Json(nullptr) : Json(v > 0 ? "inf" : "-inf"));
  return out;
}

std::vector<double> numbers(const Json& list) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<double> out;
  for (const Json& v : list)
    out.push_back(v.is_number() ? v.get<double>()
                  : v == "inf"  ? kInfinity
                  : v == "-inf" ? -kInfinity
                                : std::nan(""));
  return out;
}

SensorRecord record_of(const Json& j) {
  SensorRecord r;
  r.sensor = j.at("sensor").get<std::size_t>();
  r.frames.force_N = numbers(j.at("weights_N"));
  r.frames.oracle_N = numbers(j.at("network_N"));
  r.frames.conductance_N = numbers(j.at("conductance_N"));
  r.frames.loading = j.at("loading").get<std::vector<std::size_t>>();
  if (j.contains("accepted_N")) r.accepted_N = numbers(j["accepted_N"]);
  if (j.contains("failure")) {
    const Json& e = j["failure"];
    r.failure = Error{static_cast<ErrorCode>(e.at(0).get<int>()), e.at(1), e.at(2), e.at(3)};
  } else {
    r.answers.force_N = numbers(j.at("firmware_N"));
    r.answers.flags = j.at("flags").get<std::vector<std::uint8_t>>();
  }
  return r;
}

// nullptr: nothing.
const char* what_is_wrong(const SensorRecord& r, const characterize::WeightGatePlan& plan) {
  const std::size_t n = r.frames.force_N.size();
  const bool answered = r.failure || (r.answers.force_N.size() == n && r.answers.flags.size() == n);
  if (n == 0) return "a record has no frame";
  if (r.frames.oracle_N.size() != n || r.frames.conductance_N.size() != n || r.frames.loading.size() != n || !answered) return "the lists of a record are not of one length";
  if (std::ranges::any_of(r.frames.loading, [&](std::size_t l) { return l > plan.loadings; })) return "a record has more loadings than its plan";
  return nullptr;
}

}  // namespace

std::string to_text(const std::vector<SensorRecord>& records) {
  std::string out;
  for (const SensorRecord& r : records) {
    Json j{{"sensor", r.sensor},
           {"weights_N", numbers(r.frames.force_N)},
           {"network_N", numbers(r.frames.oracle_N)},
           {"conductance_N", numbers(r.frames.conductance_N)},
           {"loading", r.frames.loading}};
    if (r.failure)
      j["failure"] = {static_cast<int>(r.failure->code), r.failure->text, r.failure->where, r.failure->hint};
    else
      j["firmware_N"] = numbers(r.answers.force_N), j["flags"] = r.answers.flags;
    if (!r.accepted_N.empty()) j["accepted_N"] = numbers(r.accepted_N);
    out += j.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  }
  return out;
}

Result<std::vector<SensorRecord>> sensor_records_from(std::string_view text,
                                                      const characterize::WeightGatePlan& plan,
                                                      const std::string& name) {
  std::vector<SensorRecord> out;
  for (const std::string& line : split(text, '\n')) {
    if (line.empty()) continue;
    try {  // ends here: a missing key or a value of another kind
      out.push_back(record_of(Json::parse(line)));
    } catch (const Json::exception&) {
      return fail(ErrorCode::parse, "a line is no record of a sensor", name);
    }
    if (const char* wrong = what_is_wrong(out.back(), plan)) return fail(ErrorCode::parse, wrong, name);
  }
  return out;
}

}  // namespace forcegate
