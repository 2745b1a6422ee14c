#include "modules/bus/packet_senders.h"

#include <algorithm>

namespace palpate::bus {

bool PacketSenders::admit(const GuidPrefix& participant, const PacketSender& sender,
                          std::int64_t now_ns) {
  const std::lock_guard lock(mutex_);
  const auto known = known_.find(participant);
  if (known == known_.end()) return admit_newcomer(participant, sender, now_ns);
  if (known->second.sender != sender) return false;
  known->second.heard_ns = now_ns;
  return true;
}

std::optional<PacketSender> PacketSenders::sender_of(const GuidPrefix& participant) const {
  const std::lock_guard lock(mutex_);
  const auto known = known_.find(participant);
  if (known == known_.end()) return std::nullopt;
  return known->second.sender;
}

bool PacketSenders::admit_newcomer(const GuidPrefix& participant, const PacketSender& sender,
                                   std::int64_t now_ns) {
  const auto before = participants_.find(sender);
  if (before != participants_.end()) {
    const auto old = known_.find(before->second);
    if (now_ns - old->second.heard_ns < kSilence) return false;
    known_.erase(old);
    participants_.erase(before);
  }
  if (known_.size() >= kMaxParticipants && !make_room(now_ns)) return false;
  known_[participant] = {sender, now_ns};
  participants_[sender] = participant;
  return true;
}

bool PacketSenders::make_room(std::int64_t now_ns) {
  const auto oldest = std::min_element(
      known_.begin(), known_.end(),
      [](const auto& a, const auto& b) { return a.second.heard_ns < b.second.heard_ns; });
  if (now_ns - oldest->second.heard_ns < kForgotten) return false;
  participants_.erase(oldest->second.sender);
  known_.erase(oldest);
  return true;
}

}  // namespace palpate::bus
