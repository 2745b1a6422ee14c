// A DDS domain for each test process.
#pragma once

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <string>

namespace palpate::testing {

/// One of 90 domains from `first` on that no other test process has; until this one ends it holds
/// a socket of that name (tests/python/live_test.py does the same). What one sends in a flood, as
/// tests do, would be refused and counted in another's session.
inline int own_domain(int first) {
  constexpr int kCount = 90;
  static int domain = -1;
  for (int k = 0; k < kCount && domain < 0; ++k) {
    const int tried = first + (getpid() + k) % kCount;
    const std::string name = "palpate-test-domain-" + std::to_string(tried);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    name.copy(address.sun_path + 1, name.size());  // in no folder, gone with the process
    const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
    const int held = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (bind(held, reinterpret_cast<const sockaddr*>(&address), length) == 0) {
      domain = tried;
    } else {
      close(held);
    }
  }
  return domain < 0 ? first + getpid() % kCount : domain;
}

}  // namespace palpate::testing
