#include "hil/app/power/power.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "hil/app/files/find_plan.h"
#include "hil/app/power/power_gatings.h"
#include "hil/base/text.h"
#include "hil/interface/dut.h"

namespace forcegate {
namespace {

constexpr const char* kReference = "reference.native.so";

class PowerRun {
 public:
  PowerRun(const PowerRequest& request, const Plan& plan, const Plan* panel, PowerGatings gatings,
           const GateProgress& progress)
      : request_(request), plan_(plan), panel_(panel), gatings_(std::move(gatings)), progress_(progress) {}

  Result<PowerResult> run() {
    result_.request = request_;
    result_.plan_name = plan_.name;
    result_.plan_sha256 = plan_.sha256;
    result_.first_seed = plan_.seed;
    result_.reference.plan_name = plan_.name;
    result_.reference.first_seed = plan_.seed;
    FORCEGATE_TRY(std::vector<Mutant> mutants, read_mutants(request_.firmware / "mutants"));
    if (!request_.only.empty()) {
      FORCEGATE_CHECK_OK(know_all(mutants));
      std::erase_if(mutants, [&](const Mutant& m) {
        return std::find(request_.only.begin(), request_.only.end(), m.name) == request_.only.end() &&
               std::find(request_.only.begin(), request_.only.end(), m.family) == request_.only.end();
      });
    }
    for (Mutant& m : mutants) {
      result_.outcomes.emplace_back();
      result_.outcomes.back().mutant = std::move(m);
    }
    std::size_t turns = request_.seeds;
    total_ = static_cast<double>(request_.seeds + (panel_ != nullptr ? request_.panel_seeds : 0));
    for (const MutantOutcome& outcome : result_.outcomes) {
      turns = std::max(turns, request_.runs_of(outcome.mutant));
      total_ += static_cast<double>(request_.runs_of(outcome.mutant));
    }
    // Seed by seed, so that a seed's calibrations are measured once.
    for (std::size_t i = 0; i < turns; ++i) {
      gatings_.forget_calibrations();
      if (i < request_.seeds) FORCEGATE_CHECK_OK(run_reference(plan_, plan_.seed + i, result_.reference));
      for (MutantOutcome& outcome : result_.outcomes)
        if (i < request_.runs_of(outcome.mutant))
          FORCEGATE_CHECK_OK(
              run_mutant(outcome, plan_.seed + i, request_.quick || i >= request_.mutant_seeds));
    }
    if (panel_ != nullptr) {
      result_.panel.plan_name = panel_->name;
      result_.panel.first_seed = panel_->seed;
      for (std::size_t i = 0; i < request_.panel_seeds; ++i) {
        gatings_.forget_calibrations();
        FORCEGATE_CHECK_OK(run_reference(*panel_, panel_->seed + i, result_.panel));
      }
    }
    for (const MutantOutcome& outcome : result_.outcomes)
      if (outcome.mutant.images.empty()) result_.not_built.push_back(outcome.mutant.name);
    std::erase_if(result_.outcomes, [](const MutantOutcome& o) { return o.mutant.images.empty(); });
    return std::move(result_);
  }

 private:
  Result<void> know_all(const std::vector<Mutant>& mutants) const {
    std::vector<std::string> names;
    for (const Mutant& m : mutants) {
      names.push_back(m.name);
      names.push_back(m.family);
    }
    for (const std::string& wanted : request_.only)
      if (std::find(names.begin(), names.end(), wanted) == names.end()) {
        const std::string near = nearest_name(wanted, names);
        return fail(ErrorCode::usage, "there is no mutant '" + printable_utf8(wanted) + "'",
                    (request_.firmware / "mutants").string(),
                    near.empty() ? "ls rigs/firmware/mutants lists them" : "did you mean '" + near + "'?");
      }
    return {};
  }

  // Cases of the plan that an image is played on. What runs natively is judged natively; a cross-compiled
  // image is there for the cases of its own lane, or, when nothing native exists of a good build, for the
  // common ones.
  static std::vector<std::string> cases_for(const Plan& plan, const std::filesystem::path& image,
                                            bool common) {
    std::vector<std::string> names;
    for (const PlanCase& c : plan.cases) {
      const LaneKind* lane = c.lane.empty() ? nullptr : Registry<LaneKind>::instance().find(c.lane);
      const bool own = lane != nullptr && lane->accepts(image);
      if (common || image.extension() == ".so" ? c.lane.empty() : own) names.push_back(c.name);
    }
    return names;
  }

  static bool expected(const Mutant& m, const std::set<std::string>& failed) {
    return std::any_of(m.seen_by.begin(), m.seen_by.end(),
                       [&](const std::string& id) { return failed.count(id) > 0; });
  }

  Result<Gated> gate_image(const Plan& plan, const Mutant* mutant, const std::filesystem::path& image,
                           std::uint64_t seed, bool quick) {
    const bool cross_only = mutant != nullptr && mutant->images.front().extension() != ".so";
    const bool common = cross_only && mutant->good() && image.string().find(".uart.") == std::string::npos;
    const std::vector<std::string> cases = cases_for(plan, image, common);
    if (cases.empty())
      return fail(ErrorCode::config, "no case of the plan can be played on this image", image.string(),
                  "add one with lane = \"tick\" or \"uart\"");
    if (mutant == nullptr || mutant->good() || !quick) return gatings_.gate(plan, image, seed, cases);
    // Quick: case by case until one rejects for the reason expected; a rejection anywhere is one.
    Gated whole;
    for (const std::string& one : cases) {
      FORCEGATE_TRY(Gated part, gatings_.gate(plan, image, seed, {one}));
      if (part.kind == DecisionKind::reject && expected(*mutant, part.failed)) return part;
      part.failed.insert(whole.failed.begin(), whole.failed.end());
      const bool worse = part.kind == DecisionKind::reject || whole.kind == DecisionKind::accept;
      if (!whole.reason.empty() && !worse) {
        part.kind = whole.kind;
        part.reason = whole.reason;
      }
      whole = std::move(part);
    }
    return whole;
  }

  Result<void> run_reference(const Plan& plan, std::uint64_t seed, ReferenceRuns& runs) {
    step(fmt::format("reference, plan {}, seed {}", plan.name, seed));
    bool played = false, accepted = true, rejected = false;
    for (const char* name : {kReference, "reference-m4f.block.elf", "reference.uart.elf"}) {
      const std::filesystem::path image = request_.firmware / name;
      std::error_code ignored;
      if (!std::filesystem::is_regular_file(image, ignored)) continue;
      // The emulated targets run the same code on the same codes: once is enough for what does not depend on
      // a seed.
      if (image.extension() != ".so" && (seed != plan.seed || cases_for(plan, image, false).empty()))
        continue;
      FORCEGATE_TRY(const Gated g, gate_image(plan, nullptr, image, seed, false));
      played = true;
      accepted = accepted && g.kind == DecisionKind::accept;
      rejected = rejected || g.kind == DecisionKind::reject;
      if (g.kind != DecisionKind::accept)
        runs.reasons.push_back(fmt::format("seed {}: {}: {}", seed, to_string(g.kind), g.reason));
    }
    if (!played) return {};
    ++runs.n;
    runs.accepted += accepted ? 1 : 0;
    runs.rejected += rejected ? 1 : 0;
    return {};
  }

  Result<void> run_mutant(MutantOutcome& outcome, std::uint64_t seed, bool quick) {
    const Mutant& m = outcome.mutant;
    step(fmt::format("{}, seed {}", m.name, seed));
    if (m.images.empty()) return {};
    bool played = false, accepted = true, rejected = false, blind_known = true, blind_rejected = false;
    std::set<std::string> failed;
    std::string reason;
    for (const std::filesystem::path& image : m.images) {
      if (image.extension() != ".so" && m.images.size() > 1 && cases_for(plan_, image, false).empty())
        continue;
      FORCEGATE_TRY(const Gated g, gate_image(plan_, &m, image, seed, quick));
      played = true;
      accepted = accepted && g.kind == DecisionKind::accept;
      rejected = rejected || g.kind == DecisionKind::reject;
      blind_known = blind_known && g.conformance_known && !(quick && !m.good());
      blind_rejected = blind_rejected || g.blind == DecisionKind::reject;
      failed.insert(g.failed.begin(), g.failed.end());
      if (reason.empty() || (m.good() ? g.kind != DecisionKind::accept : g.kind == DecisionKind::reject))
        reason = g.reason;
    }
    if (!played) return {};
    const bool as_expected = m.good() ? accepted : rejected && expected(m, failed);
    if (outcome.runs == 0 || (outcome.as_expected && !as_expected)) outcome.reason = reason;
    outcome.as_expected = outcome.as_expected && as_expected;
    ++outcome.runs;
    outcome.rejected += rejected ? 1 : 0;
    outcome.accepted += accepted && !rejected ? 1 : 0;
    for (const std::string& id : failed) ++outcome.checks[id];
    if (blind_known) {
      ++outcome.blind_runs;
      outcome.blind_rejected += blind_rejected ? 1 : 0;
    }
    return {};
  }

  void step(const std::string& now) {
    if (progress_) progress_(std::min(1.0, done_ / total_), now);
    done_ += 1.0;
  }

  const PowerRequest& request_;
  const Plan& plan_;
  const Plan* panel_;
  PowerGatings gatings_;
  const GateProgress& progress_;
  PowerResult result_;
  double done_ = 0.0, total_ = 1.0;
};

}  // namespace

std::vector<FamilyOutcome> PowerResult::families() const {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  std::vector<FamilyOutcome> out;
  for (const MutantOutcome& o : outcomes) {
    if (!o.mutant.level) continue;
    if (out.empty() || out.back().family != o.mutant.family) {
      out.push_back({o.mutant.family, o.mutant.unit, o.mutant.breaks, kNan, kNan, o.runs, o.blind_runs, {}});
    }
    FamilyOutcome& f = out.back();
    f.levels.push_back(&o);
    const auto settle = [&](double& smallest, std::size_t k, std::size_t n) {
      const bool found = n > 0 && static_cast<double>(k) >= 0.95 * static_cast<double>(n);
      if (!found)
        smallest = kNan;
      else if (std::isnan(smallest))
        smallest = *o.mutant.level;
    };
    settle(f.smallest, o.rejected, o.runs);
    settle(f.smallest_blind, o.blind_rejected, o.blind_runs);
    f.blind_runs = std::min(f.blind_runs, o.blind_runs);
  }
  return out;
}

std::vector<const MutantOutcome*> PowerResult::survivors() const {
  std::vector<const MutantOutcome*> out;
  for (const MutantOutcome& o : outcomes)
    if (!o.mutant.good() && o.rejected < o.runs) out.push_back(&o);
  return out;
}

std::vector<const MutantOutcome*> PowerResult::refused() const {
  std::vector<const MutantOutcome*> out;
  for (const MutantOutcome& o : outcomes)
    if (o.mutant.good() && o.accepted < o.runs) out.push_back(&o);
  return out;
}

PowerCount PowerResult::slipped() const {
  PowerCount c;
  for (const MutantOutcome& o : outcomes)
    if (!o.mutant.good() && o.mutant.seen_by.front() != "nothing") {
      c.k += o.accepted;
      c.n += o.runs;
    }
  return c;
}

// Levels of a family are gated more often: the share of rejections at each is what its smallest defect follows from.
// These further runs are quick ones; what would be seen without conformance is measured in the full ones only.
std::size_t PowerRequest::runs_of(const Mutant& m) const { return m.level ? std::max(mutant_seeds, family_seeds) : mutant_seeds; }

bool PowerResult::nothing_built() const { return outcomes.empty() && !not_built.empty() && std::max(request.mutant_seeds, request.family_seeds) > 0; }

bool PowerResult::nothing_played() const {
  return std::ranges::all_of(outcomes, [](const MutantOutcome& o) { return o.runs == 0; });
}

bool PowerResult::nothing_asked() const { return request.seeds + request.panel_seeds + std::max(request.mutant_seeds, request.family_seeds) == 0; }

bool PowerResult::good() const {
  if (reference.rejected + panel.rejected > 0 || nothing_built() || nothing_asked()) return false;
  return std::all_of(outcomes.begin(), outcomes.end(), [&](const MutantOutcome& o) {
    if (o.runs == 0 && request.runs_of(o.mutant) > 0) return false;
    if (o.mutant.good()) return o.rejected == 0;
    return o.rejected == o.runs || o.mutant.seen_by.front() == "nothing";
  });
}

Result<PowerResult> measure_power(const PowerRequest& request, const GateProgress& progress,
                                  const std::atomic<bool>* cancelled) {
  std::error_code ignored;
  if (request.seeds + request.panel_seeds > 0 && !std::filesystem::is_regular_file(request.firmware / kReference, ignored))
    return fail(ErrorCode::usage, "there is no reference image to be accepted", (request.firmware / kReference).string(),
                "name the folder that the build made (--firmware build/firmware), or leave the reference out: --seeds 0");
  FORCEGATE_TRY(const std::filesystem::path path, find_plan(request.plan));
  FORCEGATE_TRY(const Plan plan, read_plan(path));
  std::optional<Plan> panel;
  if (request.panel_seeds > 0) {
    FORCEGATE_TRY(const std::filesystem::path panel_path, find_plan(request.panel_plan));
    FORCEGATE_TRY(panel, read_plan(panel_path));
  }
  std::vector<const Plan*> plans{&plan};
  if (panel) plans.push_back(&*panel);
  FORCEGATE_TRY(PowerGatings gatings, PowerGatings::open(plans, request.journal, request.threads, cancelled));
  return PowerRun(request, plan, panel ? &*panel : nullptr, std::move(gatings), progress).run();
}

}  // namespace forcegate
