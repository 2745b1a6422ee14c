#include "modules/bus/listening_socket.h"

#include <fcntl.h>

#include <catch2/catch.hpp>
#include <system_error>
#include <utility>

#include "tests/modules/bus/loopback_socket.h"

namespace palpate::bus {

using testing::free_port;
using testing::LoopbackSocket;

TEST_CASE("listening socket: it is closed with who holds it last, and its port is free again",
          "[bus]") {
  // Oracle: the kernel: a descriptor that is closed has no flags, and a port is given once.
  const std::uint16_t port = free_port();
  int descriptor = -1;
  {
    ListeningSocket first("127.0.0.1", port, 1 << 16);
    descriptor = first.descriptor();
    CHECK(first.room() >= std::size_t{1} << 16);
    const ListeningSocket moved = std::move(first);
    CHECK(moved.descriptor() == descriptor);
    CHECK(::fcntl(descriptor, F_GETFD) == FD_CLOEXEC);
    CHECK_THROWS_AS(ListeningSocket("127.0.0.1", port, 1 << 16), std::system_error);
  }
  CHECK(::fcntl(descriptor, F_GETFD) == -1);
  CHECK_NOTHROW(ListeningSocket("127.0.0.1", port, 1 << 16));
}

TEST_CASE("listening socket: an address of nobody here, and what is none, are told", "[bus]") {
  // Oracle: an address kept for documents (RFC 5737).
  CHECK_THROWS_AS(ListeningSocket("192.0.2.1", free_port(), 1 << 16), std::system_error);
  CHECK_THROWS_AS(ListeningSocket("nowhere", free_port(), 1 << 16), std::system_error);
}

}  // namespace palpate::bus
