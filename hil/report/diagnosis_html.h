#pragma once
// The HTML report of a diagnosis: what is missing, how sure, where it shows, what to measure next. Same frame
// and same rules as the report of a gate run (html_page.h).

#include <optional>
#include <string>

#include "hil/diagnose/diagnosis.h"
#include "hil/report/record_pictures.h"

namespace forcegate {

/// What a page begins with that answers another question than "which effect is missing?".
struct PageLead {
  std::string headline, why;   ///< plain text: the answer, and the errors behind it
  std::string colour;          ///< "ok", "wa" or "no"
  std::string id, name;        ///< of the first section
  std::string section;         ///< its HTML
};

struct DiagnosisPage {
  std::string tool_version;
  std::string command_line;  ///< that repeats it; "" = section left out
  bool comparison = false;   ///< of the model with records alone: no effect was searched, nothing is claimed
  RecordPictures pictures{};  ///< beside those of the diagnosis; empty: none
  std::optional<PageLead> lead{};
};

/// Pure: equal diagnoses give equal bytes.
std::string diagnosis_html(const Diagnosis& diagnosis, const DiagnosisPage& page = {});

/// One sentence: "Missing: hysteresis (sensor, probability 0.97)".
std::string diagnosis_headline(const Diagnosis& diagnosis);

}  // namespace forcegate
