#include "modules/bus/topics.h"

#include <algorithm>
#include <array>

namespace palpate::bus {

std::span<const TopicInfo> all_topics() {
  static const std::array topics{info_of(kScene),         info_of(kSurface),
                                 info_of(kNodePositions), info_of(kProbeState),
                                 info_of(kProbeInput),    info_of(kContacts),
                                 info_of(kContactModel),  info_of(kHapticForce),
                                 info_of(kModuleStatus),  info_of(kSessionControl)};
  return topics;
}

const TopicInfo* find_topic(std::string_view name) {
  const auto topics = all_topics();
  const auto found = std::ranges::find(topics, name, &TopicInfo::name);
  return found == topics.end() ? nullptr : &*found;
}

}  // namespace palpate::bus
