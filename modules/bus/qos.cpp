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
constexpr int kUnlimited = -1;

Duration_t milliseconds(std::uint32_t ms) { return {0, ms * kNanosecondsPerMillisecond}; }

// Samples that wait for each key.
int depth(const Profile& profile) {
  if (profile.every_sample) return kStateDepth;
  return profile.keep == Keep::kBacklog ? kBacklogDepth : 1;
}

// The settings that writers and readers share.
template <class Qos>
void apply_common(const Profile& profile, Qos& qos) {
  const bool state = profile.delivery == Delivery::kState;
  const bool reliable = state || profile.every_sample;
  qos.reliability().kind =
      reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind =
      state ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.resource_limits().max_instances = kMaxKeys;
  qos.resource_limits().allocated_samples = 4;
  if (profile.every_sample && !state) {
    qos.history().kind = dds::KEEP_ALL_HISTORY_QOS;
    qos.resource_limits().max_samples_per_instance = kUnlimited;
    qos.resource_limits().max_samples = kUnlimited;
  } else {
    qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
    qos.history().depth = depth(profile);
    qos.resource_limits().max_samples_per_instance = depth(profile);
    qos.resource_limits().max_samples = depth(profile) * kMaxKeys;
  }
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
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

void apply_profile(const Profile& profile, dds::DataWriterQos& qos) {
  apply_common(profile, qos);
  qos.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
  // Repeated until acknowledged: in lockstep others wait for what was lost on the way.
  qos.reliable_writer_qos().times.heartbeatPeriod = milliseconds(profile.every_sample ? 5 : 100);
  qos.reliable_writer_qos().times.nackResponseDelay = milliseconds(profile.every_sample ? 0 : 1);
}

void apply_profile(const Profile& profile, dds::DataReaderQos& qos) {
  apply_common(profile, qos);
  qos.reliable_reader_qos().times.heartbeatResponseDelay =
      milliseconds(profile.every_sample ? 0 : 1);
}

}  // namespace palpate::bus
