#include "palpate/session_claim.h"

#include <spdlog/fmt/fmt.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "modules/core/error.h"

namespace palpate::launcher {

SessionClaim::SessionClaim(const std::string& session, int domain) {
  const std::string name = fmt::format("palpate-{}-{}", domain, session);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  // A first byte of zero makes it abstract. A name too long is cut: two that begin with the same
  // hundred characters count as one.
  const std::size_t length = std::min(name.size(), sizeof address.sun_path - 1);
  std::memcpy(address.sun_path + 1, name.data(), length);
  socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  if (socket_ >= 0 && ::bind(socket_, reinterpret_cast<const sockaddr*>(&address), size) == 0) {
    return;
  }
  const int failure = errno;
  if (socket_ >= 0) ::close(socket_);
  if (failure == EADDRINUSE) {
    throw InputError(fmt::format(
        "session '{}' already runs here: end it, give this one another --session, or join with "
        "--only MODULE",
        session));
  }
  throw std::runtime_error(fmt::format("session '{}': {}", session, std::strerror(failure)));
}

SessionClaim::~SessionClaim() { ::close(socket_); }

}  // namespace palpate::launcher
