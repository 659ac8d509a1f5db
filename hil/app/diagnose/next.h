#pragma once
// `forcegate next`: what to measure next so that the rivals part.

#include "hil/app/diagnose/diagnose.h"

namespace forcegate {

/// `folder`: where the forces are written to; "": nowhere yet.
std::string next_text(const Diagnosis& diagnosis, const std::filesystem::path& folder = {});
std::string next_json(const Diagnosis& diagnosis);

}  // namespace forcegate
