// What a recording holds of each topic: its name, wire type, the IDL text as schema, and how its
// samples are decoded.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "modules/bus/topics.h"

namespace eprosima::fastdds::dds {
class TopicDataType;
}

namespace palpate::recording {

using AnyMessage = std::variant<ProbeState, Contacts, ContactModel, NodePositions, SurfaceTopology,
                                HapticForce, ModuleStatus, SceneDescription, SessionControl>;

struct RecordedTopic {
  std::string_view name;       ///< "probe_state"
  std::string_view type_name;  ///< "palpate::idl::ProbeState"
  std::string_view idl_text;   ///< of idl/ProbeState.idl
  bus::Delivery delivery;
  int reader_depth;  ///< samples per key that wait while the recorder is busy

  /// Type support of the wire type, owned by the caller.
  eprosima::fastdds::dds::TopicDataType* (*new_support)();
  /// Fills `message` with this topic's kind of message from CDR with its encapsulation header.
  /// @return nullptr, or the wire name of the field that is not acceptable ("payload" if it is not
  /// CDR of this type)
  const char* (*decode)(std::span<const std::uint8_t> payload, AnyMessage& message);
};

/// Every topic of the project.
std::span<const RecordedTopic> recorded_topics();

/// nullptr if there is none of that name.
const RecordedTopic* find_recorded_topic(std::string_view name);

/// The first fields of every wire type, without decoding the rest. Zeros if the payload is too
/// short for them.
Header header_of(std::span<const std::uint8_t> payload);

/// True if both texts define the same types: comments and white space do not count.
bool same_idl(std::string_view a, std::string_view b);

}  // namespace palpate::recording
