#include "modules/bus/bus.h"

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include <algorithm>
#include <chrono>

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
#include "modules/bus/participant.h"
#include "modules/bus/qos.h"
#include "modules/bus/sequence_gaps.h"

namespace palpate::bus {
namespace {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;

template <class Message>
struct WireOf;
#define PALPATE_WIRE(Name)                 \
  template <>                              \
  struct WireOf<Name> {                    \
    using Type = idl::Name;                \
    using Support = idl::Name##PubSubType; \
  };
PALPATE_WIRE(ProbeState)
PALPATE_WIRE(Contacts)
PALPATE_WIRE(ContactModel)
PALPATE_WIRE(NodePositions)
PALPATE_WIRE(SurfaceTopology)
PALPATE_WIRE(HapticForce)
PALPATE_WIRE(ModuleStatus)
PALPATE_WIRE(SceneDescription)
PALPATE_WIRE(SessionControl)
#undef PALPATE_WIRE

// A wire object that also counts the payloads that could not be read into it. DDS itself drops
// those without a word.
template <class Wire>
struct Received : Wire {
  std::uint64_t unreadable = 0;
};

// The generated code lets some exceptions of malformed payloads through (a boolean of 2, a list
// too long to allocate), which would end the process in a thread of DDS.
template <class Support>
class GuardedSupport : public Support {
 public:
  using Wire = typename Support::type;

  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override {
    bool readable = false;
    try {
      readable = Support::deserialize(payload, data);
    } catch (...) {
    }
    if (!readable) ++received(data)->unreadable;
    return readable;
  }
  void* createData() override { return static_cast<Wire*>(new Received<Wire>); }
  void deleteData(void* data) override { delete received(data); }

 private:
  static Received<Wire>* received(void* data) {
    return static_cast<Received<Wire>*>(static_cast<Wire*>(data));
  }
};

template <class Message>
dds::TopicDataType* new_type_support() {
  return new GuardedSupport<typename WireOf<Message>::Support>;
}

std::int64_t monotonic_now_ns() {
  return std::chrono::nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

WriterId writer_of(const dds::SampleInfo& info) {
  WriterId id;
  const auto& guid = info.sample_identity.writer_guid();
  std::copy_n(guid.guidPrefix.value, 12, id.begin());
  std::copy_n(guid.entityId.value, 4, id.begin() + 12);
  return id;
}

}  // namespace

struct Bus::Impl {
  Participant participant;
};

// --- Writer ---

template <class Message>
struct Writer<Message>::Impl {
  Participant& participant;
  dds::DataWriter* writer;
  typename WireOf<Message>::Type wire;
  std::uint64_t sequence = 0;
  const char* refused_field = nullptr;

  ~Impl() { participant.remove(writer); }
};

template <class Message>
Writer<Message>::Writer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
template <class Message>
Writer<Message>::Writer(Writer&&) noexcept = default;
template <class Message>
Writer<Message>& Writer<Message>::operator=(Writer&&) noexcept = default;
template <class Message>
Writer<Message>::~Writer() = default;

template <class Message>
bool Writer<Message>::write(Message& message) {
  message.header.sequence = impl_->sequence + 1;
  impl_->refused_field = encode(message, impl_->wire);
  if (impl_->refused_field != nullptr) return false;
  if (impl_->wire.source_time_ns() == 0) impl_->wire.source_time_ns(monotonic_now_ns());
  ++impl_->sequence;
  return impl_->writer->write(&impl_->wire);
}

template <class Message>
int Writer<Message>::matched_readers() const {
  dds::PublicationMatchedStatus status;
  impl_->writer->get_publication_matched_status(status);
  return status.current_count;
}

template <class Message>
bool Writer<Message>::wait_until_received(double longest) {
  const eprosima::fastrtps::Duration_t duration(static_cast<long double>(longest));
  return impl_->writer->wait_for_acknowledgments(duration) ==
         eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
}

template <class Message>
const char* Writer<Message>::refused_field() const {
  return impl_->refused_field;
}

// --- Reader ---

template <class Message>
struct Reader<Message>::Impl {
  Participant& participant;
  dds::DataReader* reader;
  Received<typename WireOf<Message>::Type> wire;
  SequenceGaps gaps;
  ReaderStatistics statistics;

  ~Impl() { participant.remove(reader); }
  bool take_wire(dds::SampleInfo& info);
  bool accept(const dds::SampleInfo& info, Message& message);
  void reject(const char* field, std::uint64_t count) {
    statistics.rejected += count;
    statistics.last_rejected_field = field;
  }
};

template <class Message>
Reader<Message>::Reader(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
template <class Message>
Reader<Message>::Reader(Reader&&) noexcept = default;
template <class Message>
Reader<Message>& Reader<Message>::operator=(Reader&&) noexcept = default;
template <class Message>
Reader<Message>::~Reader() = default;

template <class Message>
bool Reader<Message>::Impl::take_wire(dds::SampleInfo& info) {
  typename WireOf<Message>::Type* const target = &wire;
  const bool taken = reader->take_next_sample(target, &info) == ReturnCode_t::RETCODE_OK;
  if (wire.unreadable > 0) reject("payload", wire.unreadable);
  wire.unreadable = 0;
  return taken;
}

template <class Message>
bool Reader<Message>::Impl::accept(const dds::SampleInfo& info, Message& message) {
  gaps.count(writer_of(info), wire.sequence_number());
  statistics.dropped = gaps.dropped();
  if (const char* field = decode(wire, message)) {
    reject(field, 1);
    return false;
  }
  ++statistics.received;
  statistics.newest_source_time_ns =
      std::max(statistics.newest_source_time_ns, message.header.source_time_ns);
  return true;
}

template <class Message>
bool Reader<Message>::take(Message& message) {
  // One sample per key can be waiting: more tries would only chase a writer that floods.
  for (int tries = 0; tries < kMaxKeys; ++tries) {
    dds::SampleInfo info;
    if (!impl_->take_wire(info)) return false;
    if (info.valid_data && impl_->accept(info, message)) return true;
  }
  return false;
}

template <class Message>
bool Reader<Message>::wait(double timeout) {
  return impl_->reader->wait_for_unread_message(eprosima::fastrtps::Duration_t(timeout));
}

template <class Message>
int Reader<Message>::matched_writers() const {
  dds::SubscriptionMatchedStatus status;
  impl_->reader->get_subscription_matched_status(status);
  return status.current_count;
}

template <class Message>
const ReaderStatistics& Reader<Message>::statistics() const {
  return impl_->statistics;
}

// --- Bus ---

Bus::Bus(const BusOptions& options) : impl_(new Impl{Participant(options)}) {}
Bus::~Bus() = default;

template <class Message>
Writer<Message> Bus::writer(const TopicOf<Message>& topic) {
  using WriterImpl = typename Writer<Message>::Impl;
  Participant& participant = impl_->participant;
  auto* dds_writer =
      participant.add_writer(topic.name, topic.delivery, new_type_support<Message>());
  return Writer<Message>(std::unique_ptr<WriterImpl>(new WriterImpl{participant, dds_writer, {}}));
}

template <class Message>
Reader<Message> Bus::reader(const TopicOf<Message>& topic) {
  using ReaderImpl = typename Reader<Message>::Impl;
  Participant& participant = impl_->participant;
  auto* dds_reader =
      participant.add_reader(topic.name, topic.delivery, new_type_support<Message>());
  return Reader<Message>(
      std::unique_ptr<ReaderImpl>(new ReaderImpl{participant, dds_reader, {}, {}, {}}));
}

#define PALPATE_INSTANTIATE(Message)                                   \
  template class Writer<Message>;                                      \
  template class Reader<Message>;                                      \
  template Writer<Message> Bus::writer(const TopicOf<Message>& topic); \
  template Reader<Message> Bus::reader(const TopicOf<Message>& topic);
PALPATE_INSTANTIATE(ProbeState)
PALPATE_INSTANTIATE(Contacts)
PALPATE_INSTANTIATE(ContactModel)
PALPATE_INSTANTIATE(NodePositions)
PALPATE_INSTANTIATE(SurfaceTopology)
PALPATE_INSTANTIATE(HapticForce)
PALPATE_INSTANTIATE(ModuleStatus)
PALPATE_INSTANTIATE(SceneDescription)
PALPATE_INSTANTIATE(SessionControl)
#undef PALPATE_INSTANTIATE

}  // namespace palpate::bus
