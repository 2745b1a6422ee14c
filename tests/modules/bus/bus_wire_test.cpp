// What comes from outside: samples of a foreign writer that keep to the wire format, and that do
// not. The foreign writer uses the generated types and the DDS interface directly.
#include <catch2/catch.hpp>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/topic/Topic.hpp>

#include <cmath>
#include <cstring>
#include <limits>

#include "idl/ContactsPubSubTypes.h"
#include "idl/ProbeStatePubSubTypes.h"
#include "modules/bus/packet_filter.h"
#include "modules/bus/qos.h"
#include "tests/modules/bus/loopback.h"

namespace palpate::bus {
namespace {

namespace dds = eprosima::fastdds::dds;
using testing::own_options;
using testing::take_soon;
using testing::wait_until;

constexpr std::uint64_t kWireToken = 0x1122334455667788;

// A wire type whose serialized bytes the test may corrupt before they leave.
template <class Support>
class CorruptedSupport : public Support {
 public:
  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override {
    const bool done = Support::serialize(data, payload);
    if (corrupt) corrupt(*payload);
    return done;
  }
  std::function<void(eprosima::fastrtps::rtps::SerializedPayload_t&)> corrupt;
};

// Writes wire objects as they are, as another program would.
template <class Wire, class Support>
class ForeignWriter {
 public:
  ForeignWriter(const BusOptions& options, std::string_view topic)
      : corrupted_(new CorruptedSupport<Support>), support_(corrupted_) {
    dds::DomainParticipantQos qos;
    apply_transport({{"127.0.0.1"}, {}}, options.domain, {options.token.value(), false}, qos);
    auto* factory = dds::DomainParticipantFactory::get_instance();
    participant_ = factory->create_participant(static_cast<std::uint32_t>(options.domain), qos);
    participant_->register_type(support_);
    auto* dds_topic =
        participant_->create_topic(std::string(topic), support_.get_type_name(), dds::TopicQos());
    dds::PublisherQos publisher_qos;
    publisher_qos.partition().push_back(options.session.c_str());
    dds::DataWriterQos writer_qos;
    apply_profile({Delivery::kStream, Keep::kNewest, false}, writer_qos);
    writer_ =
        participant_->create_publisher(publisher_qos)->create_datawriter(dds_topic, writer_qos);
  }
  ~ForeignWriter() {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  ForeignWriter(const ForeignWriter&) = delete;
  ForeignWriter& operator=(const ForeignWriter&) = delete;

  bool matched() const {
    dds::PublicationMatchedStatus status;
    writer_->get_publication_matched_status(status);
    return status.current_count == 1;
  }
  void write(Wire& wire) { writer_->write(&wire); }
  void corrupt(std::function<void(eprosima::fastrtps::rtps::SerializedPayload_t&)> change) {
    corrupted_->corrupt = std::move(change);
  }

 private:
  CorruptedSupport<Support>* corrupted_;
  dds::TypeSupport support_;
  dds::DomainParticipant* participant_;
  dds::DataWriter* writer_;
};

using ForeignProbe = ForeignWriter<idl::ProbeState, idl::ProbeStatePubSubType>;
using ForeignContacts = ForeignWriter<idl::Contacts, idl::ContactsPubSubType>;

BusOptions wire_options() {
  BusOptions options = own_options();
  options.token = kWireToken;
  return options;
}

idl::ProbeState good_probe(std::uint64_t sequence) {
  idl::ProbeState wire;
  wire.sequence_number(sequence);
  wire.session_token(kWireToken);
  wire.rotation_xyzw({0, 0, 0, 1});
  return wire;
}

template <class Foreign, class Message>
bool matched(const Foreign& writer, const Reader<Message>& reader) {
  return wait_until([&] { return writer.matched() && reader.matched_writers() == 1; });
}

}  // namespace

TEST_CASE("wire: samples that break a rule are counted and skipped, and the field is named",
          "[bus]") {
  // Oracle: the wire specification; the good sample after the bad one arrives.
  const BusOptions options = wire_options();
  DdsBus bus(options);
  auto reader = bus.reader(kProbeInput);
  ForeignProbe foreign(options, kProbeInput.name);
  REQUIRE(matched(foreign, reader));

  idl::ProbeState bad = good_probe(1);
  bad.position_m()[1] = std::numeric_limits<double>::quiet_NaN();
  foreign.write(bad);
  ProbeState received;
  REQUIRE(wait_until([&] { return !reader.take(received) && reader.statistics().rejected == 1; }));
  CHECK(std::string(reader.statistics().last_rejected_field) == "position_m");

  idl::ProbeState good = good_probe(2);
  foreign.write(good);
  REQUIRE(take_soon(reader, received));
  CHECK(received.header.sequence == 2);
  CHECK(reader.statistics().received == 1);
  CHECK(reader.statistics().dropped == 0);
}

TEST_CASE("wire: a reader counts the sequence numbers that never came", "[bus]") {
  // Oracle: the gap made by hand, 2 to 6.
  const BusOptions options = wire_options();
  DdsBus bus(options);
  auto reader = bus.reader(kProbeInput);
  ForeignProbe foreign(options, kProbeInput.name);
  REQUIRE(matched(foreign, reader));
  ProbeState received;
  for (const std::uint64_t sequence : {1u, 7u}) {
    idl::ProbeState wire = good_probe(sequence);
    foreign.write(wire);
    REQUIRE(take_soon(reader, received));
  }
  CHECK(reader.statistics().dropped == 5);
}

TEST_CASE("wire: payloads that cannot be read are counted and do not stop a reader", "[bus]") {
  // Oracle: the good sample after each corrupted one arrives.
  using Payload = eprosima::fastrtps::rtps::SerializedPayload_t;
  const BusOptions options = wire_options();
  DdsBus bus(options);
  auto reader = bus.reader(kContacts);
  ForeignContacts foreign(options, kContacts.name);
  REQUIRE(matched(foreign, reader));

  idl::Contacts wire;
  wire.session_token(kWireToken);
  wire.probe_rotation_xyzw({0, 0, 0, 1});
  std::uint64_t sequence = 0;
  const auto check_survives = [&](const char* field, std::function<void(Payload&)> change) {
    const std::uint64_t rejected = reader.statistics().rejected;
    Contacts received;
    wire.sequence_number(++sequence);
    foreign.corrupt(std::move(change));
    foreign.write(wire);
    foreign.corrupt(nullptr);
    REQUIRE(wait_until(
        [&] { return !reader.take(received) && reader.statistics().rejected == rejected + 1; }));
    CHECK(std::string(reader.statistics().last_rejected_field) == field);
    wire.sequence_number(++sequence);
    foreign.write(wire);
    REQUIRE(take_soon(reader, received));
    CHECK(received.header.sequence == sequence);
  };
  // From the end: three lengths of lists of 4 bytes, 3 of padding, the boolean `truncated`.
  check_survives("truncated", [](Payload& p) { p.data[p.length - 16] = 2; });
  check_survives("payload", [](Payload& p) { std::memset(p.data + p.length - 4, 0xff, 4); });
  check_survives("payload", [](Payload& p) { p.length = 40; });
  check_survives("payload", [](Payload& p) { p.data[1] = 0x77; });
}

}  // namespace palpate::bus
