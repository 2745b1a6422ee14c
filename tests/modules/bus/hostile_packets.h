// Packets that mean ill, at random.
#pragma once

#include <cstdlib>
#include <random>

#include "tests/modules/bus/rtps_packets.h"

namespace palpate::bus::testing {

/// How many; by hand PALPATE_HOSTILE_PACKETS=1000000.
inline int packets_to_send(int usual) {
  const char* const asked = std::getenv("PALPATE_HOSTILE_PACKETS");
  return asked == nullptr ? usual : std::atoi(asked);
}

/// A sub-message of the kinds that move something in a participant, with numbers of any size.
inline Bytes any_message(std::mt19937_64& random, const Bytes& prefix) {
  const auto number = [&] { return static_cast<std::int64_t>(random() >> (random() % 64)); };
  switch (random() % 10) {
    case 0:
      return farewell(prefix);
    case 1:
      return announcement(prefix);
    case 2:
      return heartbeat(number(), number());
    case 3:
      return acknack(number(), static_cast<std::uint32_t>(random() % 300));
    case 4:
      return gap(number(), number(), static_cast<std::uint32_t>(random() % 300));
    case 5:
      return statistics();
    case 6:
      return data_frag(number(), 1, 1, 1000, static_cast<std::uint32_t>(number()), Bytes(1000));
    case 7:
      return data(0x000003c2, number(), Bytes(random() % 200));
    case 8:
      return data(kUserWriter, number(), Bytes(random() % 200));
    default:
      return timestamp();
  }
}

/// What was overheard, with some bytes changed, or words made up in somebody's name.
inline Bytes any_packet(std::mt19937_64& random, const std::vector<Bytes>& overheard) {
  const Bytes& model = overheard[random() % overheard.size()];
  const Bytes prefix(model.begin() + 8, model.begin() + 20);
  const std::uint64_t kind = random() % 20;
  if (kind == 0) return statistics_and_more();
  if (kind < 10) {
    return joined({header(kind < 7 ? prefix : Bytes(12, std::uint8_t(random()))),
                   any_message(random, prefix), any_message(random, prefix)});
  }
  Bytes packet = model;
  for (std::uint64_t k = 1 + random() % 6; k > 0; --k) {
    packet[4 + random() % (packet.size() - 4)] = static_cast<std::uint8_t>(random());
  }
  if (kind == 10) packet.resize(1 + random() % packet.size());
  return packet;
}

}  // namespace palpate::bus::testing
