#include "modules/bus/polled_sockets.h"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <utility>

#include "modules/core/units.h"

namespace palpate::bus {

void PolledSockets::open(const std::vector<std::string>& addresses, std::uint16_t port, int room,
                         Take take) {
  Channel channel{port, {}, std::move(take)};
  for (const std::string& address : addresses) channel.sockets.emplace_back(address, port, room);
  channels_.push_back(std::move(channel));
  list();
}

bool PolledSockets::is_open(std::uint16_t port) const {
  return std::ranges::find(channels_, port, &Channel::port) != channels_.end();
}

bool PolledSockets::close(std::uint16_t port) {
  const bool closed =
      std::erase_if(channels_, [&](const Channel& c) { return c.port == port; }) > 0;
  list();
  return closed;
}

void PolledSockets::list() {
  polled_.clear();
  for (const Channel& channel : channels_) {
    for (const ListeningSocket& socket : channel.sockets) {
      polled_.push_back({socket.descriptor(), POLLIN, 0});
    }
  }
}

// To ask each socket for a packet would cost as many calls as there are sockets, nearly all in vain.
bool PolledSockets::hear(double longest) {
  const std::int64_t ns = ns_from_seconds(std::max(longest, 0.0));
  const timespec time{ns / kNanosecondsPerSecond, ns % kNanosecondsPerSecond};
  if (::ppoll(polled_.data(), polled_.size(), &time, nullptr) <= 0) return false;
  bool any = false;
  std::size_t place = 0;
  for (const Channel& channel : channels_) {
    for (const ListeningSocket& socket : channel.sockets) {
      if (polled_[place++].revents != 0) any |= drain(socket, channel.take);
    }
  }
  return any;
}

bool PolledSockets::drain(const ListeningSocket& socket, const Take& take) {
  int count = 0;
  for (; count < kMostAtOnce; ++count) {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t bytes = ::recvfrom(socket.descriptor(), packet_.get(), kMostPacketBytes,
                                     MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&from), &size);
    if (bytes < 0) break;
    take({packet_.get(), static_cast<std::size_t>(bytes)},
         {from.sin_addr.s_addr, ntohs(from.sin_port)});
  }
  return count > 0;
}

}  // namespace palpate::bus
