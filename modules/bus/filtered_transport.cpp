#include "modules/bus/filtered_transport.h"

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/TransportReceiverInterface.h>
#include <fastrtps/utils/IPLocator.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <vector>

namespace palpate::bus {
namespace {

namespace transport = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;

struct Descriptor : transport::ChainingTransportDescriptor {
  Descriptor(std::shared_ptr<transport::TransportDescriptorInterface> under,
             const SampleRules& sample_rules, std::shared_ptr<PacketTally> packets)
      : ChainingTransportDescriptor(std::move(under)),
        rules(sample_rules),
        tally(std::move(packets)) {}
  transport::TransportInterface* create_transport() const override;

  SampleRules rules;
  std::shared_ptr<PacketTally> tally;
};

class FilteredTransport : public transport::ChainingTransport {
 public:
  explicit FilteredTransport(const Descriptor& descriptor)
      : ChainingTransport(descriptor), descriptor_(descriptor) {}

  transport::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  bool send(rtps::SenderResource* low_level, const rtps::octet* packet, std::uint32_t bytes,
            rtps::LocatorsIterator* begin, rtps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    return low_level->send(packet, bytes, begin, end, timeout);
  }

  void receive(transport::TransportReceiverInterface* next, const rtps::octet* packet,
               std::uint32_t bytes, const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override {
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
  bool known_sender(std::span<const std::uint8_t> packet, const rtps::Locator_t& remote) {
    constexpr std::size_t kPrefixAt = 8;  // in an RTPS header
    GuidPrefix prefix;
    std::copy_n(packet.begin() + kPrefixAt, prefix.size(), prefix.begin());
    PacketSender sender;
    std::memcpy(&sender.address, rtps::IPLocator::getIPv4(remote), sizeof sender.address);
    sender.port = rtps::IPLocator::getPhysicalPort(remote);
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return senders_.admit(prefix, sender, std::chrono::nanoseconds(now).count());
  }

  Descriptor descriptor_;
  PacketSenders senders_;
};

transport::TransportInterface* Descriptor::create_transport() const {
  return new FilteredTransport(*this);
}

}  // namespace

std::shared_ptr<transport::TransportDescriptorInterface> filtered(
    std::shared_ptr<transport::TransportDescriptorInterface> under, const SampleRules& rules,
    std::shared_ptr<PacketTally> tally) {
  return std::make_shared<Descriptor>(std::move(under), rules, std::move(tally));
}

}  // namespace palpate::bus
