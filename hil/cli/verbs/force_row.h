#pragma once
// The option of verbs that replace their own files only.

#include "hil/cli/command.h"

namespace forcegate {

inline Option force_row() { return {.name = "force", .value_name = "", .doc = "Replace a file that this command did not write.", .letter = 'f'}; }

}  // namespace forcegate
