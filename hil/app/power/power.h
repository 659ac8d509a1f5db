#pragma once
// `forcegate power`: how good is the gate? Every mutant is gated like any build; the reference is gated over
// many seeds. What is rejected, by which check, with which probability a bad build slips through, how often a
// good one is refused.

#include <atomic>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "hil/app/gate/gate.h"
#include "hil/app/power/mutant.h"

namespace forcegate {

struct PowerRequest {
  std::filesystem::path firmware;  ///< folder of the images: reference.native.so ..., mutants/
  std::string plan = "power";
  std::size_t seeds = 59;        ///< runs of the reference; specimens and sessions differ
  std::size_t mutant_seeds = 1;  ///< runs of every mutant
  std::size_t family_seeds =
      1;  ///< runs of every level of a graded family, at least mutant_seeds; the others quick
  std::string panel_plan = "panel";
  std::size_t panel_seeds = 0;    ///< runs of the reference under panel_plan
  bool quick = false;             ///< a bad build is done with at the case that rejects it
  std::vector<std::string> only;  ///< names of mutants or families; empty = all
  std::filesystem::path journal;  ///< gatings done are kept there and not done again; empty: none is kept
  unsigned threads = 0;
  std::filesystem::path markdown = "docs/power.md";  ///< named by the page as where it is written

  std::size_t runs_of(const Mutant& m) const;
};

/// k of n, with the interval of Clopper and Pearson at 95 %.
struct PowerCount {
  std::size_t k = 0, n = 0;
};

struct MutantOutcome {
  Mutant mutant;
  std::size_t runs = 0, rejected = 0, accepted = 0;  ///< the rest was left undecided
  std::map<std::string, std::size_t> checks;         ///< failed required check -> runs in which it failed
  std::size_t blind_runs = 0, blind_rejected = 0;    ///< had no implementation of its algorithm been known
  bool as_expected = true;  ///< some run failed a check of `seen by` (bad), or every run was accepted (good)
  std::string reason;       ///< of the first decision that was not expected, else of the first
};

/// Runs of the reference build under one plan: how often is a good build refused?
struct ReferenceRuns {
  std::string plan_name;
  std::uint64_t first_seed = 0;
  std::size_t n = 0, accepted = 0, rejected = 0;  ///< the rest was left undecided
  std::vector<std::string> reasons;               ///< decisions that were no ACCEPT, with their seed
};

/// Smallest level of a family from which on at least 95 % of the runs are rejected; NaN when there is none.
struct FamilyOutcome {
  std::string family, unit, breaks;
  double smallest = 0.0, smallest_blind = 0.0;
  std::size_t runs = 0;                      ///< of each level
  std::size_t blind_runs = 0;                ///< of each level, at least
  std::vector<const MutantOutcome*> levels;  ///< from the smallest defect on
};

struct PowerResult {
  PowerRequest request;
  std::string plan_name, plan_sha256;
  std::uint64_t first_seed = 0;
  ReferenceRuns reference, panel;  ///< panel.n = 0: not asked for
  std::vector<MutantOutcome> outcomes;
  std::vector<std::string> not_built;

  std::vector<FamilyOutcome> families() const;
  std::vector<const MutantOutcome*> survivors() const;  ///< bad builds that some run did not reject
  std::vector<const MutantOutcome*> refused() const;    ///< good builds that some run did not accept
  PowerCount slipped() const;  ///< accepted runs of bad builds that the plan claims to see
  bool nothing_played() const;  ///< there are mutants, and no run of any was asked for
  bool nothing_built() const;  ///< runs of mutants are asked for, and there is no image of any
  bool nothing_asked() const;  ///< no run of any image was asked for
  /// No good build rejected, no survivor that is not declared as one, every build that is there was played.
  bool good() const;
};

Result<PowerResult> measure_power(const PowerRequest& request, const GateProgress& progress = {},
                                  const std::atomic<bool>* cancelled = nullptr);

std::string power_text(const PowerResult& result);      ///< for the console
std::string power_json(const PowerResult& result);      ///< the same facts
std::string power_markdown(const PowerResult& result);  ///< docs/power.md

}  // namespace forcegate
