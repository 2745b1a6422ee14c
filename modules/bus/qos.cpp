#include "modules/bus/qos.h"

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#include <memory>

namespace palpate::bus {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
using eprosima::fastrtps::Duration_t;

constexpr std::uint32_t kSocketBufferBytes = 4u << 20;  // a 19 000 node message is 234 KB
constexpr std::uint32_t kMaxDatagramBytes = 65'500;     // larger samples travel in fragments
constexpr std::uint32_t kNanosecondsPerMillisecond = 1'000'000;

Duration_t milliseconds(std::uint32_t ms) { return {0, ms * kNanosecondsPerMillisecond}; }

// The settings that writers and readers share.
template <class Qos>
void apply_common(Delivery delivery, Qos& qos) {
  const bool state = delivery == Delivery::kState;
  qos.reliability().kind = state ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind =
      state ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = 1;
  qos.resource_limits().max_instances = kMaxKeys;
  qos.resource_limits().max_samples_per_instance = 1;
  qos.resource_limits().max_samples = kMaxKeys;
  qos.resource_limits().allocated_samples = 4;
  qos.data_sharing().off();
}

}  // namespace

void apply_transport(const std::vector<std::string>& interfaces, dds::DomainParticipantQos& qos) {
  auto udp = std::make_shared<UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = interfaces;
  udp->sendBufferSize = kSocketBufferBytes;
  udp->receiveBufferSize = kSocketBufferBytes;
  udp->maxMessageSize = kMaxDatagramBytes;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);

  // With the defaults one join in five took more than 1.5 s.
  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.initial_announcements.count = 20;
  discovery.initial_announcements.period = milliseconds(50);
  discovery.leaseDuration_announcementperiod = milliseconds(250);
  // Every remote participant is checked once per lease. A check that meets one just leaving aborts
  // the process (2.9.1: assertion in PDP::check_remote_participant_liveliness; leases of 3 ms show
  // it in seconds): so not while a session lasts. Nobody waits for the lease: a silent process is
  // told by the age of its samples.
  discovery.leaseDuration = {86'400, 0};
}

void apply_profile(Delivery delivery, dds::DataWriterQos& qos) {
  apply_common(delivery, qos);
  qos.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.reliable_writer_qos().times.heartbeatPeriod = milliseconds(100);
  qos.reliable_writer_qos().times.nackResponseDelay = milliseconds(1);
}

void apply_profile(Delivery delivery, dds::DataReaderQos& qos) {
  apply_common(delivery, qos);
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.reliable_reader_qos().times.heartbeatResponseDelay = milliseconds(1);
}

}  // namespace palpate::bus
