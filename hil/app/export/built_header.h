#pragma once
// An exported header, built by the host's compiler and loaded: what the firmware will compute, on this machine.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hil/base/result.h"

namespace forcegate {

class BuiltHeader {
 public:
  /// Errors: io where there is no compiler, no place to build in, or the library cannot be loaded; config where the header does not compile.
  static Result<std::unique_ptr<BuiltHeader>> build(const std::string& header);
  ~BuiltHeader();
  BuiltHeader(const BuiltHeader&) = delete;
  BuiltHeader& operator=(const BuiltHeader&) = delete;

  /// F of every sample, from reset on. `low`: the lowest force, or what a firmware sees of it (u at its floor).
  std::vector<float> run(const std::vector<float>& u, const std::vector<float>& shrink, const std::vector<float>& low, bool low_is_force,
                         const std::vector<float>& T) const;

 private:
  using Replay = void (*)(int, const float*, const float*, const float*, int, const float*, float*);
  BuiltHeader();
  Result<void> load();

  std::filesystem::path folder_;  ///< of its own; empty: there is none
  std::filesystem::path place_;   ///< where it was to be made
  void* handle_ = nullptr;
  Replay replay_ = nullptr;
};

}  // namespace forcegate
