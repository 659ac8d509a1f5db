#include "hil/trace/trace.h"

namespace forcegate {

const Channel* Trace::find(std::string_view channel_name) const {
  for (const Channel& c : channels)
    if (c.name == channel_name) return &c;
  return nullptr;
}

Channel* Trace::find(std::string_view channel_name) {
  return const_cast<Channel*>(static_cast<const Trace*>(this)->find(channel_name));
}

}  // namespace forcegate
