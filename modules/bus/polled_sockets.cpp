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
                         const Take& take) {
  std::vector<ListeningSocket> sockets;
  sockets.reserve(addresses.size());
  for (const std::string& address : addresses) sockets.emplace_back(address, port, room);
  const std::vector<ListeningSocket>& opened = channels_[port] = std::move(sockets);
  try {
    for (const ListeningSocket& socket : opened) {
      const int descriptor = socket.descriptor();
      watch(descriptor, [this, descriptor, take] { return drain(descriptor, take); });
    }
  } catch (const std::system_error&) {
    close(port);
    throw;
  }
}

bool PolledSockets::is_open(std::uint16_t port) const { return channels_.contains(port); }

bool PolledSockets::close(std::uint16_t port) {
  const auto known = channels_.find(port);
  if (known == channels_.end()) return false;
  for (const ListeningSocket& socket : known->second) forget(socket.descriptor());
  channels_.erase(known);
  return true;
}

void PolledSockets::watch(int descriptor, Serve serve) {
  epoll_event event{EPOLLIN, {.fd = descriptor}};
  if (::epoll_ctl(ready_, EPOLL_CTL_ADD, descriptor, &event) != 0) {
    throw std::system_error(errno, std::generic_category(), "epoll_ctl");
  }
  served_[descriptor] = std::make_shared<Serve>(std::move(serve));
}

void PolledSockets::await_room(int descriptor, bool awaited) {
  epoll_event event{EPOLLIN | (awaited ? std::uint32_t{EPOLLOUT} : 0), {.fd = descriptor}};
  ::epoll_ctl(ready_, EPOLL_CTL_MOD, descriptor, &event);
}

void PolledSockets::forget(int descriptor) {
  ::epoll_ctl(ready_, EPOLL_CTL_DEL, descriptor, nullptr);
  served_.erase(descriptor);
}

// To ask each socket for a packet would cost as many calls as there are sockets, nearly all in
// vain.
bool PolledSockets::hear(double longest) {
  epoll_event events[kMostReady];
  const int ms = static_cast<int>(std::ceil(std::max(longest, 0.0) * 1e3));
  const int count = ::epoll_wait(ready_, events, kMostReady, ms);
  bool any = false;
  for (int i = 0; i < count; ++i) {
    // What was served before may have ended it.
    const auto known = served_.find(events[i].data.fd);
    if (known == served_.end()) continue;
    const std::shared_ptr<Serve> serve = known->second;
    any |= (*serve)();
  }
  return any;
}

bool PolledSockets::drain(int descriptor, const Take& take) {
  int count = 0;
  for (; count < kMostAtOnce; ++count) {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t bytes = ::recvfrom(descriptor, packet_.get(), kMostPacketBytes, MSG_DONTWAIT,
                                     reinterpret_cast<sockaddr*>(&from), &size);
    if (bytes < 0) break;
    take({packet_.get(), static_cast<std::size_t>(bytes)},
         {from.sin_addr.s_addr, ntohs(from.sin_port)});
  }
  return count > 0;
}

}  // namespace palpate::bus
