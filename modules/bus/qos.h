// All of the delivery rules (QoS) in one place, as named profiles: transport, stream, state.
#pragma once

#include <memory>

#include "modules/bus/addresses.h"
#include "modules/bus/hearing.h"
#include "modules/bus/raw_bus.h"

namespace eprosima::fastdds::dds {
class DomainParticipantQos;
class DataWriterQos;
class DataReaderQos;
}  // namespace eprosima::fastdds::dds

namespace palpate::bus {

struct PacketTally;
struct SampleRules;

/// UDP on our own addresses only, through the packet filter, without multicast or shared memory;
/// quick discovery, a lease of a day. To other hosts in chunks that fit their packets.
/// @param rules  for what may pass
/// @param hearing  see filtered()
/// @returns what the filter will have done
std::shared_ptr<PacketTally> apply_transport(const Addresses& addresses, int domain,
                                             const SampleRules& rules,
                                             eprosima::fastdds::dds::DomainParticipantQos& qos,
                                             Hearing hearing = {});

/// stream: best effort, volatile; state: reliable, transient local. Both: newest sample per key (a
/// reader may ask for more), written in the calling thread, no data sharing, memory grows to the
/// largest message seen.
///
/// With every_sample, streams are reliable too, and keep what a reader has not got yet: without
/// bound, so that a stopped reader never blocks a writer; what bounds them is the conductor of the
/// lockstep, who lets nobody run ahead. Late readers of a state get its last kStateDepth samples
/// per key.
struct Profile {
  Delivery delivery;
  Keep keep;  ///< of a reader
  bool every_sample = false;
  bool over_hosts = false;  ///< on ways that lose some
};
inline constexpr int kStateDepth = 1024;
void apply_profile(const Profile& profile, eprosima::fastdds::dds::DataWriterQos& qos);
void apply_profile(const Profile& profile, eprosima::fastdds::dds::DataReaderQos& qos);

}  // namespace palpate::bus
