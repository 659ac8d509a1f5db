#pragma once
// Parts of docs/paper.md in Markdown: Tables I to III, the laws (5), calibration levels, the printed Table II.

#include <string>
#include <vector>

#include "hil/characterize/population_study.h"

namespace forcegate {

std::string table_II_markdown(const characterize::SensorStudy& flexiforce,
                              const characterize::StudyPlan& plan);
std::string table_III_markdown(const characterize::SensorStudy& flexiforce);
std::string laws_markdown(const characterize::LawStudy& laws);
std::string levels_markdown(const characterize::SensorStudy& flexiforce);
std::string printed_table_markdown();

/// "4.5(3)"-free plain number with three significant digits, "-" for NaN.
std::string short_number(double value, int digits = 3);

}  // namespace forcegate
