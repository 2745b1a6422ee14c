#include "modules/runtime/name_claim.h"

#include <spdlog/fmt/fmt.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "modules/core/error.h"
#include "modules/core/stop_signal.h"
#include "modules/core/units.h"
#include "modules/runtime/clock.h"

namespace palpate::runtime {
namespace {

constexpr useconds_t kLookAgainUs = 10'000;

struct AbstractAddress {
  sockaddr_un address{};
  socklen_t size = 0;

  explicit AbstractAddress(const std::string& name) {
    address.sun_family = AF_UNIX;
    // A first byte of zero makes it abstract.
    const std::size_t length = std::min(name.size(), sizeof address.sun_path - 1);
    std::memcpy(address.sun_path + 1, name.data(), length);
    size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  }
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&address); }
};

int stream_socket() { return ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0); }

}  // namespace

std::optional<NameClaim> NameClaim::take(const std::string& name) {
  const AbstractAddress address(name);
  const int socket = stream_socket();
  // It listens so that whoever asks is told the process; nobody is answered.
  if (socket >= 0 && ::bind(socket, address.get(), address.size) == 0 && ::listen(socket, 8) == 0) {
    return NameClaim(socket);
  }
  const int failure = errno;
  if (socket >= 0) ::close(socket);
  if (failure == EADDRINUSE) return std::nullopt;
  throw std::runtime_error(fmt::format("{}: {}", name, std::strerror(failure)));
}

pid_t NameClaim::holder(const std::string& name) {
  const AbstractAddress address(name);
  const int socket = stream_socket();
  if (socket < 0) return 0;
  ucred other{};
  socklen_t size = sizeof other;
  const bool told = ::connect(socket, address.get(), address.size) == 0 &&
                    ::getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &other, &size) == 0;
  ::close(socket);
  return told ? other.pid : 0;
}

NameClaim::NameClaim(NameClaim&& other) noexcept : socket_(std::exchange(other.socket_, -1)) {}

NameClaim& NameClaim::operator=(NameClaim&& other) noexcept {
  std::swap(socket_, other.socket_);
  return *this;
}

NameClaim::~NameClaim() {
  if (socket_ >= 0) ::close(socket_);
}

bool may_be_several(std::string_view module) {
  return module == "visualizer" || module == "recorder";
}

std::string process_name(const bus::BusOptions& session, const std::string& module) {
  // The module first: a name may be cut. Users do not keep each other's sessions from starting.
  return fmt::format("palpate-process-{}-{}-{}-{}", module, ::getuid(), session.domain,
                     session.session);
}

std::optional<NameClaim> claim_module(const bus::BusOptions& session, const std::string& module) {
  if (may_be_several(module)) return std::nullopt;
  const std::string name = process_name(session, module);
  const std::int64_t until = monotonic_now_ns() + ns_from_seconds(kPredecessorEndsWithin);
  while (true) {
    if (auto claim = NameClaim::take(name)) return claim;
    if (monotonic_now_ns() >= until) break;
    if (stop_requested()) throw Interrupted("stopped while another " + module + " was there");
    ::usleep(kLookAgainUs);
  }
  const pid_t holder = NameClaim::holder(name);
  throw InputError(fmt::format(
      "session '{}' has {} here already{}: end that, give this one another --session, or join with "
      "--only and what it lacks",
      session.session, module, holder > 0 ? fmt::format(", process {}", holder) : ""));
}

}  // namespace palpate::runtime
