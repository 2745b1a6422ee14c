#include "modules/bus/polled_sockets.h"

#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "modules/core/units.h"

namespace palpate::bus {

void PolledSockets::open(const std::vector<std::string>& addresses, std::uint16_t port, int room,
                         Take take) {
  Channel channel{port, {}, std::move(take)};
  for (const std::string& address : addresses) channel.sockets.emplace_back(address, port, room);
  channels_.push_back(std::move(channel));
}

bool PolledSockets::is_open(std::uint16_t port) const {
  return std::ranges::find(channels_, port, &Channel::port) != channels_.end();
}

bool PolledSockets::close(std::uint16_t port) {
  return std::erase_if(channels_, [&](const Channel& c) { return c.port == port; }) > 0;
}

bool PolledSockets::hear(double longest) {
  if (drain()) return true;
  if (longest <= 0) return false;
  std::vector<pollfd> waited;
  for (const Channel& channel : channels_) {
    for (const ListeningSocket& socket : channel.sockets) {
      waited.push_back({socket.descriptor(), POLLIN, 0});
    }
  }
  const std::int64_t ns = ns_from_seconds(longest);
  const timespec time{ns / kNanosecondsPerSecond, ns % kNanosecondsPerSecond};
  return ::ppoll(waited.data(), waited.size(), &time, nullptr) > 0 && drain();
}

bool PolledSockets::drain() {
  bool any = false;
  for (const Channel& channel : channels_) {
    for (const ListeningSocket& socket : channel.sockets) any |= drain(socket, channel.take);
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
