#include "hil/app/bench/fault_matrix.h"

namespace forcegate {

const std::vector<FaultScenario>& fault_scenarios() {
  using enum Blame;
  static const std::vector<FaultScenario> kAll{
      {"reference_saturated", 2.0, "ATI overloads at 2 N", {reference}},
      {"reference_offset", 0.3, "ATI reads 0.3 N too much", {reference}},
      {"reference_offset", -0.1, "ATI reads 0.1 N too little", {reference}},
      {"reference_offset", 0.02, "ATI reads 0.02 N too much", {reference}, false},
      {"reference_drift", 0.05, "ATI drifts by 50 mN a minute", {reference}},
      {"reference_drift", -0.02, "ATI drifts by -20 mN a minute", {reference}},
      {"reference_drift", 0.002, "ATI drifts by 2 mN a minute", {reference}, false},
      {"reference_gain", 1.2, "ATI reads 20 % too much", {reference, rig}},
      {"reference_gain", 0.95, "ATI reads 5 % too little", {reference, rig}},
      {"reference_gain", 1.01, "ATI reads 1 % too much", {reference, rig}, false},
      {"wrong_calibration", 1.02, "ATI runs with the calibration of another cell, 2 % off", {reference}},
      {"wrong_calibration", 2.5, "ATI runs with the calibration of another cell, 150 % off", {reference}},
      {"reference_swapped", 0.03, "ATI reads out a lateral axis", {reference}},
      {"reference_swapped", -1.0, "ATI reads out with the wrong sign", {reference}},
      {"reference_frozen", 40.0, "ATI repeats its reading from 40 s on", {reference}},
      {"reference_stale", 0.1, "ATI repeats its reading in a tenth of the time", {reference, link}},
      {"reference_late", 0.05, "ATI reading comes 50 ms late", {reference, link}},
      {"reference_late", 0.004, "ATI reading comes 4 ms late", {reference, link}, false},
      {"motor_stalled", 60.0, "shaft stands still from 60 s on", {rig}},
      {"motor_ripple", 0.06, "wheel angle ripples by 0.06 rad", {rig}},
      {"motor_backlash", 0.2, "0.2 rad of play between shaft and wheel", {rig}},
      {"motor_backlash", 0.01, "0.01 rad of play between shaft and wheel", {rig}, false},
      {"preload_wrong", 1.0, "preload 1 mm more than set", {rig}},
      {"preload_wrong", -0.5, "preload 0.5 mm less than set", {rig}},
      {"spring_slipped", 1.0, "spring loses 1 mm of preload in mid-run", {rig}},
      {"spring_slipped", 0.1, "spring loses 0.1 mm of preload in mid-run", {rig}, false},
      {"spring_stiffness", 1.1, "spring 10 % stiffer than set", {rig, reference}},
      {"sensor_unplugged", 50.0, "sensor unplugged at 50 s", {sensor}},
      {"sensor_late", 0.1, "sensor's codes come 100 ms late", {link}},
      {"sensor_late", 0.005, "sensor's codes come 5 ms late", {link}, false},
      {"sensor_stale", 0.1, "sensor's code repeats in a tenth of the time", {link, sensor}},
      {"specimen_swapped", 1.6, "another specimen lies on the bench than the calibrated one", {calibration}},
      {"specimen_swapped", 0.6, "a far less sensitive specimen lies on the bench", {calibration}},
      {"adc_stuck_bit", 4.0, "converter bit 4 stuck", {rig, sensor}},
      {"adc_stuck_bit", 12.0, "converter bit 12 stuck", {rig, sensor, calibration}},
      {"adc_stuck_bit", 15.0, "converter bit 15 stuck", {rig, sensor, calibration}},
      {"adc_stuck_bit", 0.0, "converter bit 0 stuck", {rig, sensor}},
      {"sample_loss", 0.02, "2 % of the samples are lost", {link}},
      {"sample_loss", 0.0005, "0.05 % of the samples are lost", {link}, false},
      {"clock_skew", 0.01, "time stamps 1 % off", {link}},
      {"clock_skew", 1e-4, "time stamps 100 ppm off", {link}, false},
      {"clock_jump", 5.0, "time stamps jump by 5 s", {link}},
      {"clock_jump", -2.0, "time stamps jump back by 2 s", {link}},
      {"truncated", 90.0, "the record ends after 90 s", {link, rig}},
      {"board_dead", 70.0, "board silent from 70 s on", {link}},
      {"board_reset", 70.0, "board restarts at 70 s", {link}},
      {"board_stale", 0.02, "2 % of the board's answers repeat the one before", {link}},
      {"link_corrupt", 0.01, "1 % of the answers arrive damaged", {link}},
      {"link_loss", 0.01, "1 % of the answers never arrive", {link}},
      {"link_late", 0.2, "answers come 200 ms late", {link}},
  };
  return kAll;
}

}  // namespace forcegate
