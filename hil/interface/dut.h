#pragma once
// The device under test: a firmware image in one of its lanes. The lane hides how the image runs
// (shared object, QEMU with semihosting, QEMU with the link protocol, a board on a serial port).

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "hil/base/registry.h"
#include "hil/base/result.h"
#include "hil/interface/calibration.h"

namespace forcegate {

/// Flags of one output sample.
enum DutFlag : std::uint8_t {
  kDutExcited = 1 << 0,    ///< the firmware has detected cyclic loading
  kDutLearning = 1 << 1,   ///< start window still open: f_min and A not yet frozen
  kDutHeld = 1 << 2,       ///< static hold: no amplification
  kDutInputRail = 1 << 3,  ///< input code at the first or last code
  kDutOutputClamped = 1 << 4,
};

struct DutSession {
  std::filesystem::path image;
  std::uint32_t nonce = 0;  ///< derived from (seed, image hash, case); the image must echo it
  double rate_Hz = 1000.0;
  Calibration calibration;
};

/// The image and what it is to follow do not agree on the rate: nobody's fault yet, the session knows who gave the rate.
Unexpected wrong_rate(double image_Hz, double session_Hz, const std::string& where);

inline constexpr int kProtocolMajor = 1;

/// What an image answered to the greeting and to CAL.
struct DutEcho {
  int protocol_major = 0;
  std::uint32_t nonce = 0;
  bool calibration = false;  ///< came back as it was sent
  double rate_Hz = 0.0;
};

/// One rule for every lane and board: protocol major, nonce and calibration must be those of the session (ErrorCode::firmware),
/// and so must the rate (wrong_rate). `who`: "the image", "the board".
Result<void> check_echo(const DutEcho& echo, const DutSession& session, const std::string& who, const std::string& where);

struct DutInfo {
  int protocol_major = 0, protocol_minor = 0;
  std::string board;         ///< "native", "mps2-an386", "lm3s6965evb" ...
  std::string build_id;      ///< 40 hex digits of the image
  std::string algorithm_id;  ///< "lebosse-eq7/1": decides whether an oracle exists
  std::uint32_t nonce = 0;
  int adc_bits = 0;
  double rate_Hz = 0.0;
};

/// What the link noticed over a record. All zero on a sound one.
struct DutCounters {
  std::uint64_t samples = 0;
  std::uint64_t frames_dropped = 0;
  std::uint64_t frames_bad = 0;
  std::uint64_t indices_lost = 0;
  std::uint64_t overruns = 0;
  std::uint64_t naks = 0;
};

/// What a record cost on the target; NaN where the lane cannot tell.
struct DutResources {
  double instructions_worst = std::numeric_limits<double>::quiet_NaN();  ///< of one sample
  double instructions_mean = std::numeric_limits<double>::quiet_NaN();
  double worst_at_s = std::numeric_limits<double>::quiet_NaN();
  double late = std::numeric_limits<double>::quiet_NaN();         ///< samples not done within a sample period
  double stack_bytes = std::numeric_limits<double>::quiet_NaN();  ///< high-water mark
  double ram_bytes = std::numeric_limits<double>::quiet_NaN();    ///< static data of the image
  double flash_bytes = std::numeric_limits<double>::quiet_NaN();
  double heap_growth_bytes =
      std::numeric_limits<double>::quiet_NaN();  ///< not given back, first 20 s left out
};

class Dut {
 public:
  virtual ~Dut() = default;

  /// Starts the image, shakes hands, sends CAL, resets its state. Refuses a wrong nonce, an unknown
  /// protocol major or a calibration that is not echoed.
  virtual Result<DutInfo> open(const DutSession& session) = 0;

  /// Feeds n raw codes, first_index counted from the start of the record, and returns n forces and
  /// flags. Any fault of the image (crash, hang, wrong index) is ErrorCode::firmware.
  virtual Result<void> process(std::uint32_t first_index, std::span<const std::uint16_t> adc,
                               std::span<float> force_N, std::span<std::uint8_t> flags) = 0;

  /// Ends the record; the image may be opened again.
  virtual Result<DutCounters> close() = 0;

  /// RESET: a new session in the same running image, as after open(); the session before must be forgotten, only
  /// what the link lost goes on being counted. A lane whose image cannot be reset starts it anew.
  virtual Result<DutInfo> restart(const DutSession& session) {
    if (auto closed = close(); !closed) return Unexpected(closed.error());
    return open(session);
  }

  /// Of the record that was closed last.
  virtual DutResources resources() const { return {}; }
};

struct LaneKind {
  std::string name;  ///< "native", "block", "tick", "uart"
  std::string doc;
  /// Images this lane can run, judged by content ("ELF 64-bit shared object", "ARM, semihosting").
  std::function<bool(const std::filesystem::path& image)> accepts;
  std::function<Result<std::unique_ptr<Dut>>(const std::map<std::string, std::string>& options)> make;
};

}  // namespace forcegate
