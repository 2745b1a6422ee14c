#include "modules/bus/listening_socket.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace palpate::bus {

ListeningSocket::ListeningSocket(const std::string& address, std::uint16_t port, int room)
    : descriptor_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
  const auto check = [&](int result) {
    if (result >= 0) return;
    const int failure = errno;
    if (descriptor_ >= 0) ::close(descriptor_);
    throw std::system_error(failure, std::generic_category(), address);
  };
  check(descriptor_);
  check(::setsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &room, sizeof room));
  int granted = 0;
  socklen_t size = sizeof granted;
  check(::getsockopt(descriptor_, SOL_SOCKET, SO_RCVBUF, &granted, &size));
  room_ = static_cast<std::size_t>(granted);
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(port);
  errno = EINVAL;
  check(::inet_pton(AF_INET, address.c_str(), &at.sin_addr) == 1 ? 0 : -1);
  check(::bind(descriptor_, reinterpret_cast<const sockaddr*>(&at), sizeof at));
}

ListeningSocket::~ListeningSocket() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

}  // namespace palpate::bus
