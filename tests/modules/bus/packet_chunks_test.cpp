#include "modules/bus/packet_chunks.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <random>

namespace palpate::bus {
namespace {

constexpr PacketSender kOtherHost{0x0a000006, 7411};

std::vector<std::uint8_t> random_packet(std::mt19937& random, std::size_t bytes) {
  std::vector<std::uint8_t> packet(bytes);
  for (auto& byte : packet) byte = static_cast<std::uint8_t>(random());
  return packet;
}

/// Adds chunks in this order. @returns what came of it
std::vector<std::uint8_t> put_together(ChunkAssembler& assembler, const PacketChunks& chunks,
                                       const std::vector<std::size_t>& order) {
  std::vector<std::uint8_t> packet, found;
  for (const std::size_t i : order) {
    if (assembler.add(chunks.at(i), kOtherHost, packet)) found = packet;
  }
  return found;
}

std::vector<std::size_t> all_of(const PacketChunks& chunks) {
  std::vector<std::size_t> order(chunks.count());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  return order;
}

}  // namespace

TEST_CASE("packet chunks: in any order, each small enough, they are the packet again", "[bus]") {
  // Oracle: the packet.
  std::mt19937 random(3);
  ChunkAssembler assembler;
  std::uint32_t number = 0;
  for (const std::size_t bytes : {1'401u, 2'768u, 2'769u, 8'444u, 65'500u}) {
    const auto packet = random_packet(random, bytes);
    const PacketChunks chunks(packet, ++number);
    auto order = all_of(chunks);
    for (const std::size_t i : order) {
      CHECK(chunks.at(i).size() <= kChunkBytes);
      const auto tail = chunks.at(i).last(64);  // where Fast DDS would write
      CHECK(std::ranges::count(tail, 0) == 64);
      CHECK(is_chunk(chunks.at(i)));
    }
    std::shuffle(order.begin(), order.end(), random);
    CHECK(put_together(assembler, chunks, order) == packet);
  }
  CHECK_FALSE(is_chunk(random_packet(random, 16)));
}

TEST_CASE("packet chunks: any one lost of a packet is made up, two neighbours too", "[bus]") {
  // Oracle: the packet; neighbours are of different groups.
  std::mt19937 random(4);
  ChunkAssembler assembler;
  std::uint32_t number = 0;
  const auto packet = random_packet(random, 20'000);
  const std::size_t count = PacketChunks(packet, 0).count();
  for (std::size_t lost = 0; lost < count; ++lost) {
    for (const std::size_t with : {lost, lost + 1}) {
      const PacketChunks chunks(packet, ++number);
      auto order = all_of(chunks);
      std::erase_if(order, [&](std::size_t i) { return i == lost || i == with; });
      CHECK(put_together(assembler, chunks, order) == packet);
    }
  }
}

TEST_CASE("packet chunks: at 5 % loss 97 of 100 packets of six chunks come through", "[bus]") {
  // Oracle: two groups of 3 + 1, each lost with two or more of its four: 1 − (1 − 0.0140)² = 2.8 %;
  // without parities 1 − 0.95⁶ = 26 %. Three standard deviations of 4,000 trials: 0.8 %.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> chance(0, 1);
  ChunkAssembler assembler;
  const auto packet = random_packet(random, 6 * 1'320);
  int through = 0;
  for (std::uint32_t number = 1; number <= 4'000; ++number) {
    const PacketChunks chunks(packet, number);
    auto order = all_of(chunks);
    REQUIRE(order.size() == 8);
    std::erase_if(order, [&](std::size_t) { return chance(random) < 0.05; });
    const auto found = put_together(assembler, chunks, order);
    REQUIRE((found.empty() || found == packet));
    through += found == packet ? 1 : 0;
  }
  CHECK(through / 4'000.0 == Approx(1 - 0.028).margin(0.008));
}

TEST_CASE("packet chunks: a packet is given once, and others' numbers are others' packets",
          "[bus]") {
  // Oracle: the rule.
  std::mt19937 random(6);
  ChunkAssembler assembler;
  const auto one = random_packet(random, 3'000), other = random_packet(random, 3'000);
  const PacketChunks of_one(one, 1), of_other(other, 1);
  std::vector<std::uint8_t> packet;
  int whole = 0;
  for (int twice = 0; twice < 2; ++twice) {
    for (std::size_t i = 0; i < of_one.count(); ++i) {
      whole += assembler.add(of_one.at(i), kOtherHost, packet) ? 1 : 0;
      if (assembler.add(of_other.at(i), {1, 1}, packet)) {
        ++whole;
        CHECK(packet == other);
      }
    }
  }
  CHECK(whole == 2);
}

TEST_CASE("packet chunks: what is no sound chunk is left out", "[bus]") {
  // Oracle: each number out of its range, and random bytes behind the magic word; memory is that of
  // kMostOpen packets whatever comes.
  std::mt19937 random(7);
  ChunkAssembler assembler;
  const PacketChunks chunks(random_packet(random, 5'000), 1);
  std::vector<std::uint8_t> packet;
  for (int round = 0; round < 20'000; ++round) {
    std::vector<std::uint8_t> chunk(chunks.at(0).begin(), chunks.at(0).end());
    for (int i = 0; i < 3; ++i) chunk[4 + random() % 12] = static_cast<std::uint8_t>(random());
    chunk.resize(random() % (chunk.size() + 1));
    if (assembler.add(chunk, kOtherHost, packet)) CHECK(packet.size() <= 65'536);
  }
}

}  // namespace palpate::bus
