#pragma once
// What Lebosse 2011 says in numbers, beside what a study measured.

#include <optional>
#include <string>
#include <vector>

#include "hil/characterize/population_study.h"

namespace forcegate {

struct PaperClaim {
  std::string place;         ///< "III-C, Fig. 6"
  std::string subject;       ///< what is measured, one phrase
  std::string sensor;        ///< "FlexiForce", "FSR"
  std::string paper;         ///< as the paper says it: "83 % on average"
  double paper_value = 0.0;  ///< for the ratio; NaN where there is none
  std::string unit;
  double ours = 0.0, spread = 0.0;  ///< mean and standard deviation between specimens; NaN = not measured
  std::size_t specimens = 0;
  std::optional<double> low, high;  ///< window in which the emulated rig must lie, if one is set
  std::string why;                  ///< why ours differs, or what to know
  bool inside() const { return ours != ours || ((!low || ours >= *low) && (!high || ours <= *high)); }
};

/// In the order of the paper. Claims whose procedure was not played are left out.
std::vector<PaperClaim> compare_with_paper(const std::vector<characterize::SensorStudy>& studies);

/// The study of a sensor, nullptr when it was not made.
const characterize::SensorStudy* study_of(const std::vector<characterize::SensorStudy>& studies,
                                          std::string_view sensor);

}  // namespace forcegate
