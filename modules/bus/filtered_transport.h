// A transport whose packets pass the filter before the DDS library reads them.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "modules/bus/addresses.h"
#include "modules/bus/packet_filter.h"
#include "modules/bus/packet_senders.h"

namespace eprosima::fastdds::rtps {
struct TransportDescriptorInterface;
}

namespace palpate::bus {

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
std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> filtered(
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> under,
    const SampleRules& rules, std::shared_ptr<PacketTally> tally, const Addresses& addresses);

}  // namespace palpate::bus
