#pragma once
// How plainly an effect between records can show, whoever looks: the bound that an engine is measured against.

#include <vector>

#include "rigs/emulated/hidden/effect.h"
#include "rigs/emulated/hidden/plant.h"

namespace forcegate::hidden {

/// Detectability index d' (Green and Swets 1966) of an observer who knows what the effect adds to every record and by how much
/// gains and zeros scatter, but not where they lie:
///
///   d'^2 = d' (C^-1 - C^-1 X (X' C^-1 X)^-1 X' C^-1) d,   d = (gain_i, zero_i) that the effect adds to record i,
///   C = scatter of gain and zero, shared within sessions + what the record's noise leaves open,   X = the same for all records
///
/// What the effect does within a record counts nothing. An engine that knows neither the course nor the scatter needs more: with n
/// records the scatter is known from n - 2 of them, and some ten courses compete. 0 for fewer than 3 records.
/// `with` and `without` have the same plans and random numbers.
double detectability_between(const std::vector<RecordData>& with, const std::vector<RecordData>& without,
                             const Conditions& conditions, Measure measure);

}  // namespace forcegate::hidden
