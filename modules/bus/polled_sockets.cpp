#include "modules/bus/polled_sockets.h"

#include <netinet/in.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <system_error>
#include <utility>

namespace palpate::bus {

PolledSockets::PolledSockets() : ready_(::epoll_create1(EPOLL_CLOEXEC)) {
  if (ready_ < 0) throw std::system_error(errno, std::generic_category(), "epoll_create1");
}

PolledSockets::~PolledSockets() { ::close(ready_); }

void PolledSockets::open(const std::vector<std::string>& addresses, std::uint16_t port, int room,
                         Take take) {
  Channel channel{port, {}, std::move(take)};
  for (const std::string& address : addresses) {
    const int socket = channel.sockets.emplace_back(address, port, room).descriptor();
    epoll_event event{EPOLLIN, {.fd = socket}};
    if (::epoll_ctl(ready_, EPOLL_CTL_ADD, socket, &event) != 0) {
      throw std::system_error(errno, std::generic_category(), address);
    }
  }
  channels_.push_back(std::move(channel));
}

bool PolledSockets::is_open(std::uint16_t port) const {
  return std::ranges::find(channels_, port, &Channel::port) != channels_.end();
}

// A socket that is closed leaves the set by itself.
bool PolledSockets::close(std::uint16_t port) {
  return std::erase_if(channels_, [&](const Channel& c) { return c.port == port; }) > 0;
}

// To ask each socket for a packet would cost as many calls as there are sockets, nearly all in
// vain.
bool PolledSockets::hear(double longest) {
  epoll_event events[kMostReady];
  const int ms = static_cast<int>(std::ceil(std::max(longest, 0.0) * 1e3));
  const int count = ::epoll_wait(ready_, events, kMostReady, ms);
  bool any = false;
  for (int i = 0; i < count; ++i) any |= drain(events[i].data.fd);
  return any;
}

bool PolledSockets::drain(int descriptor) {
  for (const Channel& channel : channels_) {
    for (const ListeningSocket& socket : channel.sockets) {
      if (socket.descriptor() == descriptor) return drain(socket, channel.take);
    }
  }
  return false;
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
