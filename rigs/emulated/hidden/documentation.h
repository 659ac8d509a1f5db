#pragma once
// What campaign.json says: the lab's notes of a campaign, with keys left out as labs do. One source for the
// file and for the structure in memory, so that both tell the same.

#include <optional>
#include <string>
#include <vector>

#include "rigs/emulated/hidden/plant.h"

namespace forcegate::hidden {

struct RecordNotes {
  std::string file, kind;
  std::optional<std::string> role;
  std::optional<double> rate_Hz, duration_s, start_s, rest_before_s, excitation_start_s, f_min_Hz, A_N, m_N,
      drive_V, eccentricity_mm, preload_mm;
  std::optional<bool> dynamic;
  std::optional<int> mounting;
};

struct BenchNotes {
  std::string sensor;
  std::optional<double> spring_N_per_mm, reference_resolution_N, reference_noise_N;
  std::optional<int> adc_bits;
  bool voltage_range = true, force_range = true, law = true;
  std::vector<RecordNotes> records;
};

BenchNotes write_down(std::uint64_t seed, const std::string& name, const Conditions& conditions,
                      const std::vector<RecordData>& records);

}  // namespace forcegate::hidden
