#pragma once
// A session before the session: another calibration, and codes that no rig makes (both rails, jumps, cycling
// over the whole range, noise, silence). Then RESET, and the record itself must come out as if nothing had
// been before.

#include <cstdint>
#include <vector>

#include "hil/gate/case_record.h"
#include "hil/interface/comparator.h"
#include "hil/interface/dut.h"

namespace forcegate {

/// Deterministic; n codes of `bits` bits. Holds code 0 and the last code, cycles long enough for the
/// compensation to act.
std::vector<std::uint16_t> hostile_codes(std::size_t n, int bits, double rate_Hz);

/// Opens the image with a calibration of its own, feeds `seconds` of hostile codes and resets it into
/// `session`. comparator may be null. The DutInfo is that of the session.
Result<DutInfo> play_prelude(Dut& dut, Comparator* comparator, const DutSession& session, double seconds,
                             PreludeFacts& facts);

}  // namespace forcegate
