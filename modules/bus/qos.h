// All of the delivery rules (QoS) in one place, as named profiles: transport, stream, state.
#pragma once

#include <string>
#include <vector>

#include "modules/bus/topics.h"

namespace eprosima::fastdds::dds {
class DomainParticipantQos;
class DataWriterQos;
class DataReaderQos;
}  // namespace eprosima::fastdds::dds

namespace palpate::bus {

/// Keys (organs, probes, modules) a topic may carry at a time.
inline constexpr int kMaxKeys = 256;

/// UDP on these interfaces only, no shared memory; quick discovery, a lease of a day.
void apply_transport(const std::vector<std::string>& interfaces,
                     eprosima::fastdds::dds::DomainParticipantQos& qos);

/// stream: best effort, volatile; state: reliable, transient local. Both: newest sample per key,
/// written in the calling thread, no data sharing, memory grows to the largest message seen.
void apply_profile(Delivery delivery, eprosima::fastdds::dds::DataWriterQos& qos);
void apply_profile(Delivery delivery, eprosima::fastdds::dds::DataReaderQos& qos);

}  // namespace palpate::bus
