#pragma once
// Candidates that are tried for a while in the spare columns of a channel.

#include "hil/diagnose/workspace.h"

namespace forcegate::diagnose {

/// Candidates, variants and columns that were added since are gone again in the end, unless they are kept.
class SpareRoom {
 public:
  explicit SpareRoom(ResidualChannel& channel)
      : channel_(channel), first_spare_(channel.first_spare), candidates_(channel.candidates.size()), variants_(channel.variants.size()) {}
  ~SpareRoom() {
    if (kept_) return;
    channel_.first_spare = first_spare_;
    channel_.candidates.resize(candidates_);
    channel_.variants.resize(variants_);
  }
  SpareRoom(const SpareRoom&) = delete;
  SpareRoom& operator=(const SpareRoom&) = delete;

  void keep() { kept_ = true; }

 private:
  ResidualChannel& channel_;
  int first_spare_;
  std::size_t candidates_, variants_;
  bool kept_ = false;
};

}  // namespace forcegate::diagnose
