// Chunks of an MCAP file: messages compressed together (zstd), with a CRC and an index by channel
// and time, so that other programs open a recording at any place of it.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "modules/recording/mcap_records.h"

struct ZSTD_CCtx_s;

namespace palpate::recording {

/// A chunk that claims to hold more is refused: nobody's memory is filled by a few bytes of a file.
inline constexpr std::uint64_t kMostChunkBytes = 256u << 20;

/// Gathers messages into one chunk after the other.
class McapChunkBuilder {
 public:
  McapChunkBuilder();
  ~McapChunkBuilder();

  void add(const McapMessage& message, std::span<const std::uint8_t> data);
  bool empty() const { return messages_.empty(); }
  /// Large or long enough to be ended: the first ones are small, so that a disk that is soon full
  /// takes some. Until then its messages are in memory alone.
  bool due() const;
  std::size_t bytes() const { return messages_.size(); }

  /// Appends the chunk's record and those of its message indexes to `bytes`; empty afterwards.
  /// @param offset  of that place in the file
  McapChunkIndex finish(std::uint64_t offset, std::vector<std::uint8_t>& bytes);

 private:
  using Places = std::vector<std::pair<std::uint64_t, std::uint64_t>>;  ///< log time, offset

  void compress();

  std::unique_ptr<ZSTD_CCtx_s, std::size_t (*)(ZSTD_CCtx_s*)> context_;
  std::vector<std::uint8_t> messages_;
  std::vector<std::uint8_t> packed_;
  std::map<std::uint16_t, Places> places_;  ///< by channel
  std::uint64_t start_time_ns_ = 0, end_time_ns_ = 0;
  std::size_t finished_bytes_ = 0;  ///< of messages in the chunks before
};

/// The records in a chunk, given the content of the chunk's own record.
/// @throws McapFieldError where it is damaged, larger than kMostChunkBytes, or compressed otherwise
/// than by zstd
std::vector<std::uint8_t> unpacked_chunk(std::span<const std::uint8_t> content);

}  // namespace palpate::recording
