#include "hil/diagnose/choose/in_place.h"

#include <algorithm>
#include <iterator>

#include "hil/diagnose/choose/code_jumps.h"
#include "hil/diagnose/choose/flat_top.h"
#include "hil/diagnose/choose/hold_growth.h"
#include "hil/model/came_in.h"

namespace forcegate::diagnose {

namespace {

struct InPlace {
  std::string_view effect;
  bool (*shows)(const CampaignInput&, const Candidate&);
  std::string_view what;
};

constexpr InPlace kTests[] = {
    {"clipping", [](const CampaignInput& input, const Candidate& c) { return stands_still_above(input, c.shape[0]); },
     "above it the output stands still, and right below it follows the force"},
    {"adc_codes", [](const CampaignInput& input, const Candidate& c) { return jumps_at_codes(input, lowest_code_V(input.bench), c.shape[0]); },
     "it jumps where the highest bits change, passage by passage, and nowhere midway"},
    {"creep", [](const CampaignInput& input, const Candidate&) { return grows_in_holds(input); },
     "where the force stands still it goes on under load and back after it, by one share of the load from hold to hold"},
};

const InPlace* test_of(const EffectKind& kind) {
  const auto found = std::ranges::find(kTests, std::string_view(kind.name), &InPlace::effect);
  return found == std::end(kTests) ? nullptr : found;
}

}  // namespace

bool shows_in_place(const CampaignInput& campaign, const Candidate& candidate) {
  const InPlace* test = test_of(*candidate.kind);
  return test != nullptr && test->shows(campaign, candidate);
}

std::string_view what_shows_in_place(const EffectKind& kind) {
  const InPlace* test = test_of(kind);
  return test == nullptr ? std::string_view{} : test->what;
}

}  // namespace forcegate::diagnose
