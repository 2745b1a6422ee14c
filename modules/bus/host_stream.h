// Streams between processes of one host, past the DDS library: samples whole, in their order, and
// none lost, by a local socket from each writer to each reader. What the library does with a sample
// besides, to acknowledge, keep and hand it on, is not needed there. Who may be heard is its word
// all the same: it tells a reader of its writers.
//
// Both ends are of one user (SO_PEERCRED). A reader begins with the session's token, the writer
// answers with it; then come samples, each behind its size (uint32, of this host).
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "modules/bus/packet_senders.h"
#include "modules/bus/polled_sockets.h"
#include "modules/bus/raw_bus.h"
#include "modules/bus/sample_shortcut.h"

namespace palpate::bus {

/// Where the samples that a participant writes to a topic are asked for: a name in this host's
/// memory, which no file bears.
std::string host_stream_name(const GuidPrefix& writer, std::string_view topic);

/// One end of a connection, or what listens for some; ends with its object.
class HostSocket {
 public:
  explicit HostSocket(int descriptor) : descriptor_(descriptor) {}
  ~HostSocket();
  HostSocket(HostSocket&& other) noexcept;
  HostSocket(const HostSocket&) = delete;
  HostSocket& operator=(const HostSocket&) = delete;
  HostSocket& operator=(HostSocket&&) = delete;

  int descriptor() const { return descriptor_; }
  bool is_of_this_user() const;  ///< the other end

 private:
  int descriptor_;
};

/// Writes to all who have asked under a name. What there is no room for waits: a stopped reader
/// blocks nobody.
class HostStreamWriter : public RawWriter {
 public:
  /// Connections that have not greeted yet; of more the first is dropped. Readers greet as they
  /// ask.
  static constexpr std::ptrdiff_t kMostStrangers = 32;
  static constexpr int kMostAtOnce = 64;  ///< let in by one hear()

  /// @param sockets  let others ask, and what waits go, in hear(); outlive this
  /// @throws std::system_error if the name is taken, or the system gives no socket
  HostStreamWriter(PolledSockets& sockets, const std::string& name, std::uint64_t token);
  ~HostStreamWriter() override;

  bool write(messages::Payload sample) override;
  int matched_readers() const override;
  bool has_readers() const override { return !readers_.empty(); }
  /// Until the system has it for all of them: what a writer that ends has written is read.
  bool wait_until_received(double longest) override;

 private:
  struct Reader {
    explicit Reader(HostSocket connected) : socket(std::move(connected)) {}
    bool is_greeted() const { return greeted == greeting.size(); }
    HostSocket socket;
    std::array<std::uint8_t, sizeof(std::uint64_t)> greeting{};
    std::size_t greeted = 0;  ///< bytes of it; one that is whole was right
    std::vector<std::uint8_t> waiting;
    std::size_t gone = 0;  ///< bytes of it
  };

  bool let_in();
  bool let_one_in();
  void limit_strangers(std::ptrdiff_t most);
  bool serve(int descriptor);
  bool hear_greeting(Reader& reader) const;
  /// Both return false if the reader has left.
  bool send(Reader& reader, messages::Payload sample);
  bool send_waiting(Reader& reader);
  void drop(int descriptor);
  bool all_gone() const;

  PolledSockets& sockets_;
  std::uint64_t token_;
  HostSocket listening_;
  std::map<int, Reader> readers_;  ///< by descriptor
};

/// Reads what writers write that it was told of.
class HostStreamReader : public RawReader {
 public:
  /// Larger ones end their connection.
  static constexpr std::size_t kMostSampleBytes = 256u << 20;

  /// @param sockets  hear for it; outlive this
  /// @throws std::system_error if the system gives no descriptor
  HostStreamReader(PolledSockets& sockets, std::uint64_t token);
  ~HostStreamReader() override;

  /// There is a writer of that id, under that name. From any thread; one that is known already is
  /// not asked again.
  void meet(const WriterId& writer, std::string name);

  bool take(RawSample& sample) override;
  bool wait(double timeout) override;
  int matched_writers() const override;

 private:
  struct Writer {
    Writer(HostSocket connected, const WriterId& writer)
        : socket(std::move(connected)), id(writer) {}
    HostSocket socket;
    WriterId id;
    bool greeted = false;
    std::vector<std::uint8_t> bytes;  ///< room, and in front
    std::size_t filled = 0;           ///< so much that is not yet read
  };
  struct Met {
    WriterId id{};
    std::string name;
  };

  void ring(std::int64_t after_ns) const;
  bool ask_all();
  /// Both return false if it is to be asked again.
  bool ask(const Met& met);
  /// @throws std::system_error if the system gives no descriptor
  bool connect(const Met& met);
  bool serve(int descriptor);
  /// Puts all whole samples that are there into the inbox. False if the bytes are no such stream.
  bool read(Writer& writer);
  void drop(int descriptor);

  PolledSockets& sockets_;
  std::uint64_t token_;
  HostSocket bell_;  ///< a timer: somebody is to be asked
  SampleInbox inbox_;
  std::map<int, Writer> writers_;  ///< by descriptor
  std::mutex mutex_;
  std::vector<Met> met_;  ///< not yet asked
};

}  // namespace palpate::bus
