#include "modules/bus/host_clocks.h"

#include <algorithm>

namespace palpate::bus {

GuidPrefix participant_of(const WriterId& writer) {
  GuidPrefix prefix;
  std::copy_n(writer.begin(), prefix.size(), prefix.begin());
  return prefix;
}

HostClocks::Entry* HostClocks::find(const GuidPrefix& participant) {
  const auto end = entries_.begin() + static_cast<std::ptrdiff_t>(used_.load());
  const auto found = std::find_if(
      entries_.begin(), end, [&](const Entry& known) { return known.participant == participant; });
  return found == end ? nullptr : &*found;
}

HostClocks::Entry* HostClocks::entry(const GuidPrefix& participant) {
  if (Entry* known = find(participant)) return known;
  const std::lock_guard lock(adding_);
  if (Entry* known = find(participant)) return known;
  const std::size_t place = used_.load();
  if (place + 1 == entries_.size()) return &entries_.back();  // no room: never known
  Entry& added = entries_[place];
  added.participant = participant;
  const std::string host = host_of_(participant);
  added.own = host.empty();
  added.unknown_text = "the clock of " + host +
                       " is not known: nothing from there is used (does it answer on topic clock?)";
  added.jumped_text = "the clock of " + host + " was set or stood still: measured anew";
  added.known = added.own;
  used_.store(place + 1);
  return &added;
}

HostClocks::Reading HostClocks::of(const WriterId& writer, std::int64_t now_ns) {
  const Entry* of_writer = entry(participant_of(writer));
  if (of_writer->own) return {};
  const auto since = static_cast<double>(std::max<std::int64_t>(0, now_ns - of_writer->set_ns));
  return {of_writer->known, of_writer->shift_ns,
          of_writer->error + 1e-9 * since * ClockOffset::kMostDrift};
}

void HostClocks::set(const GuidPrefix& participant, const ClockOffset::Estimate& estimate,
                     std::uint64_t jumps, std::int64_t now_ns) {
  Entry* known = entry(participant);
  if (known->own || known == &entries_.back()) return;
  if (jumps != known->jumps) known->jumped_ns = now_ns;
  known->jumps = jumps;
  known->shift_ns = estimate.offset_ns;
  known->error = estimate.error;
  known->set_ns = now_ns;
  known->known = true;
}

void HostClocks::missed(const WriterId& writer, std::int64_t now_ns) {
  Entry* of_writer = entry(participant_of(writer));
  if (of_writer->first_missed_ns == 0) of_writer->first_missed_ns = now_ns;
  of_writer->missed_ns = now_ns;
}

const char* HostClocks::trouble(std::int64_t now_ns) const {
  const std::size_t used = used_.load();
  for (std::size_t i = 0; i < used; ++i) {
    const Entry& each = entries_[i];
    if (each.own) continue;
    const bool missed = each.missed_ns != 0 && now_ns - each.missed_ns < kForgotten;
    if (!each.known && missed && now_ns - each.first_missed_ns > kPatience)
      return each.unknown_text.c_str();
    if (each.jumped_ns != 0 && now_ns - each.jumped_ns < kJumpShown)
      return each.jumped_text.c_str();
  }
  return "";
}

}  // namespace palpate::bus
