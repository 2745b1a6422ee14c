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
namespace {

/// Binds an abstract socket. @returns it; -1 if another program has the name
int claimed(const std::string& name) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  // A first byte of zero makes it abstract. A name too long is cut: two that begin with the same
  // hundred characters count as one.
  const std::size_t length = std::min(name.size(), sizeof address.sun_path - 1);
  std::memcpy(address.sun_path + 1, name.data(), length);
  const int socket = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  if (socket >= 0 && ::bind(socket, reinterpret_cast<const sockaddr*>(&address), size) == 0)
    return socket;
  const int failure = errno;
  if (socket >= 0) ::close(socket);
  if (failure == EADDRINUSE) return -1;
  throw std::runtime_error(fmt::format("{}: {}", name, std::strerror(failure)));
}

bool may_be_several(const std::string& module) {
  return module == "visualizer" || module == "recorder";
}

/// The module first: a name may be cut.
std::string claim_name(const std::string& session, int domain, const std::string& module) {
  return fmt::format("palpate-{}-{}-{}", module, domain, session);
}

[[noreturn]] void refuse_module(const std::string& session, const std::string& module) {
  throw InputError(
      fmt::format("session '{}' has {} here already: end that, give this one another --session, "
                  "or join with --only and what it lacks",
                  session, module));
}

}  // namespace

SessionClaim::SessionClaim(const std::string& session, int domain,
                           const std::vector<std::string>& modules)
    : SessionClaim() {  // so that it is given back where the modules are not free
  const int socket = claimed(fmt::format("palpate-{}-{}", domain, session));
  if (socket < 0) {
    throw InputError(fmt::format(
        "session '{}' already runs here: end it, give this one another --session, or join with "
        "--only MODULE",
        session));
  }
  sockets_[""] = socket;
  sockets_.merge(joining(session, domain, modules).sockets_);
}

SessionClaim SessionClaim::joining(const std::string& session, int domain,
                                   const std::vector<std::string>& modules) {
  SessionClaim claim;
  for (const auto& module : modules) {
    if (may_be_several(module)) continue;
    const int socket = claimed(claim_name(session, domain, module));
    if (socket < 0) refuse_module(session, module);
    claim.sockets_[module] = socket;
  }
  return claim;
}

void SessionClaim::release(const std::string& module) {
  const auto known = sockets_.find(module);
  if (known == sockets_.end()) return;
  ::close(known->second);
  sockets_.erase(known);
}

SessionClaim::~SessionClaim() {
  for (const auto& [module, socket] : sockets_) ::close(socket);
}

}  // namespace palpate::launcher
