#include "modules/bus/packet_chunks.h"

#include <algorithm>
#include <cstring>

namespace palpate::bus {
namespace {

constexpr std::uint32_t kChunkMagic = 0x31434c50;  // "PLC1"
constexpr std::size_t kInGroup = 3;
constexpr std::size_t kMostBytes = 65'536;

struct ChunkHeader {
  std::uint32_t magic = kChunkMagic;
  std::uint32_t number = 0;
  std::uint16_t index = 0, data = 0;  ///< of the chunk; how many hold data
  std::uint32_t total = 0;            ///< bytes of the packet
};
static_assert(sizeof(ChunkHeader) == 16);
/// Fast DDS 2.9.1 writes numbers of its own into what it sends, where a sub-message for its
/// statistics seems to be the last: 64 bytes, the first 0x80. They shall find zeros.
constexpr std::size_t kTailBytes = 64;
constexpr std::size_t kDataBytes = kChunkBytes - sizeof(ChunkHeader) - kTailBytes;

std::size_t chunks_of(std::size_t bytes) { return (bytes + kDataBytes - 1) / kDataBytes; }
std::size_t groups_of(std::size_t data) { return (data + kInGroup - 1) / kInGroup; }

void add_up(const std::uint8_t* from, std::size_t count, std::uint8_t* sum) {
  for (std::size_t i = 0; i < count; ++i) sum[i] = static_cast<std::uint8_t>(sum[i] ^ from[i]);
}

}  // namespace

bool is_chunk(std::span<const std::uint8_t> datagram) {
  std::uint32_t word = 0;
  if (datagram.size() <= sizeof(ChunkHeader) + kTailBytes) return false;
  std::memcpy(&word, datagram.data(), sizeof word);
  return word == kChunkMagic;
}

PacketChunks::PacketChunks(std::span<const std::uint8_t> packet, std::uint32_t number) {
  const std::size_t data = chunks_of(packet.size()), groups = groups_of(data);
  bytes_.resize((data + groups) * kChunkBytes);
  ChunkHeader header;
  header.number = number;
  header.data = static_cast<std::uint16_t>(data);
  header.total = static_cast<std::uint32_t>(packet.size());
  for (std::size_t i = 0; i < data + groups; ++i) {
    header.index = static_cast<std::uint16_t>(i);
    std::memcpy(bytes_.data() + i * kChunkBytes, &header, sizeof header);
    sizes_.push_back(kChunkBytes);
  }
  for (std::size_t i = 0; i < data; ++i) {
    const std::size_t count = std::min(kDataBytes, packet.size() - i * kDataBytes);
    const auto at = [&](std::size_t chunk) {
      return bytes_.data() + chunk * kChunkBytes + sizeof header;
    };
    std::memcpy(at(i), packet.data() + i * kDataBytes, count);
    add_up(at(i), count, at(data + i % groups));
    sizes_[i] = sizeof header + count + kTailBytes;
  }
}

ChunkAssembler::Open& ChunkAssembler::open(const PacketSender& sender, std::uint32_t number,
                                           std::size_t data, std::size_t total) {
  const auto known = std::ranges::find_if(open_, [&](const Open& each) {
    return each.age != 0 && each.number == number && each.sender == sender && each.total == total;
  });
  if (known != open_.end()) return *known;
  Open& fresh = *std::ranges::min_element(open_, {}, &Open::age);
  fresh.sender = sender;
  fresh.number = number;
  fresh.age = ++age_;
  fresh.done = false;
  fresh.total = total;
  fresh.missing = data;
  fresh.has.assign(data + groups_of(data), false);
  fresh.bytes.assign(fresh.has.size() * kDataBytes, 0);
  return fresh;
}

/// The one chunk of a group that lacks, if its parity and all others are there.
void ChunkAssembler::make_up(Open& packet, std::size_t group) {
  const std::size_t data = chunks_of(packet.total), groups = groups_of(data);
  if (!packet.has[data + group]) return;
  std::size_t lacking = data, lacks = 0;
  for (std::size_t i = group; i < data; i += groups) {
    if (packet.has[i]) continue;
    lacking = i;
    ++lacks;
  }
  if (lacks != 1) return;
  std::uint8_t* const made = packet.bytes.data() + lacking * kDataBytes;
  std::memcpy(made, packet.bytes.data() + (data + group) * kDataBytes, kDataBytes);
  for (std::size_t i = group; i < data; i += groups) {
    if (i != lacking) add_up(packet.bytes.data() + i * kDataBytes, kDataBytes, made);
  }
  packet.has[lacking] = true;
  --packet.missing;
}

bool ChunkAssembler::add(std::span<const std::uint8_t> chunk, const PacketSender& sender,
                         std::vector<std::uint8_t>& packet) {
  if (!is_chunk(chunk)) return false;
  ChunkHeader header;
  std::memcpy(&header, chunk.data(), sizeof header);
  const auto content = chunk.subspan(sizeof header, chunk.size() - sizeof header - kTailBytes);
  const std::size_t data = chunks_of(header.total), groups = groups_of(data);
  const bool sound = header.total <= kMostBytes && data > 0 && header.data == data &&
                     header.index < data + groups && content.size() <= kDataBytes;
  if (!sound) return false;

  const std::lock_guard lock(mutex_);
  Open& whole = open(sender, header.number, data, header.total);
  if (whole.done || whole.has[header.index]) return false;
  std::ranges::copy(content,
                    whole.bytes.begin() + static_cast<std::ptrdiff_t>(header.index * kDataBytes));
  whole.has[header.index] = true;
  if (header.index < data) --whole.missing;
  make_up(whole, header.index < data ? header.index % groups : header.index - data);
  if (whole.missing > 0) return false;
  whole.done = true;
  packet.assign(whole.bytes.begin(),
                whole.bytes.begin() + static_cast<std::ptrdiff_t>(whole.total));
  return true;
}

}  // namespace palpate::bus
