// The topics: their names, message types, and kinds of delivery. docs/topics.md is the reference.
#pragma once

#include <span>
#include <string_view>
#include <tuple>

#include "modules/messages/message_types.h"

namespace palpate::bus {

enum class Delivery {
  kStream,  ///< best effort, newest sample per key
  kState,   ///< reliable, newest sample per key also to late joiners
};

template <class Message>
struct TopicOf {
  std::string_view name;
  Delivery delivery;
};

inline constexpr TopicOf<SceneDescription> kScene{"scene", Delivery::kState};
inline constexpr TopicOf<SurfaceTopology> kSurface{"surface", Delivery::kState};
inline constexpr TopicOf<NodePositions> kNodePositions{"node_positions", Delivery::kStream};
inline constexpr TopicOf<ProbeState> kProbeState{"probe_state", Delivery::kStream};
inline constexpr TopicOf<ProbeState> kProbeInput{"probe_input", Delivery::kStream};
inline constexpr TopicOf<Contacts> kContacts{"contacts", Delivery::kStream};
inline constexpr TopicOf<ContactModel> kContactModel{"contact_model", Delivery::kStream};
inline constexpr TopicOf<HapticForce> kHapticForce{"haptic_force", Delivery::kStream};
inline constexpr TopicOf<ModuleStatus> kModuleStatus{"module_status", Delivery::kState};
inline constexpr TopicOf<SessionControl> kSessionControl{"session_control", Delivery::kState};
inline constexpr TopicOf<ClockExchange> kClock{"clock", Delivery::kStream};

/// All of them.
inline constexpr auto kTopics =
    std::tuple(kScene, kSurface, kNodePositions, kProbeState, kProbeInput, kContacts, kContactModel,
               kHapticForce, kModuleStatus, kSessionControl, kClock);

/// A topic without its C++ type.
struct TopicInfo {
  std::string_view name;
  Delivery delivery;
  const messages::MessageType* type;
};

template <class Message>
TopicInfo info_of(const TopicOf<Message>& topic) {
  return {topic.name, topic.delivery, &messages::type_of<Message>()};
}

/// Every topic, in the order of kTopics.
std::span<const TopicInfo> all_topics();

/// nullptr if there is none of that name.
const TopicInfo* find_topic(std::string_view name);

}  // namespace palpate::bus
