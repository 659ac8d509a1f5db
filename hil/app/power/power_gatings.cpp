#include "hil/app/power/power_gatings.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "hil/base/digest.h"
#include "hil/base/text.h"
#include "hil/gate/decision.h"

namespace forcegate {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kHang_cpu_s = 2.0;  // a mutant that hangs does so for good

std::string without_case(const std::string& id) { return id.substr(0, id.find('/')); }

Result<DecisionKind> kind_of(const std::string& word) {
  for (const DecisionKind kind : {DecisionKind::accept, DecisionKind::reject, DecisionKind::no_decision})
    if (word == to_string(kind)) return kind;
  return fail(ErrorCode::parse, "no decision: '" + printable_utf8(word) + "'");
}

Gated summary_of(const RunResult& r, const DecisionRule& rule) {
  Gated out;
  out.kind = r.decision.kind;
  out.reason = r.decision.reason;
  std::vector<const Check*> blind;
  const auto look = [&](const Check& c) {
    if (c.required && c.verdict == Verdict::fail) out.failed.insert(without_case(c.id));
    if (c.id.ends_with("conformance"))  // that of the prelude too
      out.conformance_known = true;
    else
      blind.push_back(&c);
  };
  for (const Check& c : r.checks) look(c);
  for (const CaseResult& one : r.cases)
    for (const Check& c : one.checks) look(c);
  RunEvents events;
  events.safety_stop = r.decision.safety_stop;
  out.blind = decide(blind, rule, events).kind;
  return out;
}

}  // namespace

std::string to_json_line(const std::string& id, const Gated& g) {
  return Json{{"id", id},
              {"kind", to_string(g.kind)},
              {"failed", g.failed},
              {"conformance_known", g.conformance_known},
              {"blind", to_string(g.blind)},
              {"reason", g.reason}}
      .dump(-1, ' ', false, Json::error_handler_t::replace);
}

Result<Gated> gated_from_json(const std::string& line) {
  const Json j = Json::parse(line, nullptr, false);
  const bool whole = j.is_object() && j.contains("kind") && j["kind"].is_string() && j.contains("failed") &&
                     j["failed"].is_array() && j.contains("conformance_known") &&
                     j["conformance_known"].is_boolean() && j.contains("blind") && j["blind"].is_string() &&
                     j.contains("reason") && j["reason"].is_string();
  if (!whole)
    return fail(ErrorCode::parse,
                "a line of the journal is no gating: " + printable_utf8(line.substr(0, 80)));
  Gated g;
  FORCEGATE_TRY(g.kind, kind_of(j["kind"]));
  FORCEGATE_TRY(g.blind, kind_of(j["blind"]));
  for (const Json& id : j["failed"])
    if (id.is_string()) g.failed.insert(id.get<std::string>());
  g.conformance_known = j["conformance_known"];
  g.reason = j["reason"];
  return g;
}

Result<PowerGatings> PowerGatings::open(const std::vector<const Plan*>& plans,
                                        const std::filesystem::path& journal, unsigned threads,
                                        const std::atomic<bool>* cancelled) {
  PowerGatings gatings;
  gatings.threads_ = threads;
  gatings.cancelled_ = cancelled;
  if (journal.empty()) return gatings;
  FORCEGATE_TRY(const std::string program, sha256_file("/proc/self/exe"));
  // Plans and limits are in each gating's id, so that one journal serves runs under one plan and under two.
  for (const Plan* plan : plans) {
    std::string& digest = gatings.plans_[plan->name];
    digest = plan->sha256.substr(0, 12);
    if (plan->limits.derived.empty()) continue;
    FORCEGATE_TRY(const std::string limits, sha256_file(plan->path.parent_path() / plan->limits.derived));
    digest += "-" + limits.substr(0, 12);
  }
  FORCEGATE_TRY(gatings.journal_,
                ResumeJournal::open(journal, Json{{"job", "power"}, {"program", program}}.dump()));
  return gatings;
}

Result<std::string> PowerGatings::sha256(const std::filesystem::path& image) {
  std::string& known = sha256_[image];
  if (known.empty()) {
    FORCEGATE_TRY(known, sha256_file(image));
  }
  return known;
}

Result<Gated> PowerGatings::gate(const Plan& plan, const std::filesystem::path& image, std::uint64_t seed,
                                 const std::vector<std::string>& cases) {
  std::string id;
  if (journal_.keeps()) {
    FORCEGATE_TRY(const std::string digest, sha256(image));
    id = fmt::format("{}@{}/{}/{}@{}/{}", plan.name, plans_[plan.name], seed, image.filename().string(),
                     digest.substr(0, 12), join(cases, "+"));
    if (const std::string* line = journal_.find(id)) return gated_from_json(*line);
  }
  GateRequest request;
  request.firmware = image;
  request.plan = plan.path.string();
  request.seed = seed;
  request.only_cases = cases;
  request.threads = threads_;
  request.hang_cpu_s = kHang_cpu_s;
  request.calibrations = &calibrations_[fmt::format("{}/{}", plan.name, seed)];
  FORCEGATE_TRY(const RunResult r, forcegate::gate(request, {}, cancelled_));
  if (r.decision.exit_code == 130) return fail(ErrorCode::cancelled, "interrupted");
  if (r.decision.exit_code == 6) return fail(ErrorCode::internal, r.decision.reason, image.string());
  Gated out = summary_of(r, plan.rule);
  journal_.keep(to_json_line(id, out));
  FORCEGATE_CHECK_OK(journal_.status());
  return out;
}

}  // namespace forcegate
