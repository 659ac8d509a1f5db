#pragma once
// `forcegate simulate`: what a model says to the forces of a campaign; one CSV per record.

#include <atomic>
#include <optional>

#include "hil/app/model/model_input.h"

namespace forcegate {

struct Simulation {
  struct Item {
    std::string record;
    std::filesystem::path file;
    std::size_t rows = 0;
    double row_s = 0.0;      ///< length of a row's mean
    bool is_thinned = false;  ///< a row is the mean of several samples
    std::optional<double> rmse_V;  ///< against the measured output; none where the model's is in another unit or beyond every number
  };
  std::vector<Item> items;
  std::string unit = "V", model_unit = "V";  ///< of the measured output and of the model's
  std::vector<std::string> notes;
  bool is_comparable() const { return unit == model_unit; }
};

/// Columns t_s, F_ref_N, U_V (measured), U_model_V on the rows, with the units of the outputs in their headers (at most 50 a second); rows that a fit would not use have no measured values.
/// Errors (cancelled): `interrupted` was set; (usage): a file of somebody else stands there, unless `replaces`. Nothing new is left in the folder.
Result<Simulation> simulate_request(const CampaignRequest& request, const std::filesystem::path& folder, const std::atomic<bool>* interrupted = nullptr,
                                    bool replaces = false);

std::string simulation_text(const Simulation& simulation);

}  // namespace forcegate
