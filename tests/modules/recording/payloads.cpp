#include "tests/modules/recording/payloads.h"

#include <catch2/catch.hpp>

#include "idl/ContactModelPubSubTypes.h"
#include "idl/ContactsPubSubTypes.h"
#include "idl/HapticForcePubSubTypes.h"
#include "idl/ModuleStatusPubSubTypes.h"
#include "idl/NodePositionsPubSubTypes.h"
#include "idl/ProbeStatePubSubTypes.h"
#include "idl/SceneDescriptionPubSubTypes.h"
#include "idl/SessionControlPubSubTypes.h"
#include "idl/SurfaceTopologyPubSubTypes.h"
#include "modules/bus/codec.h"

namespace palpate::recording {
namespace {

template <class Support, class Message>
std::vector<std::uint8_t> serialized(const Message& message) {
  typename Support::type wire;
  REQUIRE(bus::encode(message, wire) == nullptr);
  Support support;
  eprosima::fastrtps::rtps::SerializedPayload_t payload(support.getSerializedSizeProvider(&wire)());
  REQUIRE(support.serialize(&wire, &payload));
  std::vector<std::uint8_t> bytes(payload.data, payload.data + payload.length);
  bytes.resize((bytes.size() + 3) / 4 * 4);
  return bytes;
}

}  // namespace

#define PALPATE_CDR_OF(Message)                              \
  std::vector<std::uint8_t> cdr_of(const Message& message) { \
    return serialized<idl::Message##PubSubType>(message);    \
  }
PALPATE_CDR_OF(ProbeState)
PALPATE_CDR_OF(Contacts)
PALPATE_CDR_OF(ContactModel)
PALPATE_CDR_OF(NodePositions)
PALPATE_CDR_OF(SurfaceTopology)
PALPATE_CDR_OF(HapticForce)
PALPATE_CDR_OF(ModuleStatus)
PALPATE_CDR_OF(SceneDescription)
PALPATE_CDR_OF(SessionControl)
#undef PALPATE_CDR_OF

}  // namespace palpate::recording
