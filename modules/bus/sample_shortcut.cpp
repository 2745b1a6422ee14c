#include "modules/bus/sample_shortcut.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "modules/bus/byte_cursor.h"
#include "modules/bus/rtps_words.h"

namespace palpate::bus {
namespace {

constexpr std::size_t kToPayload = 16;  // from behind the number that says so
constexpr std::size_t kEncapsulationBytes = 4;

struct PlainSample {
  std::span<const std::uint8_t> participant;  ///< to whom; empty: to all
  SampleShortcut::EntityId reader = 0;        ///< 0: to all
  WriterId writer{};
  std::int64_t sequence = 0;
  messages::Payload payload;
};

/// Of a DATA sub-message with a payload and nothing beside it.
std::optional<PlainSample> sample_in(std::span<const std::uint8_t> content, std::uint8_t flags,
                                     std::span<const std::uint8_t> prefix) {
  if ((flags & ~kLittleEndian) != kPayloadFlag) return {};
  Cursor cursor(content, (flags & kLittleEndian) != 0);
  cursor.skip(2);  // extra flags
  if (cursor.two() != kToPayload) return {};
  PlainSample sample;
  sample.reader = cursor.entity();
  std::ranges::copy(prefix, sample.writer.begin());
  std::ranges::copy(content.subspan(8, 4), sample.writer.begin() + prefix.size());
  cursor.skip(4);
  sample.sequence = cursor.sequence();
  sample.payload = cursor.left();
  if (cursor.missing()) return {};
  return sample;
}

/// If it is all there is in the packet.
std::optional<PlainSample> only_sample(std::span<const std::uint8_t> packet) {
  const auto prefix = packet.subspan(kPrefixAt, GuidPrefix().size());
  std::span<const std::uint8_t> participant;
  for (auto rest = packet.subspan(kRtpsHeaderBytes); !rest.empty();) {
    const std::uint8_t kind = rest[0];
    const auto size = submessage_size(rest);
    if (!size) return {};
    const auto content = rest.subspan(kSubmessageHeaderBytes, *size - kSubmessageHeaderBytes);
    const std::uint8_t flags = rest[1];
    rest = rest.subspan(*size);
    if (kind == kData && rest.empty() && content.size() > kToPayload + kEncapsulationBytes) {
      auto sample = sample_in(content, flags, prefix);
      if (sample) sample->participant = participant;
      return sample;
    }
    if (kind == kInfoDestination && content.size() >= prefix.size()) {
      participant = content.first(prefix.size());
    } else if (kind != kInfoTimestamp) {
      return {};
    }
  }
  return {};
}

}  // namespace

void SampleInbox::put(const WriterId& writer, std::int64_t arrived_ns, messages::Payload payload) {
  const std::lock_guard lock(mutex_);
  if (payload.size() > most_bytes_ - bytes_) return;
  if (count_ == samples_.size()) samples_.emplace_back();
  RawSample& sample = samples_[count_++];
  sample.writer = writer;
  sample.received_time_ns = arrived_ns;
  sample.payload.assign(payload.begin(), payload.end());
  bytes_ += payload.size();
}

bool SampleInbox::take(RawSample& sample) {
  const std::lock_guard lock(mutex_);
  if (next_ == count_) {
    next_ = count_ = bytes_ = 0;
    return false;
  }
  std::swap(sample, samples_[next_++]);
  return true;
}

bool SampleInbox::empty() const {
  const std::lock_guard lock(mutex_);
  return next_ == count_;
}

void SampleShortcut::set_participant(const GuidPrefix& own) {
  const std::lock_guard lock(mutex_);
  own_ = own;
}

void SampleShortcut::connect(const WriterId& writer, EntityId reader,
                             std::shared_ptr<SampleInbox> inbox) {
  const std::lock_guard lock(mutex_);
  connections_[writer].push_back({reader, std::move(inbox), 0});
}

void SampleShortcut::disconnect(const WriterId& writer, EntityId reader) {
  const std::lock_guard lock(mutex_);
  const auto known = connections_.find(writer);
  if (known == connections_.end()) return;
  std::erase_if(known->second, [&](const Connection& each) { return each.reader == reader; });
  if (known->second.empty()) connections_.erase(known);
}

void SampleShortcut::disconnect(EntityId reader) {
  const std::lock_guard lock(mutex_);
  for (auto& [writer, connections] : connections_) {
    std::erase_if(connections, [&](const Connection& each) { return each.reader == reader; });
  }
  std::erase_if(connections_, [](const auto& known) { return known.second.empty(); });
}

bool SampleShortcut::take(std::span<const std::uint8_t> packet, std::int64_t arrived_ns) {
  const auto sample = only_sample(packet);
  if (!sample) return false;
  const std::lock_guard lock(mutex_);
  const auto known = connections_.find(sample->writer);
  if (known == connections_.end()) return false;
  const auto& to = sample->participant;
  const bool to_all = std::ranges::all_of(to, [](std::uint8_t byte) { return byte == 0; });
  if (!to_all && !std::ranges::equal(to, own_)) return false;
  for (Connection& each : known->second) {
    if (sample->reader != 0 && sample->reader != each.reader) continue;
    if (sample->sequence <= each.last) continue;
    each.last = sample->sequence;
    each.inbox->put(sample->writer, arrived_ns, sample->payload);
  }
  return true;
}

}  // namespace palpate::bus
