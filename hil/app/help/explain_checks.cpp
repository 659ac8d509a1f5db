#include "hil/app/help/explain.h"

namespace forcegate {
namespace {

constexpr const char* kRig = "No build is judged by such a record. forcegate bench selfcheck tries the rig alone (docs/trust.md).";
constexpr const char* kOwn = "Mend the build: nothing on the bench makes this.";

}  // namespace

const std::vector<Explanation>& check_explanations() {
  static const std::vector<Explanation> kAll = {
      {"firmware_runs", "check", "The firmware answers every sample: it was loaded, echoed nonce and calibration, and did neither crash, hang, end nor leave samples out.",
       "The evidence says how it ended and in which block of samples, or while it was opened; run that record again with a debugger."},
      {"rig_runs", "check", "The rig plays the record from begin to end; the evidence names the instrument that failed.", kRig},
      {"conformance", "check", "Largest distance of the output from an independent implementation of the algorithm that the image declares, on the same codes.",
       "Compare the build with its algorithm: the rig has no part in it."},
      {"mre_maxima", "check", "Mean relative error of the maxima, eq. (9): firmware against ATI in an open loop, ATI against set-point in a closed one.",
       "Look at maxima over time: a slope is drift that is not compensated, a constant distance is gain or offset."},
      {"mre_minima", "check", "The same of the minima.", "Look at minima over time, and at the offset of the calibration."},
      {"mae_maxima", "check", "Mean absolute error of the maxima, N; judged where a relative error would say nothing.", "As of mre_maxima."},
      {"mae_minima", "check", "Mean absolute error of the minima, N; judged where the profile's minimum is below the plan's floor.", "As of mre_minima."},
      {"accuracy", "check", "An accuracy was asked for, and the record holds too few extrema for one.", "Play a longer profile, or one that swings more than the plan's prominence."},
      {"accuracy_maxima", "check", "An accuracy of the maxima was asked for, and neither the case nor a limits file has a limit for it.",
       "Give maxima_pct and limit_source in the case, or derive limits: forcegate limits --help"},
      {"accuracy_minima", "check", "The same of the minima.", "Give minima_pct and limit_source in the case, or derive limits: forcegate limits --help"},
      {"record", "check", "The record was not made: interrupted, not played because the firmware had hung in another one, or stopped by a defect of Forcegate.", "The evidence says which."},
      {"time_base", "check", "Times of the rows that do not advance.", "Look at the board's clock and the link."},
      {"waiver_valid", "check", "A waiver whose day is over: it waives nothing any more, and fails.", "Mend what it waived, or renew it with a reason and a new day (docs/trust.md)."},
      {"promise_maxima", "check", "Closed loop: mean over the specimens of the mean relative error of the ATI's maxima against the set-point; the paper promises 4.5 %.",
       "The single specimens stand in the cases; forcegate gate FIRMWARE --keep keeps their samples."},
      {"promise_minima", "check", "The same of the minima; the paper promises 7.5 %.", "As of promise_maxima."},
      {"no_worse_maxima", "check", "Increase of the mean relative error of the maxima against the accepted build, in points.", "forcegate diff ACCEPTED CANDIDATE says where."},
      {"no_worse_minima", "check", "The same of the minima.", "forcegate diff ACCEPTED CANDIDATE says where."},
      {"rig_network", "check", "Gate of a firmware that reads conductance and capacitance: the network in double precision on the codes of this bench, mean squared error.",
       "Beyond the limit no firmware can hold it on these codes: look at the bench, or train the networks on its sensors."},
      {"finite", "check", "The same gate: forces of the firmware that are no number.", kOwn},
      {"saturation_flag", "check", "The same gate: saturated frames that are not flagged, and sound ones that are. A saturated reading is no force.", kOwn},
      {"mse", "check", "The same gate: mean squared error of one sensor against the weights.", "The evidence has the network's own error beside it: what lies above that is the build's."},
      {"mse_pack", "check", "The same gate: mean squared error, mean over the sensors of the pack.", "As of mse."},
      {"per_pack", "check", "The same gate: percentage of error reduction against conductance alone, eq. (11), mean over the pack.", "As of mse."},
      {"no_worse_per", "check", "The same gate: loss of error reduction against the accepted build.", "As of mse."},
      {"learning_window", "check", "Longest start window, in which the firmware says that it still learns; it is left out of the errors.", kOwn},
      {"lag", "check", "Distance in time between firmware and ATI.", "Look for filters, buffers and a late link (rig_sensor_sync tells what the codes bring along)."},
      {"output_finite", "check", "Samples of the output that are NaN or infinite.", kOwn},
      {"output_bounded", "check", "Largest force that the firmware reported, against the plan's bound.", kOwn},
      {"hold_amplification", "check", "Output over the static law in a hold after cycling: the correction must not go on growing there.", kOwn},
      {"link_intact", "check", "Frames and samples that were lost, damaged or refused between board and harness.", "Check cable, baud rate and load of the line."},
      {"coverage", "check", "Share of the planned record that is missing.", "Find out what cut it short; a retry may mend it."},
      {"extrema_count", "check", "Share of the profile's extrema that the record does not have.", "Look whether the wheel followed and whether the plan's prominence fits."},
      {"safety_stop", "check", "The record was stopped: force above the limit, no ATI reading, a fault of the drive, or a command that is no number.",
       "The evidence says why and whether the build had left the ATI before."},
      {"prelude_output", "check", "Output in the session before RESET, under codes that no rig makes: finite and bounded.", kOwn},
      {"prelude_conformance", "check", "Conformance in that session.", kOwn},
      {"instructions_worst", "check", "Instructions of the slowest sample (lane tick).", kOwn},
      {"samples_late", "check", "Samples that were not done before the next tick (lane tick).", kOwn},
      {"stack_bytes", "check", "High-water mark of the painted stack.", kOwn},
      {"ram_bytes", "check", "Static data of the image and its stack.", kOwn},
      {"flash_bytes", "check", "Sections of the image that are loaded.", kOwn},
      {"heap_growth", "check", "Memory that was taken and not given back while samples ran (native lane).", kOwn},
      {"golden", "check", "Golden trace of the case: missing, or of another profile.", "forcegate bless RUN --reason ... --who ..."},
      {"golden_firmware", "check", "Output against the blessed one, deviation over tolerance; only of the same algorithm and seed.",
       "If the change is meant: forcegate bless RUN --reason ... --who ..."},
      {"rig_golden", "check", "ATI against the blessed one: whether the rig still plays what it played.", kRig},
      {"rig_samples", "check", "Samples that never arrived, gaps in time.", kRig},
      {"rig_clock", "check", "Time stamps against the number of samples.", kRig},
      {"rig_reference_identity", "check", "The ATI runs with the calibration that the bench names.", kRig},
      {"rig_reference_zero", "check", "Unloaded ATI reading before and after the record.", kRig},
      {"rig_reference_valid", "check", "Samples in which the ATI is saturated, faulty or no number.", kRig},
      {"rig_reference_noise", "check", "Noise of the ATI against what it declares.", kRig},
      {"rig_reference_alive", "check", "Time in which the ATI reading stood still while wheel, or sensor, moved.", kRig},
      {"rig_reference_lag", "check", "Lag of the ATI behind the spring.", kRig},
      {"rig_motor", "check", "Wheel that stands while commanded; fault of the drive.", kRig},
      {"rig_following", "check", "Wheel angle beside the commanded one, beyond the drive's own lag and what the steps of the command explain.", kRig},
      {"rig_spring_witness", "check", "ATI against spring and wheel angle, worst mean over 10 s.", kRig},
      {"rig_spring_slope", "check", "The same, slope: stiffness of the spring or gain of the ATI.", kRig},
      {"rig_spring_scatter", "check", "The same, scatter: play between shaft and wheel.", kRig},
      {"rig_sensor", "check", "Time in which the sensor's code stood while the force moved: dead, stale or cut off.", kRig},
      {"rig_sensor_jumps", "check", "Code that jumps while the ATI stands: a bad contact.", kRig},
      {"rig_sensor_follows", "check", "Stretches of 10 s in which the code does not follow the ATI.", kRig},
      {"rig_sensor_sync", "check", "Distance in time between the sensor's codes and the ATI.", kRig},
      {"rig_adc", "check", "Converter bits that never change.", kRig},
      {"rig_calibration_fits", "check", "Calibration that was loaded, over the first 3 s and the first swing, against the ATI.",
       "Calibrate the specimen that lies on the bench, or give the file of the specimen that was recorded (--cal)."},
  };
  return kAll;
}

}  // namespace forcegate
