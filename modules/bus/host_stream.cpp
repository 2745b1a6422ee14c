#include "modules/bus/host_stream.h"

#include <sys/socket.h>
#include <sys/timerfd.h>
#include <sys/uio.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <limits>
#include <system_error>
#include <utility>

#include "modules/bus/clock_ns.h"
#include "modules/bus/session_token.h"
#include "modules/core/units.h"

namespace palpate::bus {
namespace {

constexpr std::size_t kReadBytes = 256u << 10;  // at once
constexpr int kRoomAsked = 4 << 20;             // of a socket [bytes]; the system may give less
constexpr std::int64_t kAskAgainNs = 10'000'000;
using SampleSize = std::uint32_t;

int checked(int result, const char* what) {
  if (result < 0) throw std::system_error(errno, std::generic_category(), what);
  return result;
}

HostSocket new_socket() {
  HostSocket made(
      checked(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0), "local socket"));
  ::setsockopt(made.descriptor(), SOL_SOCKET, SO_SNDBUF, &kRoomAsked, sizeof kRoomAsked);
  return made;
}

/// Names that begin with a zero are not files.
struct Name {
  explicit Name(const std::string& name) {
    at.sun_family = AF_UNIX;
    const std::size_t length = std::min(name.size(), sizeof at.sun_path - 1);
    std::memcpy(at.sun_path + 1, name.data(), length);
    size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  }
  const sockaddr* address() const { return reinterpret_cast<const sockaddr*>(&at); }
  sockaddr_un at{};
  socklen_t size = 0;
};

HostSocket listening_at(const std::string& name) {
  HostSocket made = new_socket();
  const Name at(name);
  checked(::bind(made.descriptor(), at.address(), at.size), "local socket");
  checked(::listen(made.descriptor(), SOMAXCONN), "local socket");
  return made;
}

bool would_block() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

/// It fits an empty socket.
bool greet(const HostSocket& socket, std::uint64_t token) {
  const ssize_t sent = ::send(socket.descriptor(), &token, sizeof token, MSG_NOSIGNAL);
  return sent == static_cast<ssize_t>(sizeof token);
}

}  // namespace

std::string host_stream_name(const GuidPrefix& writer, std::string_view topic) {
  std::array<std::uint64_t, 2> words{};
  static_assert(sizeof words >= sizeof writer);
  std::memcpy(words.data(), writer.data(), writer.size());
  std::string name = "palpate/" + token_text(words[0]) + token_text(words[1]) + "/";
  return name.append(topic);
}

HostSocket::~HostSocket() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

HostSocket::HostSocket(HostSocket&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)) {}

bool HostSocket::is_of_this_user() const {
  ucred other{};
  socklen_t size = sizeof other;
  return ::getsockopt(descriptor_, SOL_SOCKET, SO_PEERCRED, &other, &size) == 0 &&
         other.uid == ::geteuid();
}

HostStreamWriter::HostStreamWriter(PolledSockets& sockets, const std::string& name,
                                   std::uint64_t token)
    : sockets_(sockets), token_(token), listening_(listening_at(name)) {
  sockets_.watch(listening_.descriptor(), [this] { return let_in(); });
}

HostStreamWriter::~HostStreamWriter() {
  sockets_.forget(listening_.descriptor());
  while (!readers_.empty()) drop(readers_.begin()->first);
}

bool HostStreamWriter::let_in() {
  int count = 0;
  while (count < kMostAtOnce && let_one_in()) ++count;
  return count > 0;
}

bool HostStreamWriter::let_one_in() {
  const int descriptor =
      ::accept4(listening_.descriptor(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (descriptor < 0) {
    // Without a descriptor left it would ask to be let in for ever.
    if (errno == EMFILE || errno == ENFILE) limit_strangers(0);
    return false;
  }
  Reader reader{HostSocket(descriptor)};
  if (!reader.socket.is_of_this_user()) return true;
  ::setsockopt(descriptor, SOL_SOCKET, SO_SNDBUF, &kRoomAsked, sizeof kRoomAsked);
  limit_strangers(kMostStrangers - 1);
  sockets_.watch(descriptor, [this, descriptor] { return serve(descriptor); });
  readers_.emplace(descriptor, std::move(reader));
  return true;
}

void HostStreamWriter::limit_strangers(std::ptrdiff_t most) {
  const auto is_stranger = [](const auto& reader) { return !reader.second.is_greeted(); };
  for (auto left = std::ranges::count_if(readers_, is_stranger); left > most; --left) {
    drop(std::ranges::find_if(readers_, is_stranger)->first);
  }
}

bool HostStreamWriter::serve(int descriptor) {
  Reader& reader = readers_.at(descriptor);
  const bool stays = hear_greeting(reader) && send_waiting(reader);
  if (!stays) drop(descriptor);
  return true;
}

/// Answers it. False if it is wrong, or the reader has left. Behind it comes nothing.
bool HostStreamWriter::hear_greeting(Reader& reader) const {
  std::array<std::uint8_t, 1 + sizeof token_> heard{};
  const std::size_t room = heard.size() - reader.greeted;
  const ssize_t bytes = ::recv(reader.socket.descriptor(), heard.data(), room, MSG_DONTWAIT);
  if (bytes < 0) return would_block();
  const auto count = static_cast<std::size_t>(bytes);
  if (count == 0 || reader.greeted + count > reader.greeting.size()) return false;
  std::copy_n(heard.begin(), count, reader.greeting.begin() + reader.greeted);
  reader.greeted += count;
  if (!reader.is_greeted()) return true;
  return std::memcmp(reader.greeting.data(), &token_, sizeof token_) == 0 &&
         greet(reader.socket, token_);
}

bool HostStreamWriter::write(messages::Payload sample) {
  if (sample.size() > HostStreamReader::kMostSampleBytes) return false;
  for (auto each = readers_.begin(); each != readers_.end();) {
    const int descriptor = each->first;
    Reader& reader = (each++)->second;
    if (reader.is_greeted() && !send(reader, sample)) drop(descriptor);
  }
  return true;
}

bool HostStreamWriter::send(Reader& reader, messages::Payload sample) {
  auto size = static_cast<SampleSize>(sample.size());
  std::size_t gone = 0;
  if (reader.waiting.empty()) {
    iovec parts[] = {{&size, sizeof size},
                     {const_cast<std::uint8_t*>(sample.data()), sample.size()}};
    msghdr message{};
    message.msg_iov = parts;
    message.msg_iovlen = std::size(parts);
    const ssize_t bytes = ::sendmsg(reader.socket.descriptor(), &message, MSG_NOSIGNAL);
    if (bytes < 0 && !would_block()) return false;
    gone = static_cast<std::size_t>(std::max<ssize_t>(bytes, 0));
    if (gone == sizeof size + sample.size()) return true;
    sockets_.await_room(reader.socket.descriptor(), true);
  }
  std::array<std::uint8_t, sizeof size> front{};
  std::memcpy(front.data(), &size, sizeof size);
  const std::size_t of_front = std::min(gone, front.size());
  reader.waiting.insert(reader.waiting.end(), front.begin() + of_front, front.end());
  reader.waiting.insert(reader.waiting.end(), sample.begin() + (gone - of_front), sample.end());
  return true;
}

bool HostStreamWriter::send_waiting(Reader& reader) {
  if (reader.waiting.empty()) return true;
  const std::size_t left = reader.waiting.size() - reader.gone;
  const ssize_t bytes =
      ::send(reader.socket.descriptor(), reader.waiting.data() + reader.gone, left, MSG_NOSIGNAL);
  if (bytes < 0) return would_block();
  reader.gone += static_cast<std::size_t>(bytes);
  if (reader.gone < reader.waiting.size() / 2) return true;
  // What is gone needs no memory, though some may always wait.
  reader.waiting.erase(reader.waiting.begin(), reader.waiting.begin() + reader.gone);
  reader.gone = 0;
  if (reader.waiting.empty()) sockets_.await_room(reader.socket.descriptor(), false);
  return true;
}

int HostStreamWriter::matched_readers() const {
  sockets_.hear(0);
  return static_cast<int>(std::ranges::count_if(
      readers_, [](const auto& reader) { return reader.second.is_greeted(); }));
}

bool HostStreamWriter::wait_until_received(double longest) {
  const std::int64_t until = monotonic_ns() + ns_from_seconds(longest);
  for (std::int64_t left = until - monotonic_ns(); left > 0 && !all_gone();
       left = until - monotonic_ns()) {
    sockets_.hear(seconds_from_ns(left));
  }
  return all_gone();
}

bool HostStreamWriter::all_gone() const {
  return std::ranges::all_of(readers_,
                             [](const auto& reader) { return reader.second.waiting.empty(); });
}

void HostStreamWriter::drop(int descriptor) {
  sockets_.forget(descriptor);
  readers_.erase(descriptor);
}

HostStreamReader::HostStreamReader(PolledSockets& sockets, std::uint64_t token)
    : sockets_(sockets),
      token_(token),
      bell_(checked(::timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK), "timerfd")),
      inbox_(std::numeric_limits<std::size_t>::max()) {
  sockets_.watch(bell_.descriptor(), [this] { return ask_all(); });
}

HostStreamReader::~HostStreamReader() {
  sockets_.forget(bell_.descriptor());
  while (!writers_.empty()) drop(writers_.begin()->first);
}

void HostStreamReader::meet(const WriterId& writer, std::string name) {
  const std::lock_guard lock(mutex_);
  met_.push_back({writer, std::move(name)});
  ring(1);
}

void HostStreamReader::ring(std::int64_t after_ns) const {
  itimerspec at{};
  at.it_value.tv_nsec = after_ns;
  ::timerfd_settime(bell_.descriptor(), 0, &at, nullptr);
}

bool HostStreamReader::ask_all() {
  std::uint64_t rung = 0;
  static_cast<void>(::read(bell_.descriptor(), &rung, sizeof rung));
  std::vector<Met> met;
  {
    const std::lock_guard lock(mutex_);
    met.swap(met_);
  }
  std::erase_if(met, [&](const Met& each) { return ask(each); });
  if (met.empty()) return true;
  const std::lock_guard lock(mutex_);
  met_.insert(met_.end(), met.begin(), met.end());
  ring(kAskAgainNs);
  return true;
}

/// Without a descriptor left nobody can be asked, until there is one: callers have a cycle to end.
bool HostStreamReader::ask(const Met& met) {
  try {
    return connect(met);
  } catch (const std::system_error&) {
    return false;
  }
}

/// Whoever is not there has left: he listens before he is told of.
bool HostStreamReader::connect(const Met& met) {
  const auto is_known = [&](const auto& writer) { return writer.second.id == met.id; };
  if (std::ranges::any_of(writers_, is_known)) return true;
  Writer writer(new_socket(), met.id);
  const Name at(met.name);
  const int descriptor = writer.socket.descriptor();
  // Others may have taken all places before his door.
  if (::connect(descriptor, at.address(), at.size) != 0) return !would_block();
  if (!writer.socket.is_of_this_user() || !greet(writer.socket, token_)) return true;
  sockets_.watch(descriptor, [this, descriptor] { return serve(descriptor); });
  writers_.emplace(descriptor, std::move(writer));
  return true;
}

bool HostStreamReader::serve(int descriptor) {
  Writer& writer = writers_.at(descriptor);
  for (;;) {
    if (writer.bytes.size() < writer.filled + kReadBytes) {
      writer.bytes.resize(writer.filled + kReadBytes);
    }
    const std::size_t room = writer.bytes.size() - writer.filled;
    const ssize_t bytes =
        ::recv(descriptor, writer.bytes.data() + writer.filled, room, MSG_DONTWAIT);
    if (bytes < 0 && would_block()) return true;
    if (bytes > 0) writer.filled += static_cast<std::size_t>(bytes);
    if (bytes <= 0 || !read(writer)) {
      drop(descriptor);
      return true;
    }
    if (static_cast<std::size_t>(bytes) < room) return true;
  }
}

bool HostStreamReader::read(Writer& writer) {
  std::size_t at = 0;
  const auto has = [&](std::size_t bytes) { return writer.filled - at >= bytes; };
  if (!writer.greeted && has(sizeof token_)) {
    if (std::memcmp(writer.bytes.data(), &token_, sizeof token_) != 0) return false;
    writer.greeted = true;
    at = sizeof token_;
  }
  const std::int64_t arrived_ns = monotonic_ns();
  SampleSize size = 0;
  while (writer.greeted && has(sizeof size)) {
    std::memcpy(&size, writer.bytes.data() + at, sizeof size);
    if (size > kMostSampleBytes) return false;
    if (!has(sizeof size + size)) break;
    inbox_.put(writer.id, arrived_ns, {writer.bytes.data() + at + sizeof size, size});
    at += sizeof size + size;
  }
  if (at == 0) return true;
  std::copy(writer.bytes.begin() + at, writer.bytes.begin() + writer.filled, writer.bytes.begin());
  writer.filled -= at;
  return true;
}

bool HostStreamReader::take(RawSample& sample) {
  if (inbox_.take(sample)) return true;
  return !writers_.empty() && sockets_.hear(0) && inbox_.take(sample);
}

bool HostStreamReader::wait(double timeout) { return !inbox_.empty() || sockets_.hear(timeout); }

int HostStreamReader::matched_writers() const {
  sockets_.hear(0);
  return static_cast<int>(
      std::ranges::count_if(writers_, [](const auto& writer) { return writer.second.greeted; }));
}

void HostStreamReader::drop(int descriptor) {
  sockets_.forget(descriptor);
  writers_.erase(descriptor);
}

}  // namespace palpate::bus
