#pragma once
// The last lines of the verbs that stand at a bench: a command that works when it is pasted, or a sentence where a person must act first.

#include <optional>
#include <string>

#include "hil/app/bench/bench.h"
#include "hil/cli/command.h"

namespace forcegate {

/// The bench file as the next command must name it, with the --attach that it was asked with.
std::string bench_words(const Invocation& in, const std::string& file);

/// Gate on that bench. Twins: the reference build that comes with the program; `calibration` "" = measured. A real bench: a sentence, since
/// nobody but the person who stands there may let it move.
std::string line_that_gates_on(const Invocation& in, const std::string& file, const std::string& calibration = "");

/// Stop the motor; nullopt for twins that live only inside a run, which nobody else can reach.
std::optional<std::string> line_that_parks(const Invocation& in, const std::string& file);

/// After `bench list`: ask the twins that need no hardware, else the first bench that reads.
std::string line_after_list(const std::vector<BenchRow>& benches);

}  // namespace forcegate
