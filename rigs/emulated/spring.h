#pragma once

namespace forcegate::emulated {

/// Linear spring between trolley and sensor: F = k (preload + x), never a pull. k is about 0.25 N/mm
/// (Lebosse 2011, II-B).
struct Spring {
  double stiffness_N_per_mm = 0.25;
  double preload_mm = 0.0;

  double force_N(double travel_mm) const {
    const double force = stiffness_N_per_mm * (preload_mm + travel_mm);
    return force > 0.0 ? force : 0.0;
  }
};

}  // namespace forcegate::emulated
