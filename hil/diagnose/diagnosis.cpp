#include "hil/diagnose/diagnosis.h"

namespace forcegate {

std::string to_string(DiagnosisVerdict verdict) {
  switch (verdict) {
    case DiagnosisVerdict::none: return "none";
    case DiagnosisVerdict::known: return "known";
    case DiagnosisVerdict::unknown: return "unknown";
  }
  return "none";
}

std::string to_string(JudgedBy by) {
  switch (by) {
    case JudgedBy::heldout: return "heldout";
    case JudgedBy::left_out: return "left_out";
    case JudgedBy::whole: return "whole";
  }
  return "heldout";
}

std::string error_name(JudgedBy by) { return by == JudgedBy::whole ? "error of the whole recording" : "held-out error"; }

bool Finding::limit(double most, const std::string& why) {
  if (!(probability > most)) return false;
  probability = most;
  reservations.push_back({most, why});
  evidence += (most < kClaim ? "; not claimed: " : "; less sure: ") + why;
  return true;
}

}  // namespace forcegate
