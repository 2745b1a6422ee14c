// The delivery rules, read back from the DDS entities that exist, not from what was asked for.
#include "modules/bus/qos.h"

#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <catch2/catch.hpp>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>

#include "modules/bus/participant.h"
#include "modules/core/organ_limits.h"
#include "tests/modules/bus/loopback.h"

namespace palpate::bus {
namespace {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastdds::rtps::ChainingTransportDescriptor;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;

template <class Qos>
void check_common(const Qos& qos) {
  CHECK(qos.history().kind == dds::KEEP_LAST_HISTORY_QOS);
  CHECK(qos.history().depth == 1);
  CHECK(qos.data_sharing().kind() == dds::OFF);
  CHECK(qos.resource_limits().max_instances == int(kMaxKeys));
  CHECK(qos.endpoint().history_memory_policy ==
        eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE);
}

template <class Qos>
void check_stream(const Qos& qos) {
  check_common(qos);
  CHECK(qos.reliability().kind == dds::BEST_EFFORT_RELIABILITY_QOS);
  CHECK(qos.durability().kind == dds::VOLATILE_DURABILITY_QOS);
}

template <class Qos>
void check_state(const Qos& qos) {
  check_common(qos);
  CHECK(qos.reliability().kind == dds::RELIABLE_RELIABILITY_QOS);
  CHECK(qos.durability().kind == dds::TRANSIENT_LOCAL_DURABILITY_QOS);
}

}  // namespace

TEST_CASE("qos: streams are best effort and state is kept for late joiners", "[bus]") {
  // Oracle: the table of docs/topics.md.
  Participant participant(testing::own_options());
  auto* stream_writer = participant.add_writer(info_of(kContacts));
  auto* stream_reader = participant.add_reader(info_of(kContacts), Keep::kNewest);
  auto* state_writer = participant.add_writer(info_of(kSurface));
  auto* state_reader = participant.add_reader(info_of(kSurface), Keep::kNewest);
  check_stream(stream_writer->get_qos());
  check_stream(stream_reader->get_qos());
  check_state(state_writer->get_qos());
  check_state(state_reader->get_qos());
  CHECK(stream_writer->get_qos().publish_mode().kind == dds::SYNCHRONOUS_PUBLISH_MODE);
  CHECK(state_writer->get_qos().publish_mode().kind == dds::SYNCHRONOUS_PUBLISH_MODE);
}

TEST_CASE("qos: with every sample nothing is best effort and no stream forgets", "[bus]") {
  // Oracle: the table of docs/topics.md.
  BusOptions options = testing::own_options();
  options.every_sample = true;
  Participant participant(options);
  const auto* stream_writer = participant.add_writer(info_of(kContacts));
  const auto* stream_reader = participant.add_reader(info_of(kContacts), Keep::kNewest);
  const auto* state_reader = participant.add_reader(info_of(kSurface), Keep::kNewest);
  CHECK(stream_writer->get_qos().reliability().kind == dds::RELIABLE_RELIABILITY_QOS);
  CHECK(stream_reader->get_qos().reliability().kind == dds::RELIABLE_RELIABILITY_QOS);
  CHECK(stream_writer->get_qos().durability().kind == dds::VOLATILE_DURABILITY_QOS);
  CHECK(stream_writer->get_qos().history().kind == dds::KEEP_ALL_HISTORY_QOS);
  CHECK(stream_reader->get_qos().history().kind == dds::KEEP_ALL_HISTORY_QOS);
  CHECK(state_reader->get_qos().history().depth == kStateDepth);
}

TEST_CASE("qos: a stream of a lockstep on one host starts no timer with each sample", "[bus]") {
  // Oracle: the profile's own reason: a time of no length runs out with every sample and reader.
  BusOptions options = testing::own_options();
  options.every_sample = true;
  Participant participant(options);
  const auto times_of = [&](const TopicInfo& topic) {
    return participant.add_writer(topic)->get_qos().reliable_writer_qos().times;
  };
  const auto stream = times_of(info_of(kContacts)), state = times_of(info_of(kSurface));
  constexpr std::int64_t kTenPeriods = 10'000'000;  // of the fastest loop that is usual, 1 kHz [ns]
  CHECK(stream.nackSupressionDuration.to_ns() >= kTenPeriods);
  CHECK(stream.heartbeatPeriod.to_ns() >= kTenPeriods);
  // Whoever says a new mesh waits until it is heard.
  CHECK(state.nackSupressionDuration.to_ns() == 0);
  CHECK(state.heartbeatPeriod.to_ns() < stream.heartbeatPeriod.to_ns());
}

TEST_CASE("qos: a participant uses UDP on loopback only, and finds others quickly", "[bus]") {
  // Oracle: the settings of docs/topics.md.
  const BusOptions options = testing::own_options();
  Participant participant(options);
  dds::DomainParticipant* found = dds::DomainParticipantFactory::get_instance()->lookup_participant(
      static_cast<std::uint32_t>(options.domain));
  REQUIRE(found != nullptr);
  const dds::DomainParticipantQos& qos = found->get_qos();
  CHECK(std::string(qos.name().c_str()) == options.participant_name);
  CHECK_FALSE(qos.transport().use_builtin_transports);
  REQUIRE(qos.transport().user_transports.size() == 1);
  const auto* filter =
      dynamic_cast<const ChainingTransportDescriptor*>(qos.transport().user_transports[0].get());
  REQUIRE(filter != nullptr);
  const auto* udp =
      dynamic_cast<const UDPv4TransportDescriptor*>(filter->low_level_descriptor.get());
  REQUIRE(udp != nullptr);
  CHECK(udp->interfaceWhiteList == std::vector<std::string>{"127.0.0.1"});
  CHECK(udp->receiveBufferSize == 4u << 20);
  CHECK(udp->sendBufferSize == 4u << 20);
  CHECK(qos.wire_protocol().builtin.metatrafficMulticastLocatorList.empty());
  CHECK(qos.wire_protocol().builtin.initialPeersList.size() == 1);
  const auto& discovery = qos.wire_protocol().builtin.discovery_config;
  CHECK(discovery.initial_announcements.count == 20);
  CHECK(discovery.leaseDuration.seconds == 86'400);
}

TEST_CASE("qos: the session is the partition of both publisher and subscriber", "[bus]") {
  // Oracle: the partition names read back from the entities.
  const BusOptions options = testing::own_options();
  Participant participant(options);
  const auto* writer = participant.add_writer(info_of(kContacts));
  const auto* reader = participant.add_reader(info_of(kContacts), Keep::kNewest);
  const std::vector<std::string> expected{options.session};
  CHECK(writer->get_publisher()->get_qos().partition().names() == expected);
  CHECK(reader->get_subscriber()->get_qos().partition().names() == expected);
}

}  // namespace palpate::bus
