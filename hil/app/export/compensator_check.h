#pragma once
// Builds an exported compensator with the host's C compiler and replays a campaign through it.
//
//   arithmetic   the model answers to the recorded forces, the compensator inverts the answer: what is left is the header's
//                single precision and its solver, since the model's own inverse of its own answer is the force itself; a rate
//                of the force is taken from the samples so far, as a firmware must
//   recording    the recorded voltages, sample by sample as a converter reads them (recorded_output.h), with U_min tracked as a firmware
//                does it, against the force recorded at the same instants: as the header makes them with gain and offset of the model ("raw"), and with the best
//                straight line over the campaign first, by the output as a law is fitted, for the plain law and for the compensator each. A
//                calibration on the bench finds that line, so that gain and offset of a session do not count; a firmware that calibrates by
//                the model has none

#include <filesystem>
#include <string>
#include <vector>

#include "hil/model/compensator/compensator.h"
#include "hil/trace/campaign.h"

namespace forcegate {

struct ReplayedRecord {
  std::string record;
  double seconds = 0.0;      ///< that were judged
  double left_out_s = 0.0;   ///< without samples: bridged for the compensator's memory, not judged
  double cut_s = 0.0;        ///< behind the first `most_s` of the record: not replayed
  double largest_N = 0.0;    ///< |compensator - model's own inverse|
  double largest_at_N = 0.0;  ///< force at which it is
  double plain_rms_N = 0.0;  ///< recorded voltage through the law without the effects
  double compensated_rms_N = 0.0;
  double raw_plain_rms_N = 0.0, raw_compensated_rms_N = 0.0;  ///< with gain and offset of the model
  double own_plain_rms_N = 0.0, own_compensated_rms_N = 0.0;  ///< with a gain and a zero of its own
};

struct CompensatorCheck {
  std::vector<ReplayedRecord> records;
  double largest_N = 0.0;
  double lsb_N = 0.0;  ///< of the campaign's converter: |G| range / (2^bits - 1) of volts, |G| of counts; 0: a unit that no converter gives
  std::string assumed;  ///< what lsb_N takes for granted because the campaign does not say it; "" nothing
  double plain_rms_N = 0.0, compensated_rms_N = 0.0;  ///< records weigh the same
  double raw_plain_rms_N = 0.0, raw_compensated_rms_N = 0.0;  ///< the same with gain and offset of the model
  double line_gain = 1.0, line_zero_N = 0.0;                  ///< F = gain * (what the header says) + zero, the best over the campaign
  double span_N = 0.0;                                        ///< of the recorded force
  bool by_model = false;  ///< the firmware calibrates by the model: gain and offset count, and the raw errors are its own
  std::string compiler;
  std::string far_off;  ///< records replayed far above what their fit leaves (replayed_far_off.h); "" none, or nothing was fitted
};

/// What speaks against putting the header into firmware, one sentence each; empty: nothing. It differs from the model's own inverse by more
/// than 8 LSB and a tenth of the error that it leaves; it leaves a larger error than the law alone (by more than 2 %), each with its best line; or the
/// firmware calibrates by the model, and its gain and offset are off by more than a twentieth of the span (RMS) and by what the line leaves.
std::vector<std::string> objections(const CompensatorCheck& check);
/// What is to be said where the error on the records is not smaller with the header than with the law alone, and not so much larger that it is an
/// objection; "" otherwise. Of a header that undoes something.
std::string gains_nothing(const CompensatorCheck& check);
/// The first of them.
bool differs_from_model(const CompensatorCheck& check);
/// The last of them.
bool is_off_in_gain(const CompensatorCheck& check);

/// Each record is replayed for at most `most_s` seconds. Errors: io when there is no C compiler (cc), config when the header
/// does not compile (with the compiler's words), those of the campaign.
Result<CompensatorCheck> check_compensator(const Model& model, const Compensator& compensator, double rate_Hz,
                                           const Campaign& campaign, double most_s = 600.0);

}  // namespace forcegate
