#include "hil/gate/judge_target.h"

#include <fmt/format.h>

#include <cmath>

namespace forcegate {
namespace {

class TargetJudge {
 public:
  explicit TargetJudge(const CaseRecord& record) : record_(record) {}

  // limit < 0: reported, not judged. A value that the lane cannot tell is no check at all.
  void add(const char* id, const char* title, double value, const char* unit, double limit,
           const char* source, std::string evidence) {
    if (std::isnan(value)) return;
    JudgedCheck j;
    Check& c = j.check;
    c.id = id;
    c.case_id = record_.id;
    c.title = title;
    c.value = value;
    c.unit = unit;
    c.n = record_.samples;
    c.evidence = std::move(evidence);
    if (limit >= 0.0)
      c.limit = {Limit::Kind::upper, limit, source};
    else
      c.required = false;
    out_.push_back(std::move(j));
  }

  std::vector<JudgedCheck> take() { return std::move(out_); }

 private:
  const CaseRecord& record_;
  std::vector<JudgedCheck> out_;
};

double or_none(double limit) { return limit > 0.0 ? limit : -1.0; }

}  // namespace

std::vector<JudgedCheck> judge_target(const Plan& plan, const CaseRecord& record, Blame spoiled) {
  TargetJudge judge(record);
  const DutResources& r = record.resources;
  const PlanLimits& l = plan.limits;
  judge.add(
      "instructions_worst", "Instructions of the slowest sample", r.instructions_worst, "1",
      or_none(l.instructions), "ours: plan",
      fmt::format("at {:.3f} s; mean {:.0f}; the same on every run", r.worst_at_s, r.instructions_mean));
  judge.add("samples_late", "Samples not done within their period", r.late, "1", 0.0,
            "ours: the board keeps up", fmt::format("{:.0f} of {} samples", r.late, record.samples));
  judge.add("stack_bytes", "Stack used at most", r.stack_bytes, "B", or_none(l.stack_bytes), "ours: plan",
            "high-water mark of the painted stack");
  const double stack = std::isnan(r.stack_bytes) ? 0.0 : r.stack_bytes;
  judge.add("ram_bytes", "RAM", r.ram_bytes + stack, "B", or_none(l.ram_bytes), "ours: plan",
            fmt::format("static data {:.0f} B, ", r.ram_bytes) +
                (std::isnan(r.stack_bytes) ? std::string("stack not measured on this lane")
                                           : fmt::format("stack {:.0f} B", stack)));
  judge.add("flash_bytes", "Flash", r.flash_bytes, "B", or_none(l.flash_bytes), "ours: plan",
            "sections that are loaded");
  judge.add("heap_growth", "Memory taken and not given back", r.heap_growth_bytes, "B", 0.0,
            "ours: a sensor runs for years", fmt::format("over {} samples", record.samples));

  const PreludeFacts& p = record.prelude;
  if (p.samples == 0) return judge.take();
  const bool beyond = !(p.largest_N <= l.output_max_N);
  judge.add(
      "prelude_output", "Output under hostile codes, finite and bounded",
      static_cast<double>(p.not_finite) + (beyond ? 1.0 : 0.0), "1", 0.0, "ours: plan",
      fmt::format("{} of {} samples not finite, largest {:.3f} N", p.not_finite, p.samples, p.largest_N));
  if (p.conformance_known) {
    judge.add("prelude_conformance", "Conformance under hostile codes",
              std::isnan(p.conformance) ? INFINITY : p.conformance, p.conformance_unit.c_str(),
              p.conformance_limit, p.conformance_source.c_str(), p.conformance_evidence);
  }
  std::vector<JudgedCheck> checks = judge.take();
  if (spoiled != Blame::none)
    for (JudgedCheck& j : checks)
      if (j.check.id.starts_with("prelude_")) {
        j.judgeable = false;
        j.check.verdict = Verdict::rig_error;
        j.check.blame = spoiled;
      }
  return checks;
}

}  // namespace forcegate
