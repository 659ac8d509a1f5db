#include "hil/app/bench/fault_matrix.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "hil/base/text.h"

namespace forcegate {
namespace {

std::string blame_names(const std::vector<Blame>& blames) {
  std::vector<std::string> names;
  for (const Blame b : blames) names.emplace_back(to_string(b));
  return join(names, " or ");
}

std::string judge_row(const FaultRow& row) {
  const FaultScenario& s = row.scenario;
  std::vector<std::string> wrong;
  const auto blamed = [&](const Decision& d) {
    return std::find(s.culprits.begin(), s.culprits.end(), d.blame) != s.culprits.end();
  };
  if (row.good.kind == DecisionKind::reject) wrong.emplace_back("the fault rejects a good build");
  if (row.good.kind == DecisionKind::accept && s.clear) wrong.emplace_back("the fault goes unseen");
  if (row.good.kind == DecisionKind::no_decision && !blamed(row.good))
    wrong.push_back(fmt::format("{} is blamed, not {}", to_string(row.good.blame), blame_names(s.culprits)));
  if (row.with_bad && row.bad.kind == DecisionKind::accept) wrong.emplace_back("a bad build is accepted");
  if (row.with_bad && row.bad.kind == DecisionKind::no_decision && s.clear && !blamed(row.bad))
    wrong.push_back(fmt::format("with the bad build {} is blamed, not {}", to_string(row.bad.blame),
                                blame_names(s.culprits)));
  return join(wrong, "; ");
}

std::string words(const Decision& d) {
  if (d.kind == DecisionKind::no_decision) return fmt::format("NO-DECISION ({})", to_string(d.blame));
  return std::string(to_string(d.kind));
}

nlohmann::ordered_json to_json(const Decision& d) {
  return {{"kind", to_string(d.kind)},
          {"blame", to_string(d.blame)},
          {"exit_code", d.exit_code},
          {"reason", d.reason},
          {"safety_stop", d.safety_stop}};
}

}  // namespace

std::size_t FaultMatrix::wrong() const {
  const auto is_wrong = [](const auto& row) { return !row.wrong.empty(); };
  return static_cast<std::size_t>(std::count_if(rows.begin(), rows.end(), is_wrong) +
                                  std::count_if(runaway.begin(), runaway.end(), is_wrong));
}

Result<FaultMatrix> fault_matrix(const FaultMatrixRequest& request, const GateProgress& progress,
                                 const std::atomic<bool>* cancelled) {
  std::vector<FaultScenario> wanted;
  std::vector<std::string> names;
  for (const FaultScenario& s : fault_scenarios()) {
    names.push_back(s.name);
    if (request.only.empty() ||
        std::find(request.only.begin(), request.only.end(), s.name) != request.only.end())
      wanted.push_back(s);
  }
  for (const std::string& name : request.only)
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      const std::string near = nearest_name(name, names);
      return fail(ErrorCode::usage, "there is no fault '" + printable_utf8(name) + "' in the matrix", {},
                  near.empty() ? "forcegate bench faults --help lists them" : "did you mean '" + near + "'?");
    }
  const double runs =
      static_cast<double>(wanted.size() * (request.bad.empty() ? 1 : 2) + request.runaway.size() + 1);
  double done = 0.0;
  const auto play = [&](const std::filesystem::path& image, const std::map<std::string, double>& faults,
                        const std::string& now) -> Result<Decision> {
    GateRequest gated;
    gated.firmware = image;
    gated.plan = request.plan;
    gated.threads = request.threads;
    gated.faults = faults;
    if (progress) progress(done / std::max(1.0, runs), now);
    FORCEGATE_TRY(const RunResult result, gate(gated, {}, cancelled));
    if (result.decision.exit_code == 130) return fail(ErrorCode::cancelled, "interrupted");
    done += 1.0;
    return result.decision;
  };
  // What a fault does to a build is told by a build that the sound rig accepts.
  FORCEGATE_TRY(const Decision sound, play(request.good, {}, "no fault"));
  if (sound.kind != DecisionKind::accept)
    return fail(ErrorCode::usage, fmt::format("without any fault the build is no known-good one: {}, {}", to_string(sound.kind), sound.reason), request.good.string(),
                "give an image that forcegate gate accepts under the plan " + request.plan + "; --bad takes one that it rejects");
  FaultMatrix matrix;
  for (const FaultScenario& s : wanted) {
    FaultRow row;
    row.scenario = s;
    FORCEGATE_TRY(row.good, play(request.good, {{s.name, s.magnitude}}, s.in_words));
    if (!request.bad.empty()) {
      row.with_bad = true;
      FORCEGATE_TRY(row.bad, play(request.bad, {{s.name, s.magnitude}}, s.in_words));
    }
    row.wrong = judge_row(row);
    matrix.rows.push_back(std::move(row));
  }
  for (const std::filesystem::path& image : request.runaway) {
    FaultMatrix::Runaway row;
    row.build = image.filename().string();
    FORCEGATE_TRY(row.decision, play(image, {}, row.build));
    if (row.decision.kind != DecisionKind::reject)
      row.wrong = "a build that drives the rig to its limits is not rejected";
    matrix.runaway.push_back(std::move(row));
  }
  return matrix;
}

std::string fault_matrix_text(const FaultMatrix& m) {
  std::string out = fmt::format("{:<22}{:>8}  {:<26}{:<26}what is wrong with it, or what the harness saw\n",
                                "fault", "size", "good build", "bad build");
  for (const FaultRow& row : m.rows)
    out += fmt::format("{:<22}{:>8}  {:<26}{:<26}{}\n", row.scenario.name, shortest(row.scenario.magnitude),
                       words(row.good), row.with_bad ? words(row.bad) : "-",
                       !row.wrong.empty()                      ? "WRONG: " + row.wrong
                       : row.good.kind == DecisionKind::accept ? "too small to be seen or to tip a verdict"
                                                               : row.good.reason);
  for (const FaultMatrix::Runaway& row : m.runaway)
    out += fmt::format("{:<32}  {:<26}{:<26}{}\n", "no fault, runaway build", "-", words(row.decision),
                       row.wrong.empty() ? row.build + ": " + row.decision.reason : "WRONG: " + row.wrong);
  out += fmt::format("\n{} faults, {} builds that run away: {} wrong\n", m.rows.size(), m.runaway.size(),
                     m.wrong());
  return out;
}

std::string fault_matrix_json(const FaultMatrix& m) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array(), runaway = nlohmann::ordered_json::array();
  for (const FaultRow& row : m.rows) {
    nlohmann::ordered_json one = {{"fault", row.scenario.name},
                                  {"magnitude", row.scenario.magnitude},
                                  {"in_words", row.scenario.in_words},
                                  {"clear", row.scenario.clear},
                                  {"culprit", blame_names(row.scenario.culprits)},
                                  {"good", to_json(row.good)}};
    if (row.with_bad) one["bad"] = to_json(row.bad);
    one["wrong"] = row.wrong;
    rows.push_back(std::move(one));
  }
  for (const FaultMatrix::Runaway& row : m.runaway)
    runaway.push_back({{"build", row.build}, {"decision", to_json(row.decision)}, {"wrong", row.wrong}});
  return nlohmann::ordered_json{{"format", 1}, {"wrong", m.wrong()}, {"faults", rows}, {"runaway", runaway}}
      .dump(2, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace forcegate
