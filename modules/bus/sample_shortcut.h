// The way of a plain sample past the DDS library, for who needs every one of them: reading,
// keeping and handing one on takes the library ten times what it takes to put it into a list. Who
// may be heard is the library's word all the same: writers that it has matched, and no others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "modules/bus/packet_senders.h"
#include "modules/bus/raw_bus.h"

namespace palpate::bus {

/// What came for one reader. Thread-safe.
class SampleInbox {
 public:
  /// What may wait for one reader, unless told otherwise [bytes]; what comes beyond is lost, and
  /// leaves a gap in its writer's numbers.
  static constexpr std::size_t kMostBytes = 16u << 20;

  explicit SampleInbox(std::size_t most_bytes = kMostBytes) : most_bytes_(most_bytes) {}
  /// @param arrived_ns  by the monotonic clock
  void put(const WriterId& writer, std::int64_t arrived_ns, messages::Payload payload);
  /// The oldest one. `sample` gives its memory for it. False if there is none.
  bool take(RawSample& sample);
  bool empty() const;

 private:
  std::size_t most_bytes_;
  mutable std::mutex mutex_;
  std::vector<RawSample> samples_;  ///< places keep their memory
  std::size_t next_ = 0, count_ = 0, bytes_ = 0;
};

/// Knows the inboxes of readers that are heard this way. Thread-safe.
class SampleShortcut {
 public:
  /// The last four bytes of a reader's or writer's id, as they travel.
  using EntityId = std::uint32_t;

  /// Before anything is connected. @param own  this participant
  void set_participant(const GuidPrefix& own);
  void connect(const WriterId& writer, EntityId reader, std::shared_ptr<SampleInbox> inbox);
  void disconnect(const WriterId& writer, EntityId reader);
  void disconnect(EntityId reader);  ///< from all

  /// Puts what is in a packet into its reader's inbox, if it is one sample in plain, whole, of a
  /// writer that is connected, and later than its last one; what is not later goes no way.
  /// @param packet  sound (packet_filter.h)
  /// @return false if the library is to read it
  bool take(std::span<const std::uint8_t> packet, std::int64_t arrived_ns);

 private:
  struct Connection {
    EntityId reader = 0;
    std::shared_ptr<SampleInbox> inbox;
    std::int64_t last = 0;  ///< RTPS sequence number
  };

  std::mutex mutex_;
  GuidPrefix own_{};
  std::map<WriterId, std::vector<Connection>> connections_;
};

}  // namespace palpate::bus
