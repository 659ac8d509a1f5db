#include "hil/model/effect.h"

#include <cmath>

namespace forcegate {

bool is_available(const EffectKind& kind, const CampaignInput& campaign) {
  for (const std::string& need : kind.needs) {
    if (need == "theta" && !campaign.has_theta) return false;
    if (need == "temp" && !campaign.has_temp) return false;
    if (need == "humidity" && !campaign.has_humidity) return false;
    if (need == "drive" && !campaign.has_drive) return false;
    if (need == "command" && !campaign.has_command) return false;
    if (need == "range" && !std::isfinite(campaign.bench.voltage_max_V)) return false;
    if (need == "generic" && !campaign.generic) return false;
    if (need == "witness" && !campaign.has_theta && !campaign.has_command) return false;
  }
  return true;
}

const EffectForm* find_form(const EffectKind& kind, std::string_view form_name) {
  for (const EffectForm& form : kind.forms)
    if (form.name == form_name) return &form;
  return nullptr;
}

}  // namespace forcegate
