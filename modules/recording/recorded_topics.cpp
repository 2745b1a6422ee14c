#include "modules/recording/recorded_topics.h"

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <algorithm>
#include <array>
#include <cctype>

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
#include "modules/recording/idl_texts.h"
#include "modules/recording/mcap_bytes.h"

namespace palpate::recording {
namespace {

using eprosima::fastcdr::Cdr;
using eprosima::fastdds::dds::TopicDataType;

// Fifty milliseconds of the fastest loop (4 kHz) and more; large messages come far less often.
constexpr int kSmallDepth = 256;
constexpr int kLargeDepth = 16;
constexpr std::size_t kEncapsulationBytes = 4;

template <class Wire>
bool deserialize(std::span<const std::uint8_t> payload, Wire& wire) {
  try {
    std::vector<char> bytes(payload.begin(), payload.end());  // FastBuffer wants to write
    eprosima::fastcdr::FastBuffer buffer(bytes.data(), bytes.size());
    Cdr cdr(buffer, Cdr::DEFAULT_ENDIAN, Cdr::DDS_CDR);
    cdr.read_encapsulation();
    wire.deserialize(cdr);
    return true;
  } catch (const std::exception&) {  // of malformed payloads: any of fastcdr's, length, memory
    return false;
  }
}

template <class Message, class Wire>
const char* decode_payload(std::span<const std::uint8_t> payload, AnyMessage& message) {
  Wire wire;
  if (!deserialize(payload, wire)) return "payload";
  return bus::decode(wire, message.emplace<Message>());
}

template <class Support>
TopicDataType* new_support() {
  return new Support;
}

template <class Message, class Support>
constexpr RecordedTopic entry(const bus::TopicOf<Message>& topic, std::string_view type_name,
                              std::string_view idl_text, int depth) {
  return {topic.name,
          type_name,
          idl_text,
          topic.delivery,
          depth,
          new_support<Support>,
          decode_payload<Message, typename Support::type>};
}

#define PALPATE_ENTRY(topic, Message, depth)                                                       \
  entry<Message, idl::Message##PubSubType>(bus::topic, "palpate::idl::" #Message, k##Message##Idl, \
                                           depth)
constexpr std::array kTopics{
    PALPATE_ENTRY(kScene, SceneDescription, kLargeDepth),
    PALPATE_ENTRY(kSurface, SurfaceTopology, kLargeDepth),
    PALPATE_ENTRY(kNodePositions, NodePositions, kLargeDepth),
    PALPATE_ENTRY(kProbeState, ProbeState, kSmallDepth),
    PALPATE_ENTRY(kProbeInput, ProbeState, kSmallDepth),
    PALPATE_ENTRY(kContacts, Contacts, kSmallDepth),
    PALPATE_ENTRY(kContactModel, ContactModel, kSmallDepth),
    PALPATE_ENTRY(kHapticForce, HapticForce, kSmallDepth),
    PALPATE_ENTRY(kModuleStatus, ModuleStatus, kSmallDepth),
    PALPATE_ENTRY(kSessionControl, SessionControl, kSmallDepth),
};
#undef PALPATE_ENTRY

// The text without comments; words separated by one space.
std::string bare_idl(std::string_view text) {
  std::string bare;
  bool space = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.substr(i, 2) == "//") i = text.find('\n', i);
    if (i == std::string_view::npos) break;  // the last line was a comment
    if (std::isspace(static_cast<unsigned char>(text[i]))) {
      space = true;
      continue;
    }
    if (space && !bare.empty()) bare += ' ';
    space = false;
    bare += text[i];
  }
  return bare;
}

}  // namespace

std::span<const RecordedTopic> recorded_topics() { return kTopics; }

const RecordedTopic* find_recorded_topic(std::string_view name) {
  const auto found = std::find_if(kTopics.begin(), kTopics.end(),
                                  [&](const RecordedTopic& topic) { return topic.name == name; });
  return found == kTopics.end() ? nullptr : &*found;
}

Header header_of(std::span<const std::uint8_t> payload) {
  std::array<std::uint8_t, 24> fields{};
  if (payload.size() < kEncapsulationBytes + fields.size()) return {};
  std::copy_n(payload.begin() + kEncapsulationBytes, fields.size(), fields.begin());
  const bool big_endian = (payload[1] & 1) == 0;
  if (big_endian) {
    for (std::size_t i = 0; i < fields.size(); i += 8) {
      std::reverse(fields.begin() + static_cast<long>(i),
                   fields.begin() + static_cast<long>(i) + 8);
    }
  }
  ByteReader reader(fields);
  Header header;
  header.sequence = reader.u64();
  header.sim_time_ns = static_cast<std::int64_t>(reader.u64());
  header.source_time_ns = static_cast<std::int64_t>(reader.u64());
  return header;
}

bool same_idl(std::string_view a, std::string_view b) { return bare_idl(a) == bare_idl(b); }

}  // namespace palpate::recording
