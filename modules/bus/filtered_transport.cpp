#include "modules/bus/filtered_transport.h"

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/TransportReceiverInterface.h>
#include <fastrtps/utils/IPLocator.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <vector>

#include "modules/bus/packet_chunks.h"

namespace palpate::bus {
namespace {

namespace transport = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;

struct Descriptor : transport::ChainingTransportDescriptor {
  Descriptor(std::shared_ptr<transport::TransportDescriptorInterface> under,
             const SampleRules& sample_rules, std::shared_ptr<PacketTally> packets,
             Addresses of_this_host)
      : ChainingTransportDescriptor(std::move(under)),
        rules(sample_rules),
        tally(std::move(packets)),
        addresses(std::move(of_this_host)) {}
  transport::TransportInterface* create_transport() const override;

  SampleRules rules;
  std::shared_ptr<PacketTally> tally;
  Addresses addresses;
};

class FilteredTransport : public transport::ChainingTransport {
 public:
  explicit FilteredTransport(const Descriptor& descriptor)
      : ChainingTransport(descriptor), descriptor_(descriptor) {}

  transport::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  bool send(rtps::SenderResource* low_level, const rtps::octet* packet, std::uint32_t bytes,
            rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    if (bytes <= kChunkBytes || !descriptor_.addresses.over_hosts())
      return low_level->send(packet, bytes, begin, end, timeout);
    const PacketChunks chunks({packet, bytes}, ++chunked_);
    bool sent = true;
    for (rtps::LocatorsIterator& to = *begin; to != *end; ++to) {
      if (is_of_this_host(*to)) {
        sent &= send_to(low_level, {packet, bytes}, *to, timeout);
        continue;
      }
      for (std::size_t i = 0; i < chunks.count(); ++i)
        sent &= send_to(low_level, chunks.at(i), *to, timeout);
    }
    return sent;
  }

  void receive(transport::TransportReceiverInterface* next, const rtps::octet* packet,
               std::uint32_t bytes, const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override {
    std::vector<std::uint8_t> whole;  // takes memory only where it came in chunks
    if (is_chunk({packet, bytes})) {
      if (!chunks_.add({packet, bytes}, sender_of(remote), whole)) return;
      packet = whole.data();
      bytes = static_cast<std::uint32_t>(whole.size());
    }
    std::vector<std::uint8_t>
        kept;  // takes memory only where a packet loses something in its middle
    FilteredPacket filtered = filter_packet({packet, bytes}, descriptor_.rules, kept);
    if (!filtered.packet.empty() && !known_sender(filtered.packet, remote)) {
      filtered = {{}, PacketFault::kIdentity};
    }
    if (filtered.fault != PacketFault::kNone) descriptor_.tally->refuse(filtered.fault);
    if (filtered.packet.empty()) return;
    next->OnDataReceived(filtered.packet.data(), static_cast<std::uint32_t>(filtered.packet.size()),
                         local, remote);
  }

 private:
  static PacketSender sender_of(const rtps::Locator_t& remote) {
    PacketSender sender;
    std::memcpy(&sender.address, rtps::IPLocator::getIPv4(remote), sizeof sender.address);
    sender.port = rtps::IPLocator::getPhysicalPort(remote);
    return sender;
  }

  bool is_of_this_host(const rtps::Locator_t& to) const {
    const std::string address = rtps::IPLocator::toIPv4string(to);
    return address.starts_with("127.") ||
           std::ranges::find(descriptor_.addresses.own, address) != descriptor_.addresses.own.end();
  }

  static bool send_to(rtps::SenderResource* low_level, std::span<const std::uint8_t> packet,
                      const rtps::Locator_t& to,
                      const std::chrono::steady_clock::time_point& timeout) {
    transport::LocatorList one;
    one.push_back(to);
    transport::Locators begin(one.begin()), end(one.end());
    return low_level->send(packet.data(), static_cast<std::uint32_t>(packet.size()), &begin, &end,
                           timeout);
  }

  bool known_sender(std::span<const std::uint8_t> packet, const rtps::Locator_t& remote) {
    constexpr std::size_t kPrefixAt = 8;  // in an RTPS header
    GuidPrefix prefix;
    std::copy_n(packet.begin() + kPrefixAt, prefix.size(), prefix.begin());
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return descriptor_.tally->senders.admit(prefix, sender_of(remote),
                                            std::chrono::nanoseconds(now).count());
  }

  Descriptor descriptor_;
  std::atomic<std::uint32_t> chunked_{0};  ///< packets
  ChunkAssembler chunks_;
};

transport::TransportInterface* Descriptor::create_transport() const {
  return new FilteredTransport(*this);
}

}  // namespace

std::shared_ptr<transport::TransportDescriptorInterface> filtered(
    std::shared_ptr<transport::TransportDescriptorInterface> under, const SampleRules& rules,
    std::shared_ptr<PacketTally> tally, const Addresses& addresses) {
  return std::make_shared<Descriptor>(std::move(under), rules, std::move(tally), addresses);
}

}  // namespace palpate::bus
