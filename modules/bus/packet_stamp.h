// When an RTPS packet came, told to whoever reads what is in it.
#pragma once

#include <cstdint>
#include <span>

namespace palpate::bus {

/// Puts the time of arrival in place of each source timestamp (sub-message INFO_TS): the DDS
/// library hands on that one with a sample, and stamps arrivals itself only when it reads a packet.
/// A packet of any content keeps all other bytes.
/// @param arrived_ns  by the wall clock
void stamp_arrival(std::span<std::uint8_t> packet, std::int64_t arrived_ns);

}  // namespace palpate::bus
