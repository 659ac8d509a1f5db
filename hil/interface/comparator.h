#pragma once
// A comparator follows one record sample by sample and says how far the firmware is from what it should
// have done. Conformance oracles and golden tubes are comparators; the runner feeds them and judges.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hil/base/registry.h"
#include "hil/base/result.h"
#include "hil/interface/calibration.h"

namespace forcegate {

struct ComparatorSession {
  std::string algorithm_id;  ///< as the image declares it, "lebosse-eq7/1"
  Calibration calibration;
  double rate_Hz = 1000.0;
};

/// Passes when value <= limit. value is NaN when nothing could be compared.
struct Comparison {
  double value = 0.0;
  std::string unit = "LSB";
  double limit = 0.0;
  std::string limit_source;
  std::uint64_t n = 0;  ///< samples compared
  double worst_at_s = 0.0;
  std::string evidence;  ///< one sentence for a person
};

class Comparator {
 public:
  virtual ~Comparator() = default;
  /// Starts a record; all state of an earlier one is gone.
  virtual Result<void> begin(const ComparatorSession& session) = 0;
  /// Columns of equal length, in order, without gaps. No allocation.
  virtual void push(std::span<const std::uint16_t> adc, std::span<const float> force_N,
                    std::span<const std::uint8_t> flags) = 0;
  virtual Comparison finish() = 0;
};

/// Registry entry.
struct ComparatorKind {
  std::string name;  ///< "conformance"
  std::string doc;
  /// Whether this comparator knows the algorithm that the image declares.
  std::function<bool(std::string_view algorithm_id)> accepts;
  std::function<std::unique_ptr<Comparator>()> make;
  std::vector<std::string> algorithms = {};  ///< by their ids, for who slipped in one
};

/// The first, by name, that knows the algorithm; nullptr when none does. Who plays a record and who measures it again ask this.
inline const ComparatorKind* comparator_of(std::string_view algorithm_id) {
  for (const ComparatorKind& kind : Registry<ComparatorKind>::instance().all())
    if (kind.accepts(algorithm_id)) return &kind;
  return nullptr;
}

}  // namespace forcegate
