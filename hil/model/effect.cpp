#include "hil/model/effect.h"

#include <algorithm>

namespace forcegate {

namespace {

bool has(const CampaignInput& campaign, Need need) {
  switch (need) {
    case Need::theta: return campaign.has_theta;
    case Need::drive: return campaign.has_drive;
    case Need::command: return campaign.has_command;
    case Need::witness: return campaign.has_theta || campaign.has_command;
    case Need::generic: return campaign.generic;
  }
  return false;
}

}  // namespace

bool is_available(const EffectKind& kind, const CampaignInput& campaign) {
  return std::ranges::all_of(kind.needs, [&](Need need) { return has(campaign, need); });
}

const EffectForm* find_form(const EffectKind& kind, std::string_view form_name) {
  for (const EffectForm& form : kind.forms)
    if (form.name == form_name) return &form;
  return nullptr;
}

}  // namespace forcegate
