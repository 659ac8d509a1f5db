#pragma once
// `forcegate bless`: the only way in which goldens and derived limits change, with who, why, from which firmware, rig and
// calibration, and a table of what changes.

#include <filesystem>
#include <string>
#include <vector>

#include "hil/base/result.h"

namespace forcegate {

struct BlessRequest {
  std::filesystem::path source;   ///< folder of a run, or a limits file made by forcegate limits
  std::string who, reason;        ///< neither may be empty
  std::filesystem::path goldens;  ///< folder of the goldens; empty = the one that the run's plan names
  std::string plan;               ///< name or file; empty = the one that the limits name, or that the run was gated with
  bool dry_run = false;
};

struct BlessChange {
  std::string file;  ///< what is written
  std::string what;  ///< "new", "unchanged", "ATI by at most 0.0012 N, firmware by at most 0.0310 N"
  bool changed = true;
};

struct BlessAnswer {
  std::vector<BlessChange> changes;
  std::filesystem::path target;      ///< folder of goldens, or file of limits
  std::filesystem::path governance;  ///< file that got a line
  std::string line;                  ///< of that file
  bool written = false;
};

/// A run is blessed only when everything but its goldens passed, on a rig without injected faults. Errors: usage (no reason, nobody's name,
/// a run that was not accepted, a plan without goldens), those of the bundle.
Result<BlessAnswer> bless(const BlessRequest& request);

std::string bless_text(const BlessAnswer& answer);
std::string bless_json(const BlessAnswer& answer);

}  // namespace forcegate
