#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hil/app/files/beside_program.h"
#include "hil/app/power/power.h"
#include "hil/base/plain_number.h"
#include "hil/base/text.h"
#include "hil/gate/statistics.h"

namespace forcegate {
namespace {

std::string share(std::size_t k, std::size_t n) {
  if (n == 0) return "-";
  const Interval95 i = clopper_pearson_95(k, n);
  return fmt::format("{}/{} [{:.1f}, {:.1f}] %", k, n, 100.0 * i.low, 100.0 * i.high);
}

std::string verdict(const MutantOutcome& o) {
  if (o.runs == 0) return "not played";
  const std::size_t undecided = o.runs - o.rejected - o.accepted;
  for (const auto& [n, word] :
       {std::pair(o.accepted, "accepted"), {o.rejected, "REJECTED"}, {undecided, "undecided"}})
    if (n == o.runs) return o.runs == 1 ? word : fmt::format("{} {}x", word, n);
  return fmt::format("{} accepted, {} rejected, {} undecided", o.accepted, o.rejected, undecided);
}

std::string seen(const MutantOutcome& o) {
  std::vector<std::string> names;
  for (const auto& [id, n] : o.checks) names.push_back(n == o.runs ? id : fmt::format("{} ({}x)", id, n));
  return names.empty() ? "-" : join(names, ", ");
}

std::string blind(const MutantOutcome& o) {
  if (o.blind_runs == 0) return "-";
  return o.blind_runs == 1 ? (o.blind_rejected == 1 ? "yes" : "no")
                           : fmt::format("{}/{}", o.blind_rejected, o.blind_runs);
}

std::string level(double value, const std::string& unit) {
  return std::isnan(value) ? "none" : shortest(value) + " " + unit;
}

std::string claims(const ReferenceRuns& r) {
  const Interval95 refused = clopper_pearson_95(r.rejected, r.n);
  return fmt::format(
      "{} of {} runs of the reference rejected under plan {}, seeds from {} (probability [{:.1f}, {:.1f}] %); {} accepted, "
      "{} left undecided",
      r.rejected, r.n, r.plan_name, r.first_seed, 100.0 * refused.low, 100.0 * refused.high, r.accepted,
      r.n - r.rejected - r.accepted);
}

// Probability that the smallest level found slips through all the same.
std::string slip_at_smallest(const FamilyOutcome& f) {
  for (const MutantOutcome* o : f.levels)
    if (*o->mutant.level == f.smallest) return share(o->accepted, o->runs);
  return "-";
}

std::string without_conformance(const FamilyOutcome& f) {
  if (f.blind_runs == 0) return "-";
  return fmt::format("{} ({})", level(f.smallest_blind, f.unit), counted(f.blind_runs, "run"));
}

// "0.001: 0, 0.01: 20, 0.1: 20", of as many runs each
std::string by_level(const FamilyOutcome& f) {
  std::vector<std::string> parts;
  for (const MutantOutcome* o : f.levels)
    parts.push_back(fmt::format("{}: {}", shortest(*o->mutant.level), o->rejected));
  return join(parts, ", ");
}

std::string command(const PowerRequest& r) {
  std::string line = fmt::format("forcegate power --plan {} --seeds {} --mutant-seeds {} --family-seeds {}",
                                 r.plan, r.seeds, r.mutant_seeds, r.family_seeds);
  if (r.panel_seeds > 0)
    line += fmt::format(" --panel-plan {} --panel-seeds {}", r.panel_plan, r.panel_seeds);
  for (const std::string& only : r.only) line += " --mutant " + shell_quoted(only);
  if (r.quick) line += " --quick";
  if (!r.firmware.empty() && r.firmware != "build/firmware" && r.firmware != program_folder() / "firmware") line += " --firmware " + file_quoted(r.firmware.string());
  return line + " --markdown " + file_quoted(r.markdown.string());
}

std::string slip(const PowerResult& r) {
  const PowerCount s = r.slipped();
  const Interval95 i = clopper_pearson_95(s.k, s.n);
  return fmt::format(
      "{} of {} runs of bad builds accepted: probability of slipping through [{:.1f}, {:.1f}] %", s.k, s.n,
      100.0 * i.low, 100.0 * i.high);
}

template <class Row>
void survivors(const PowerResult& r, Row row) {
  for (const MutantOutcome* o : r.survivors())
    row(*o, o->mutant.note.empty() ? "not foreseen: " + o->reason : o->mutant.note);
}

}  // namespace

std::string power_text(const PowerResult& r) {
  std::string out =
      fmt::format("power of the gate: plan {}, {} mutants and equivalent builds, seeds from {}\n\n",
                  r.plan_name, r.outcomes.size(), r.first_seed);
  out += fmt::format("{:<32} {:<14} {:<34} {:<8} {}\n", "mutant", "decision", "seen by", "blind*", "breaks");
  for (const MutantOutcome& o : r.outcomes)
    out += fmt::format("{:<32} {:<14} {:<34} {:<8} {}{}\n", o.mutant.name, verdict(o), seen(o), blind(o),
                       o.as_expected || o.mutant.seen_by.front() == "nothing" ? "" : "(not as expected) ",
                       o.mutant.breaks);
  out += "* rejected even if no independent implementation of its algorithm were known\n\n";
  out += "smallest defect found in at least 95 % of the runs\n";
  for (const FamilyOutcome& f : r.families())
    out += fmt::format("  {:<28} {:<18} without conformance: {:<16} slips: {:<24} {}\n", f.family,
                       level(f.smallest, f.unit), without_conformance(f), slip_at_smallest(f), f.breaks);
  out += "\nsurvivors\n";
  survivors(r, [&](const MutantOutcome& o, const std::string& why) {
    out += fmt::format("  {:<28} {} ({})\n", o.mutant.name, why, verdict(o));
  });
  if (r.survivors().empty()) out += "  none\n";
  out += "\ngood builds that were not accepted\n";
  for (const MutantOutcome* o : r.refused())
    out += fmt::format("  {:<28} {}: {}\n", o->mutant.name, verdict(*o), o->reason);
  for (const ReferenceRuns* runs : {&r.reference, &r.panel})
    for (const std::string& why : runs->reasons)
      out += "  reference, plan " + runs->plan_name + ", " + why + "\n";
  if (r.refused().empty() && r.reference.reasons.empty() && r.panel.reasons.empty()) out += "  none\n";
  if (!r.not_built.empty()) out += "\nnot built: " + join(r.not_built, ", ") + "\n";
  out += "\n" + slip(r) + "\n";
  for (const ReferenceRuns* runs : {&r.reference, &r.panel})
    if (runs->n > 0) out += claims(*runs) + "\n";
  return out;
}

std::string power_markdown(const PowerResult& r) {
  std::string out =
      "# Power of the gate\n\nMade by `" + command(r.request) +
      "`; do not edit by hand.\n\nA gate that never rejects anything is green every day. So deliberately bad firmwares "
      "(`rigs/firmware/mutants/`) are gated like any build, and good ones built differently must be accepted. Intervals are "
      "those of Clopper and Pearson at 95 %.\n\n";
  std::size_t bad = 0, good = 0;
  for (const MutantOutcome& o : r.outcomes) ++(o.mutant.good() ? good : bad);
  out += fmt::format(
      "| what | figure |\n|---|---|\n| bad builds | {} |\n| good builds made differently | {} |\n", bad,
      good);
  out += "| slipping through | " + slip(r) + " |\n";
  for (const ReferenceRuns* runs : {&r.reference, &r.panel})
    if (runs->n > 0) out += "| good build refused | " + claims(*runs) + " |\n";
  out +=
      "\n## Smallest defect found\n\nSmallest level from which on at least 95 % of the runs are rejected, and the share of "
      "runs in which that level is accepted all the same. \"Without conformance\": had no independent implementation of the "
      "algorithm been known, as for an image with an algorithm of its own.\n\n| family | what | smallest | slips through | "
      "without conformance | runs a level | rejected of them, level by level |\n|---|---|---|---|---|---|---|\n";
  for (const FamilyOutcome& f : r.families())
    out +=
        fmt::format("| `{}` | {} | {} | {} | {} | {} | {} |\n", f.family, f.breaks, level(f.smallest, f.unit),
                    slip_at_smallest(f), without_conformance(f), f.runs, by_level(f));
  out += "\n## Survivors\n\n";
  survivors(r, [&](const MutantOutcome& o, const std::string& why) {
    out += fmt::format("- `{}` ({}): {}\n", o.mutant.name, o.mutant.breaks, why);
  });
  if (r.survivors().empty()) out += "None.\n";
  out +=
      "\n## Every mutant\n\n| mutant | breaks | promise | decision | rejected by | without conformance |\n"
      "|---|---|---|---|---|---|\n";
  for (const MutantOutcome& o : r.outcomes)
    out += fmt::format("| `{}` | {} | {} | {} | {} | {} |\n", o.mutant.name, o.mutant.breaks,
                       o.mutant.promise.empty() ? "-" : o.mutant.promise,
                       o.runs > 1 && !o.mutant.good() ? share(o.rejected, o.runs) + " rejected" : verdict(o),
                       seen(o), blind(o));
  if (r.reference.reasons.empty() && r.panel.reasons.empty()) return out;
  out += "\n## Runs of the reference that were not accepted\n\n";
  for (const ReferenceRuns* runs : {&r.reference, &r.panel})
    for (const std::string& why : runs->reasons) out += "- plan " + runs->plan_name + ", " + why + "\n";
  return out;
}

}  // namespace forcegate
