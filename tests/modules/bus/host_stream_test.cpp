#include "modules/bus/host_stream.h"

#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <catch2/catch.hpp>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <memory>
#include <system_error>

#include "tests/modules/waiting.h"

namespace palpate::bus {
namespace {

using palpate::testing::kDeadline;
using palpate::testing::wait_until;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint64_t kOwnToken = 0x0123456789abcdef;

std::string own_stream_name() {
  static std::atomic<int> count{0};
  return "palpate-test/" + std::to_string(::getpid()) + "/" + std::to_string(++count);
}

Bytes numbered(std::uint32_t number, std::size_t size) {
  Bytes bytes(size, static_cast<std::uint8_t>(number));
  if (size > 0) std::memcpy(bytes.data(), &number, std::min(size, sizeof number));
  return bytes;
}

WriterId writer_id(std::uint8_t last) {
  WriterId id{};
  id.back() = last;
  return id;
}

struct StreamWriter {
  explicit StreamWriter(std::uint64_t token = kOwnToken)
      : name(own_stream_name()), stream(sockets, name, token) {}
  std::string name;
  PolledSockets sockets;
  HostStreamWriter stream;
};

struct StreamReader {
  explicit StreamReader(std::uint64_t token = kOwnToken) : stream(sockets, token) {}
  /// Whether both ends know of each other.
  bool connect(StreamWriter& writer, std::uint8_t id = 1, int readers = 1, int writers = 1) {
    stream.meet(writer_id(id), writer.name);
    return wait_until([&] {
      const bool known = writer.stream.matched_readers() == readers;
      return stream.matched_writers() == writers && known;
    });
  }
  /// The next, while the writer waits for its going.
  Bytes next(StreamWriter& writer) {
    RawSample sample;
    const bool came = wait_until([&] {
      writer.stream.wait_until_received(0.001);
      return stream.take(sample);
    });
    REQUIRE(came);
    last = sample.writer;
    return sample.payload;
  }
  PolledSockets sockets;
  HostStreamReader stream;
  WriterId last{};
};

sockaddr_un raw_address(const std::string& name) {
  sockaddr_un at{};
  at.sun_family = AF_UNIX;
  std::memcpy(at.sun_path + 1, name.data(), name.size());
  return at;
}
socklen_t raw_size(const std::string& name) {
  return static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
}

/// A connection of nobody that follows the rules.
struct RawClient {
  explicit RawClient(const std::string& name)
      : socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const sockaddr_un at = raw_address(name);
    connected = ::connect(socket, reinterpret_cast<const sockaddr*>(&at), raw_size(name)) == 0;
  }
  ~RawClient() { ::close(socket); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;
  void send(const Bytes& bytes) const { ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL); }
  /// Whether the other end has closed it, once the writer has looked.
  bool is_closed(StreamWriter& writer) const {
    return wait_until([&] {
      writer.stream.matched_readers();
      Bytes any(64);
      return ::recv(socket, any.data(), any.size(), MSG_DONTWAIT) == 0;
    });
  }
  int socket;
  bool connected = false;
};

/// While it is there the system gives this process no descriptor.
class NoDescriptors {
 public:
  NoDescriptors() {
    ::getrlimit(RLIMIT_NOFILE, &before_);
    const rlimit none{0, before_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &none);
  }
  ~NoDescriptors() { ::setrlimit(RLIMIT_NOFILE, &before_); }
  NoDescriptors(const NoDescriptors&) = delete;
  NoDescriptors& operator=(const NoDescriptors&) = delete;

 private:
  rlimit before_{};
};

/// Listens, and does no more by itself.
struct RawServer {
  explicit RawServer(int places) {
    const sockaddr_un at = raw_address(name);
    REQUIRE(::bind(listening.descriptor(), reinterpret_cast<const sockaddr*>(&at),
                   raw_size(name)) == 0);
    REQUIRE(::listen(listening.descriptor(), places) == 0);
  }
  std::string name = own_stream_name();
  HostSocket listening{::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)};
};

Bytes token_bytes(std::uint64_t token) {
  Bytes bytes(sizeof token);
  std::memcpy(bytes.data(), &token, sizeof token);
  return bytes;
}

}  // namespace

TEST_CASE("host stream: samples arrive whole and in order, whatever their size, with their writer",
          "[bus]") {
  // Oracle: the bytes written, by two writers in turns, none, one and three megabytes among them.
  StreamWriter first, second;
  StreamReader reader;
  REQUIRE(reader.connect(first, 1));
  REQUIRE(reader.connect(second, 2, 1, 2));
  const std::size_t sizes[] = {0, 1, 4, 5, 100, 65'536, 262'140, 262'144, 3'000'000, 7};
  std::uint32_t number = 0;
  for (const std::size_t size : sizes) {
    for (auto* writer : {&first, &second}) {
      const Bytes sent = numbered(++number, size);
      REQUIRE(writer->stream.write(sent));
      CHECK(reader.next(*writer) == sent);
      CHECK(reader.last == writer_id(writer == &first ? 1 : 2));
    }
  }
  for (number = 0; number < 1000; ++number) REQUIRE(first.stream.write(numbered(number, 100)));
  for (number = 0; number < 1000; ++number) CHECK(reader.next(first) == numbered(number, 100));
  RawSample none;
  CHECK_FALSE(reader.stream.take(none));
}

TEST_CASE("host stream: a reader that hears nothing blocks nobody, and gets all when it hears",
          "[bus]") {
  // Oracle: 40 samples of a megabyte, beside which another reader gets its own at once.
  StreamWriter writer;
  StreamReader stopped, other;
  REQUIRE(stopped.connect(writer));
  REQUIRE(other.connect(writer, 1, 2));
  constexpr std::uint32_t kSamples = 40;
  for (std::uint32_t k = 0; k < kSamples; ++k) {
    REQUIRE(writer.stream.write(numbered(k, 1u << 20)));
    CHECK(other.next(writer) == numbered(k, 1u << 20));
  }
  CHECK_FALSE(writer.stream.wait_until_received(0.01));
  for (std::uint32_t k = 0; k < kSamples; ++k) CHECK(stopped.next(writer) == numbered(k, 1u << 20));
  CHECK(writer.stream.wait_until_received(kDeadline));
}

TEST_CASE("host stream: who waits is woken by a sample, and else waits until time is up", "[bus]") {
  // Oracle: what wait() says.
  StreamWriter writer;
  StreamReader reader;
  REQUIRE(reader.connect(writer));
  CHECK_FALSE(reader.stream.wait(0.01));
  REQUIRE(writer.stream.write(numbered(1, 10)));
  CHECK(reader.stream.wait(kDeadline));
  CHECK(reader.stream.wait(0));  // it is still there
  CHECK(reader.next(writer) == numbered(1, 10));
}

TEST_CASE("host stream: another session's ends are none of this one's", "[bus]") {
  // Oracle: counts of both ends, where one token is another; nothing is handed on.
  for (const auto& [ours, theirs] :
       {std::pair{kOwnToken, kOwnToken + 1}, {kOwnToken - 1, kOwnToken}}) {
    StreamWriter writer(ours);
    StreamReader stranger(theirs), own(ours);
    stranger.stream.meet(writer_id(1), writer.name);
    REQUIRE(own.connect(writer));
    REQUIRE(writer.stream.write(numbered(1, 10)));
    CHECK(own.next(writer) == numbered(1, 10));
    RawSample none;
    stranger.stream.wait(0.01);
    CHECK_FALSE(stranger.stream.take(none));
    CHECK(stranger.stream.matched_writers() == 0);
    CHECK(writer.stream.matched_readers() == 1);
  }
}

TEST_CASE("host stream: ends that leave are counted no more, and what was written is still read",
          "[bus]") {
  // Oracle: counts, and the samples of a writer that has ended.
  StreamReader reader;
  {
    StreamWriter writer;
    REQUIRE(reader.connect(writer));
    {
      StreamReader brief;
      REQUIRE(brief.connect(writer, 1, 2));
    }
    CHECK(wait_until([&] { return writer.stream.matched_readers() == 1; }));
    CHECK(writer.stream.has_readers());
    for (std::uint32_t k = 0; k < 3; ++k) REQUIRE(writer.stream.write(numbered(k, 1000)));
    REQUIRE(writer.stream.wait_until_received(kDeadline));
  }
  RawSample sample;
  for (std::uint32_t k = 0; k < 3; ++k) {
    REQUIRE(wait_until([&] { return reader.stream.take(sample); }));
    CHECK(sample.payload == numbered(k, 1000));
  }
  CHECK(wait_until([&] { return reader.stream.matched_writers() == 0; }));
  CHECK_FALSE(reader.stream.take(sample));
}

TEST_CASE("host stream: a writer is asked once, and one that has left not at all", "[bus]") {
  // Oracle: counts.
  StreamWriter writer;
  StreamReader reader;
  reader.stream.meet(writer_id(9), own_stream_name());
  REQUIRE(reader.connect(writer));
  REQUIRE(reader.connect(writer));
  REQUIRE(writer.stream.write(numbered(1, 10)));
  CHECK(reader.next(writer) == numbered(1, 10));
  RawSample none;
  CHECK_FALSE(reader.stream.wait(0.01));
  CHECK_FALSE(reader.stream.take(none));
}

TEST_CASE("host stream: a name that is taken is told", "[bus]") {
  // Oracle: the second of two of one name.
  StreamWriter writer;
  PolledSockets sockets;
  CHECK_THROWS_AS(HostStreamWriter(sockets, writer.name, kOwnToken), std::system_error);
}

TEST_CASE("host stream: who asks and does not keep the rules is sent away, and harms nobody",
          "[bus]") {
  // Oracle: connections closed, and a sample that arrives behind them all. A greeting may come in
  // parts.
  StreamWriter writer;
  StreamReader reader;
  REQUIRE(reader.connect(writer));
  const RawClient wrong(writer.name), talks(writer.name), silent(writer.name),
      in_parts(writer.name);
  REQUIRE((wrong.connected && talks.connected && silent.connected && in_parts.connected));
  wrong.send(token_bytes(kOwnToken + 1));
  Bytes more = token_bytes(kOwnToken);
  more.push_back(0);
  talks.send(more);
  for (const std::uint8_t byte : token_bytes(kOwnToken)) {
    writer.stream.matched_readers();
    in_parts.send({byte});
  }
  CHECK(wait_until([&] { return writer.stream.matched_readers() == 2; }));
  CHECK(wrong.is_closed(writer));
  CHECK(talks.is_closed(writer));
  REQUIRE(writer.stream.write(numbered(5, 50)));
  CHECK(reader.next(writer) == numbered(5, 50));
  Bytes heard(200);
  CHECK(::recv(silent.socket, heard.data(), heard.size(), MSG_DONTWAIT) < 0);  // not even a token
  const ssize_t bytes = ::recv(in_parts.socket, heard.data(), heard.size(), MSG_DONTWAIT);
  CHECK(bytes == sizeof kOwnToken + 4 + 50);
}

TEST_CASE("host stream: of those who never greet only so many are kept", "[bus]") {
  // Oracle: counts of connections that are closed; a reader that comes behind them all is let in.
  StreamWriter writer;
  std::vector<std::unique_ptr<RawClient>> silent;
  for (int k = 0; k < 200; ++k) silent.push_back(std::make_unique<RawClient>(writer.name));
  StreamReader reader;
  REQUIRE(reader.connect(writer));
  const auto kept = std::ranges::count_if(silent, [](const auto& client) {
    Bytes any(8);
    return ::recv(client->socket, any.data(), any.size(), MSG_DONTWAIT) < 0;
  });
  CHECK(kept == HostStreamWriter::kMostStrangers - 1);  // one was the reader's place
  REQUIRE(writer.stream.write(numbered(1, 10)));
  CHECK(reader.next(writer) == numbered(1, 10));
}

TEST_CASE("host stream: a writer before whose door there is no place is asked again", "[bus]") {
  // Oracle: one place, which somebody else takes and leaves after a while.
  const RawServer server(0);
  const RawClient other(server.name);
  REQUIRE(other.connected);
  StreamReader reader;
  reader.stream.meet(writer_id(1), server.name);
  for (int k = 0; k < 5; ++k) reader.stream.wait(0.02);
  const HostSocket of_other(::accept(server.listening.descriptor(), nullptr, nullptr));
  for (int k = 0; k < 5; ++k) reader.stream.wait(0.02);
  pollfd asked{server.listening.descriptor(), POLLIN, 0};
  CHECK(::poll(&asked, 1, 0) == 1);
}

TEST_CASE("host stream: without a descriptor nobody throws, and who is met is asked later",
          "[bus]") {
  // Oracle: counts. A reader that hears one writer took the error of asking two more into its
  // take(), which throws nothing, and forgot both.
  StreamWriter known, first, second;
  StreamReader reader;
  REQUIRE(reader.connect(known, 1));
  reader.stream.meet(writer_id(2), first.name);
  reader.stream.meet(writer_id(3), second.name);
  {
    const NoDescriptors none;
    RawSample sample;
    const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(50);
    while (std::chrono::steady_clock::now() < end) {
      bool taken = false;
      REQUIRE_NOTHROW(taken = reader.stream.take(sample));
      CHECK_FALSE(taken);
    }
    CHECK(reader.stream.matched_writers() == 1);
  }
  CHECK(wait_until([&] {
    const int readers = first.stream.matched_readers() + second.stream.matched_readers();
    return reader.stream.matched_writers() == 3 && readers == 2;
  }));
}

TEST_CASE("host stream: a writer whose samples cannot be is heard no more", "[bus]") {
  // Oracle: the count of writers; what came before is handed on.
  const RawServer raw(1);
  const HostSocket& server = raw.listening;
  const std::string& name = raw.name;
  StreamReader reader;
  reader.stream.meet(writer_id(1), name);
  reader.stream.wait(0.1);
  const HostSocket own(::accept(server.descriptor(), nullptr, nullptr));
  REQUIRE(own.descriptor() >= 0);
  const auto say = [&](const Bytes& bytes) {
    REQUIRE(::send(own.descriptor(), bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
            static_cast<ssize_t>(bytes.size()));
  };
  say(token_bytes(kOwnToken));
  say({3, 0, 0, 0, 'a', 'b', 'c'});
  RawSample sample;
  REQUIRE(wait_until([&] { return reader.stream.take(sample); }));
  CHECK(sample.payload == Bytes{'a', 'b', 'c'});
  CHECK(reader.stream.matched_writers() == 1);
  say({0xff, 0xff, 0xff, 0xff, 'x'});
  CHECK(wait_until([&] { return reader.stream.matched_writers() == 0; }));
  CHECK_FALSE(reader.stream.take(sample));
}

TEST_CASE("host stream: other users are not let in", "[bus]") {
  // Oracle: a reader that asks as another user. Only root can become one.
  if (::geteuid() != 0) {
    WARN("SKIPPED: not root");
    return;
  }
  StreamWriter writer;
  constexpr uid_t kNobody = 65'534;
  REQUIRE(::seteuid(kNobody) == 0);
  const RawClient other(writer.name);
  REQUIRE(::seteuid(0) == 0);
  REQUIRE(other.connected);
  other.send(token_bytes(kOwnToken));
  CHECK(other.is_closed(writer));
  CHECK(writer.stream.matched_readers() == 0);
}

}  // namespace palpate::bus
