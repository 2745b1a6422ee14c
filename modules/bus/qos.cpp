#include "modules/bus/qos.h"

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#include <memory>

#include "modules/bus/filtered_transport.h"
#include "modules/core/organ_limits.h"

namespace palpate::bus {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
using eprosima::fastrtps::Duration_t;

constexpr std::uint32_t kMaxDatagramBytes = 65'500;  // larger samples travel in fragments
constexpr std::uint32_t kNanosecondsPerMillisecond = 1'000'000;
constexpr int kUnlimited = -1;
constexpr int kMostInstances = kMaxKeys;
// Participants of a domain on a host: each has the first free ones of so many pairs of ports, for
// that often does 2.9.1 look for them (mutation_tries).
constexpr std::uint32_t kMaxParticipants = 100;

Duration_t milliseconds(std::uint32_t ms) { return {0, ms * kNanosecondsPerMillisecond}; }

// Samples that wait for each key.
int depth(const Profile& profile) {
  if (profile.every_sample) return kStateDepth;
  if (profile.keep == Keep::kLongBacklog) return kLongBacklogDepth;
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
  qos.resource_limits().max_instances = kMostInstances;
  qos.resource_limits().allocated_samples = 4;
  if (profile.every_sample && !state) {
    qos.history().kind = dds::KEEP_ALL_HISTORY_QOS;
    qos.resource_limits().max_samples_per_instance = kUnlimited;
    qos.resource_limits().max_samples = kUnlimited;
  } else {
    qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
    qos.history().depth = depth(profile);
    qos.resource_limits().max_samples_per_instance = depth(profile);
    qos.resource_limits().max_samples = depth(profile) * kMostInstances;
  }
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.data_sharing().off();
}

// A stream of a lockstep on one host.
bool arrives_at_once(const Profile& profile) {
  return profile.every_sample && profile.delivery == Delivery::kStream && !profile.over_hosts;
}

// RTPS 2.5, 9.6.2.4: where the first participant of a domain listens for others, and for users'
// data.
constexpr int kPortBase = 7400, kPortsPerDomain = 250, kDiscoveryPort = 10, kUserPort = 11;

rtps::Locator_t locator(const std::string& address, int port) {
  rtps::Locator_t made;
  rtps::IPLocator::createLocator(LOCATOR_KIND_UDPv4, address, static_cast<std::uint32_t>(port),
                                 made);
  return made;
}

// Each takes the first free ports of its own addresses, whatever its number in its process, and is
// sought at all that it may have taken. What is sent to a multicast group instead comes in from
// every network on which any program of this host has joined it.
void apply_discovery(const Addresses& addresses, int domain, bool hears_only,
                     dds::WireProtocolConfigQos& wire) {
  constexpr int kAnyPort = 0;
  const int first = kPortBase + kPortsPerDomain * domain;
  for (const std::string& own : addresses.own) {
    wire.builtin.metatrafficUnicastLocatorList.push_back(locator(own, first + kDiscoveryPort));
    wire.default_unicast_locator_list.push_back(locator(own, first + kUserPort));
    wire.builtin.initialPeersList.push_back(locator(own, kAnyPort));
  }
  for (const std::string& peer : addresses.peers) {
    wire.builtin.initialPeersList.push_back(locator(peer, kAnyPort));
  }

  // With the defaults one join in five took more than 1.5 s.
  auto& discovery = wire.builtin.discovery_config;
  discovery.initial_announcements.count = 20;
  discovery.initial_announcements.period = milliseconds(50);
  // Each is a hundred packets. Newcomers are answered, and heard by those that they ask.
  discovery.leaseDuration_announcementperiod = milliseconds(hears_only ? 950 : 250);
  // Every remote participant is checked once per lease. A check that meets one just leaving aborts
  // the process (2.9.1: assertion in PDP::check_remote_participant_liveliness; leases of 3 ms show
  // it in seconds): so not while a session lasts. Nobody waits for the lease: a silent process is
  // told by the age of its samples.
  discovery.leaseDuration = {86'400, 0};
}

}  // namespace

std::shared_ptr<PacketTally> apply_transport(const Addresses& addresses, int domain,
                                             const SampleRules& rules,
                                             dds::DomainParticipantQos& qos, Hearing hearing) {
  auto udp = std::make_shared<UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = addresses.own;
  udp->sendBufferSize = kSocketBufferBytes;
  udp->receiveBufferSize = kSocketBufferBytes;
  udp->maxMessageSize = kMaxDatagramBytes;
  udp->maxInitialPeersRange = kMaxParticipants;
  auto tally = std::make_shared<PacketTally>();
  qos.transport().use_builtin_transports = false;
  const bool gathers = hearing.shortcut != nullptr;
  const int samples_port = kPortBase + kPortsPerDomain * domain + kUserPort;
  qos.transport().user_transports.push_back(
      filtered(udp, rules, tally, addresses, std::move(hearing), samples_port));
  apply_discovery(addresses, domain, gathers, qos.wire_protocol());
  qos.allocation().participants = {0, PacketSenders::kMaxParticipants, 1};
  return tally;
}

void apply_profile(const Profile& profile, dds::DataWriterQos& qos) {
  apply_common(profile, qos);
  qos.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
  auto& times = qos.reliable_writer_qos().times;
  // Repeated until acknowledged: in lockstep others wait for what was lost on the way. On one host
  // nothing is, but where a socket's buffer overflows.
  const bool arrives = arrives_at_once(profile);
  const std::uint32_t repeated = profile.over_hosts ? 5 : arrives ? 50 : 20;
  times.heartbeatPeriod = milliseconds(profile.every_sample ? repeated : 100);
  times.nackResponseDelay = milliseconds(profile.every_sample ? 0 : 1);
  // With each sample begins a time in which no reader's complaint of it is heard. If it has no
  // length, as it is unless set, its timer wakes a thread for every sample and reader, that waits
  // for the writer's lock, and the writer for it.
  if (arrives) times.nackSupressionDuration = milliseconds(repeated);
}

// In lockstep a sample said to a host's own is as good as heard, and nobody waits to know it but of
// a state: acknowledged at once, one datagram for each, they were three in four of all datagrams.
void apply_profile(const Profile& profile, dds::DataReaderQos& qos) {
  apply_common(profile, qos);
  const bool at_once = profile.over_hosts || profile.delivery == Delivery::kState;
  qos.reliable_reader_qos().times.heartbeatResponseDelay = milliseconds(!profile.every_sample ? 1
                                                                        : at_once             ? 0
                                                                                              : 5);
}

}  // namespace palpate::bus
