#pragma once
// `forcegate next`: what to measure next so that the rivals part.

#include "hil/app/diagnose/diagnose.h"

namespace forcegate {

std::string next_text(const Diagnosis& diagnosis);
std::string next_json(const Diagnosis& diagnosis);

}  // namespace forcegate
