#include "modules/bus/packet_gatherer.h"

#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <memory>
#include <system_error>
#include <utility>

#include "modules/bus/clock_ns.h"

namespace palpate::bus {
namespace {

constexpr std::size_t kPacketsAtOnce = 32;
constexpr std::size_t kMostCalls = 64;  // then it looks whether it is to end
/// What the kernel counts beside a packet's bytes, about.
constexpr std::size_t kBesideBytes = 1024;

void stamp_packets(const ListeningSocket& socket, const std::string& address) {
  const int on = 1;
  if (::setsockopt(socket.descriptor(), SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on) == 0) return;
  throw std::system_error(errno, std::generic_category(), address);
}

/// The kernel's stamp.
std::int64_t arrival_of(msghdr& message) {
  for (cmsghdr* word = CMSG_FIRSTHDR(&message); word != nullptr;
       word = CMSG_NXTHDR(&message, word)) {
    if (word->cmsg_level != SOL_SOCKET || word->cmsg_type != SCM_TIMESTAMPNS) continue;
    timespec time{};
    std::memcpy(&time, CMSG_DATA(word), sizeof time);
    return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
  }
  return clock_ns<std::chrono::system_clock>();
}

}  // namespace

void GatheringPause::note(std::size_t waited, std::size_t room) {
  if (waited > room / 4) {
    seconds_ = std::max(kShortest, seconds_ / 2);
  } else if (waited < room / 16) {
    seconds_ = std::min(kLongest, seconds_ * 2);
  }
}

/// Memory for the packets of one call.
class PacketGatherer::Batch {
 public:
  Batch() {
    for (std::size_t i = 0; i < kPacketsAtOnce; ++i) {
      places_[i] = {bytes_.get() + i * kMostPacketBytes, kMostPacketBytes};
    }
  }

  /// @return how many packets
  std::size_t take(int descriptor) {
    for (std::size_t i = 0; i < kPacketsAtOnce; ++i) {
      msghdr& header = messages_[i].msg_hdr;
      header = {};
      header.msg_name = &senders_[i];
      header.msg_namelen = sizeof senders_[i];
      header.msg_iov = &places_[i];
      header.msg_iovlen = 1;
      header.msg_control = words_[i].data();
      header.msg_controllen = words_[i].size();
    }
    asked_ns_ = monotonic_ns();
    const int count =
        ::recvmmsg(descriptor, messages_.data(), kPacketsAtOnce, MSG_DONTWAIT, nullptr);
    before_ns_ = monotonic_ns();
    wall_ns_ = clock_ns<std::chrono::system_clock>();
    after_ns_ = monotonic_ns();
    return count < 0 ? 0 : static_cast<std::size_t>(count);
  }

  /// @param shift  of the socket
  ArrivedPacket at(std::size_t i, WallClockShift& shift) {
    const std::int64_t ahead = shift.take(before_ns_, wall_ns_, after_ns_);
    const std::int64_t arrived =
        shift.arrival(arrival_of(messages_[i].msg_hdr), before_ns_, wall_ns_, after_ns_);
    const sockaddr_in& from = senders_[i];
    return {{bytes_.get() + i * kMostPacketBytes, messages_[i].msg_len},
            {from.sin_addr.s_addr, ntohs(from.sin_port)},
            arrived,
            arrived - ahead};
  }
  /// Before it was taken [ns].
  std::int64_t asked_ns() const { return asked_ns_; }

 private:
  struct alignas(cmsghdr) Words : std::array<std::uint8_t, CMSG_SPACE(sizeof(timespec))> {};

  /// Touched as far as packets are long.
  std::unique_ptr<std::uint8_t[]> bytes_ =
      std::make_unique_for_overwrite<std::uint8_t[]>(kPacketsAtOnce * kMostPacketBytes);
  std::array<mmsghdr, kPacketsAtOnce> messages_{};
  std::array<iovec, kPacketsAtOnce> places_{};
  std::array<sockaddr_in, kPacketsAtOnce> senders_{};
  std::array<Words, kPacketsAtOnce> words_{};
  std::int64_t asked_ns_ = 0, before_ns_ = 0, wall_ns_ = 0, after_ns_ = 0;
};

PacketGatherer::PacketGatherer(const std::vector<std::string>& addresses, std::uint16_t port,
                               int room, Take take)
    : take_(std::move(take)) {
  for (const std::string& address : addresses) {
    const Socket& socket = sockets_.emplace_back(Socket{ListeningSocket(address, port, room), {}});
    stamp_packets(socket.listening, address);
  }
  thread_ = std::thread([this] { run(); });
}

PacketGatherer::~PacketGatherer() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

void PacketGatherer::run() {
  Batch batch;
  GatheringPause pause;
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, std::chrono::duration<double>(pause.seconds()),
                         [this] { return stopping_; })) {
    lock.unlock();
    for (Socket& socket : sockets_) pause.note(drain(socket, batch), socket.listening.room());
    lock.lock();
  }
}

/// @return about how much of the socket's room that took
std::size_t PacketGatherer::drain(Socket& socket, Batch& batch) const {
  std::size_t waited = 0;
  std::size_t count = kPacketsAtOnce;
  for (std::size_t calls = 0; count == kPacketsAtOnce && calls < kMostCalls; ++calls) {
    count = batch.take(socket.listening.descriptor());
    for (std::size_t i = 0; i < count; ++i) {
      const ArrivedPacket packet = batch.at(i, socket.shift);
      waited += packet.bytes.size() + kBesideBytes;
      take_(packet);
    }
    if (count < kPacketsAtOnce) socket.shift.nothing_waits(batch.asked_ns());
  }
  return waited;
}

}  // namespace palpate::bus
