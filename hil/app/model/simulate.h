#pragma once
// `forcegate simulate`: what a model says to the forces of a campaign; one CSV per record.

#include <atomic>

#include "hil/app/model/model_input.h"

namespace forcegate {

struct Simulation {
  struct Item {
    std::string record;
    std::filesystem::path file;
    std::size_t rows = 0;
    double row_s = 0.0;      ///< length of a row's mean
    bool is_thinned = false;  ///< a row is the mean of several samples
    double rmse_V = 0.0;  ///< against the measured output
  };
  std::vector<Item> items;
  std::string unit = "V";  ///< of the measured output
};

/// Columns t_s, F_ref_N, U_V (measured), U_model_V on the rows (at most 50 a second); rows that a fit would not use have no measured values.
/// Errors (cancelled): `interrupted` was set; nothing new is left in the folder.
Result<Simulation> simulate_request(const CampaignRequest& request, const std::filesystem::path& folder, const std::atomic<bool>* interrupted = nullptr);

std::string simulation_text(const Simulation& simulation);

}  // namespace forcegate
