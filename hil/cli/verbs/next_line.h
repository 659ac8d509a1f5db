#pragma once
// The last lines of the diagnosis: hil/app/diagnose/what_next.h as a command that works when it is pasted, with the names that the user gave.

#include <optional>
#include <string>

#include "hil/app/diagnose/what_next.h"
#include "hil/cli/command.h"

namespace forcegate {

/// What the next command is about; the --map and --rate of the line that was given hold for it too.
struct AskedAbout {
  std::string campaign;     ///< as given, or the folder that was written
  std::string model;        ///< "": none was named
  bool page = false;        ///< the pictures were written
  bool experiment = false;  ///< the answer is that of `next`
};

std::string line_after_diagnosis(const Invocation& in, const Diagnosis& diagnosis, const AskedAbout& about);

/// "forcegate export MODEL ... --c comp.h" in the form that export takes; nullopt when it refuses the model. A model that comes with the
/// program is nobody's: it is refitted on the campaign and kept (-o model.toml), or there is no line.
std::optional<std::string> export_line(const Invocation& in, const std::string& model, const std::string& campaign);

/// After a model file was fitted on the campaign: into firmware when what is left is noise and export takes it, else the question what
/// else is missing.
std::string line_after_fit(const Invocation& in, const std::string& model, const std::string& campaign, double error, double floor);

}  // namespace forcegate
