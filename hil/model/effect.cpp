#include "hil/model/effect.h"

#include <algorithm>

namespace forcegate {

namespace {

bool has(const CampaignInput& campaign, Need need) {
  switch (need) {
    case Need::theta: return campaign.has_theta;
    case Need::drive: return campaign.has_drive;
    case Need::command: return campaign.has_command;
    case Need::witness: return campaign.has_theta || campaign.has_spindle || campaign.has_command;
    case Need::generic: return campaign.generic;
  }
  return false;
}

}  // namespace

bool is_available(const EffectKind& kind, const CampaignInput& campaign) {
  return std::ranges::all_of(kind.needs, [&](Need need) { return has(campaign, need); });
}

bool shows_in_levels(const EffectKind& kind) {
  return kind.traits.between_records || std::ranges::any_of(kind.forms, &EffectForm::outlasts);
}

bool is_between_records(const std::string& effect) {
  const EffectKind* kind = EffectRegistry::instance().find(effect);
  return kind != nullptr && kind->traits.between_records;
}

bool is_timing(const std::string& effect) {
  const EffectKind* kind = EffectRegistry::instance().find(effect);
  return kind != nullptr && kind->traits.timing;
}

bool look_alike(const EffectKind& a, const EffectKind& b) {
  const auto lists = [](const EffectKind& x, const EffectKind& y) {
    return std::find(x.look_alikes.begin(), x.look_alikes.end(), y.name) != x.look_alikes.end();
  };
  return (a.traits.timing && b.traits.timing) || lists(a, b) || lists(b, a);
}

const EffectForm* find_form(const EffectKind& kind, std::string_view form_name) {
  for (const EffectForm& form : kind.forms)
    if (form.name == form_name) return &form;
  return nullptr;
}

}  // namespace forcegate
