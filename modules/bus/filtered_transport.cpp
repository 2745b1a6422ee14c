#include "modules/bus/filtered_transport.h"

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/TransportReceiverInterface.h>
#include <fastrtps/utils/IPLocator.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <system_error>
#include <vector>

#include "modules/bus/clock_ns.h"
#include "modules/bus/packet_chunks.h"
#include "modules/bus/packet_gatherer.h"
#include "modules/bus/packet_stamp.h"
#include "modules/bus/polled_sockets.h"
#include "modules/bus/rtps_words.h"
#include "modules/bus/sample_shortcut.h"

namespace palpate::bus {
namespace {

namespace transport = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;

struct Descriptor : transport::ChainingTransportDescriptor {
  Descriptor(std::shared_ptr<transport::TransportDescriptorInterface> under,
             const SampleRules& sample_rules, std::shared_ptr<PacketTally> packets,
             Addresses of_this_host, Hearing heard, int first_port)
      : ChainingTransportDescriptor(std::move(under)),
        rules(sample_rules),
        tally(std::move(packets)),
        addresses(std::move(of_this_host)),
        hearing(std::move(heard)),
        samples_port(first_port) {}
  transport::TransportInterface* create_transport() const override;

  SampleRules rules;
  std::shared_ptr<PacketTally> tally;
  Addresses addresses;
  Hearing hearing;
  int samples_port;
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

  // A channel of samples may not be that of the transport below, but in its place.

  bool IsInputChannelOpen(const rtps::Locator_t& at) const override {
    if (!is_own(at)) return ChainingTransport::IsInputChannelOpen(at);
    const std::uint16_t port = rtps::IPLocator::getPhysicalPort(at);
    if (descriptor_.hearing.polled) return descriptor_.hearing.polled->is_open(port);
    const std::lock_guard lock(channels_mutex_);
    return channels_.contains(port);
  }
  bool OpenInputChannel(const rtps::Locator_t& at, transport::TransportReceiverInterface* next,
                        std::uint32_t most_bytes) override {
    if (!is_own(at)) return ChainingTransport::OpenInputChannel(at, next, most_bytes);
    return is_locator_allowed(at) && open(at, next);
  }
  bool CloseInputChannel(const rtps::Locator_t& at) override {
    if (!is_own(at)) return ChainingTransport::CloseInputChannel(at);
    const std::uint16_t port = rtps::IPLocator::getPhysicalPort(at);
    if (descriptor_.hearing.polled) return descriptor_.hearing.polled->close(port);
    decltype(channels_)::node_type closed;  // ends its thread, which may be waiting for the lock
    const std::lock_guard lock(channels_mutex_);
    closed = channels_.extract(port);
    return !closed.empty();
  }

  void receive(transport::TransportReceiverInterface* next, const rtps::octet* packet,
               std::uint32_t bytes, const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override {
    std::vector<std::uint8_t> whole;  // takes memory only where it came in chunks
    if (!is_chunk({packet, bytes})) {
      hear(next, {packet, bytes}, local, remote);
    } else if (chunks_.add({packet, bytes}, sender_of(remote), whole)) {
      hear(next, whole, local, remote);
    }
  }

 private:
  bool is_own(const rtps::Locator_t& at) const {
    const int beyond = rtps::IPLocator::getPhysicalPort(at) - descriptor_.samples_port;
    return !descriptor_.hearing.by_library() && beyond >= 0 && beyond % 2 == 0;
  }

  /// @param arrived_ns  of a gathered packet, by the monotonic clock
  void hear(transport::TransportReceiverInterface* next, std::span<const std::uint8_t> packet,
            const rtps::Locator_t& local, const rtps::Locator_t& remote,
            std::optional<std::int64_t> arrived_ns = {}) {
    std::vector<std::uint8_t>
        kept;  // takes memory only where a packet loses something in its middle
    FilteredPacket filtered = filter_packet(packet, descriptor_.rules, kept);
    if (!filtered.packet.empty() && !known_sender(filtered.packet, remote)) {
      filtered = {{}, PacketFault::kIdentity};
    }
    if (filtered.fault != PacketFault::kNone) descriptor_.tally->refuse(filtered.fault);
    if (filtered.packet.empty()) return;
    if (arrived_ns && descriptor_.hearing.shortcut->take(filtered.packet, *arrived_ns)) return;
    next->OnDataReceived(filtered.packet.data(), static_cast<std::uint32_t>(filtered.packet.size()),
                         local, remote);
  }

  /// False if the port is taken: the library asks for another one.
  bool open(const rtps::Locator_t& at, transport::TransportReceiverInterface* next) {
    try {
      if (descriptor_.hearing.polled) {
        open_polled(at, next);
      } else {
        gather(at, next);
      }
      return true;
    } catch (const std::system_error&) {
      return false;
    }
  }

  void open_polled(const rtps::Locator_t& at, transport::TransportReceiverInterface* next) {
    const auto take = [this, next, at](std::span<const std::uint8_t> packet,
                                       const PacketSender& sender) {
      hear(next, packet, at, locator_of(sender));
    };
    descriptor_.hearing.polled->open(
        descriptor_.addresses.own, rtps::IPLocator::getPhysicalPort(at), kSocketBufferBytes, take);
  }

  void gather(const rtps::Locator_t& at, transport::TransportReceiverInterface* next) {
    const std::uint16_t port = rtps::IPLocator::getPhysicalPort(at);
    const auto take = [this, next, at](const ArrivedPacket& packet) {
      stamp_arrival(packet.bytes, packet.by_wall_ns);
      hear(next, packet.bytes, at, locator_of(packet.sender), packet.arrived_ns);
    };
    const std::lock_guard lock(channels_mutex_);
    channels_[port] =
        std::make_unique<PacketGatherer>(descriptor_.addresses.own, port, kSocketBufferBytes, take);
  }

  static rtps::Locator_t locator_of(const PacketSender& sender) {
    rtps::Locator_t from;
    from.kind = LOCATOR_KIND_UDPv4;
    rtps::IPLocator::setIPv4(from, reinterpret_cast<const rtps::octet*>(&sender.address));
    rtps::IPLocator::setPhysicalPort(from, sender.port);
    return from;
  }

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
    GuidPrefix prefix;
    std::copy_n(packet.begin() + kPrefixAt, prefix.size(), prefix.begin());
    return descriptor_.tally->senders.admit(prefix, sender_of(remote), monotonic_ns());
  }

  Descriptor descriptor_;
  std::atomic<std::uint32_t> chunked_{0};  ///< packets
  ChunkAssembler chunks_;
  mutable std::mutex channels_mutex_;
  std::map<std::uint16_t, std::unique_ptr<PacketGatherer>> channels_;  ///< by port
};

transport::TransportInterface* Descriptor::create_transport() const {
  return new FilteredTransport(*this);
}

}  // namespace

std::shared_ptr<transport::TransportDescriptorInterface> filtered(
    std::shared_ptr<transport::TransportDescriptorInterface> under, const SampleRules& rules,
    std::shared_ptr<PacketTally> tally, const Addresses& addresses, Hearing hearing,
    int samples_port) {
  return std::make_shared<Descriptor>(std::move(under), rules, std::move(tally), addresses,
                                      std::move(hearing), samples_port);
}

}  // namespace palpate::bus
