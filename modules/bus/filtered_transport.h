// A transport whose packets pass the filter before the DDS library reads them.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "modules/bus/addresses.h"
#include "modules/bus/hearing.h"
#include "modules/bus/packet_filter.h"
#include "modules/bus/packet_senders.h"

namespace eprosima::fastdds::rtps {
struct TransportDescriptorInterface;
}

namespace palpate::bus {

/// Asked for of the system; a message of 19 000 nodes is 234 KB.
inline constexpr std::uint32_t kSocketBufferBytes = 4u << 20;

/// What a participant's filter did, and whom it heard. Written by its receiving threads, and by who
/// takes samples.
struct PacketTally {
  std::atomic<std::uint64_t> refused{0};  ///< packets with a fault
  std::atomic<PacketFault> last{PacketFault::kNone};
  PacketSenders senders;

  void refuse(PacketFault fault) {
    last = fault;
    ++refused;
  }
};

/// Describes a filter over the transport that `under` describes. What goes to other hosts, or comes
/// from there, and is larger than a packet of theirs, travels in chunks (packet_chunks.h).
/// @param rules  for what may pass
/// @param hearing  of a process of one host
/// @param samples_port  the first one for samples; of a domain's others every second
std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> filtered(
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> under,
    const SampleRules& rules, std::shared_ptr<PacketTally> tally, const Addresses& addresses,
    Hearing hearing = {}, int samples_port = 0);

}  // namespace palpate::bus
