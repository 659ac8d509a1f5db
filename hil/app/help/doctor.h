#pragma once
// `forcegate doctor`: what this machine has, what it lacks, and how to get it.

#include <string>
#include <vector>

namespace forcegate {

struct DoctorItem {
  std::string name;  ///< "qemu-system-arm"
  enum class State { ok, missing, limited } state = State::missing;
  bool required = false;  ///< the gate on the emulated rig does not work without it
  std::string found;      ///< version, path or measured fact
  std::string used_for;
  std::string remedy;  ///< what to type; "" when ok
};

/// Looks at PATH, /dev, /proc and the limits of this process; starts the found programs with --version. Changes nothing.
/// `program`: path of the forcegate binary, next to which the firmware images are looked for.
std::vector<DoctorItem> examine_machine(const std::string& program);

}  // namespace forcegate
