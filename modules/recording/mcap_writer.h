// Writes an MCAP file as any reader of the format expects it: chunked, compressed, indexed, with
// CRCs. A file whose writer was killed is whole up to its last chunk.
#pragma once

#include <deque>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <vector>

#include "modules/recording/mcap_chunk.h"
#include "modules/recording/mcap_records.h"

namespace palpate::recording {

/// Before anything is begun whose recording it is to be.
/// @throws InputError if the folder is missing or cannot be written to, or if there is something
/// of that name that is no recording, or that another program is writing
void check_recording_target(const std::filesystem::path& file);

/// No room is left. What had been written, a sample at least, was ended whole, as by close(),
/// shorter by as much as the summary takes.
struct DiskFull : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Messages are gathered into chunks of half a second or a megabyte. Whole chunks and the other
/// records, which lie beside them, are written by flush(), by close(), and when a megabyte has
/// gathered. Not thread-safe.
class McapWriter {
 public:
  /// Replaces an existing recording. @throws InputError if the file holds something else;
  /// std::runtime_error naming the file and the system's reason
  /// @param named  what errors call it: of a file in the making the one that it will be
  explicit McapWriter(const std::filesystem::path& file, const std::filesystem::path& named);
  explicit McapWriter(const std::filesystem::path& file) : McapWriter(file, file) {}
  /// Without close() the file stays as a killed writer leaves it.
  ~McapWriter();
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// Gives the schema an id, which is returned; `schema.id` is not read.
  std::uint16_t add_schema(McapSchema schema);
  /// Gives the channel an id, which is returned; `channel.id` is not read.
  std::uint16_t add_channel(McapChannel channel);
  /// @param data  payload; all else is taken from `message`, whose own data is not read
  void add_message(const McapMessage& message, std::span<const std::uint8_t> data);
  void add_metadata(const McapMetadata& metadata);
  void add_attachment(const McapAttachment& attachment);

  /// Ends the chunk that messages are gathered in.
  void end_chunk();
  /// @throws DiskFull; std::runtime_error naming the file and the system's reason: of a disk that
  /// has no room for any message, and then there is no file
  void flush();
  /// Ends the data section, writes the summary and the footer, closes. A second call does nothing.
  /// @throws as flush(); std::runtime_error if others removed, replaced or cut the file
  void close();

  const McapStatistics& statistics() const { return statistics_; }
  /// Including what flush() still holds, without the chunk that has not ended.
  std::uint64_t bytes_written() const { return offset_; }

 private:
  /// A place where the file may end: all before it is whole.
  struct Mark {
    std::uint64_t offset = 0;
    std::uint32_t crc = 0;
    std::size_t schemas = 0, channels = 0, chunks = 0, attachments = 0, metadata = 0;
    McapStatistics messages;  ///< of the chunks
  };

  struct Names {
    std::filesystem::path file, named;
  };
  explicit McapWriter(Names names);
  void empty();
  void mark();
  void go_back_to(const Mark& mark);
  bool end_short();
  void remove_empty();
  int write_pending();
  void append_end();
  const char* why_gone() const;
  void append(McapOpcode opcode, std::span<const std::uint8_t> content);
  void appended(std::size_t bytes);
  void append_summary();
  [[noreturn]] void fail(const char* doing, int system_error) const;

  std::filesystem::path file_, named_;
  int descriptor_ = -1;
  std::uint64_t offset_ = 0;
  std::vector<std::uint8_t> pending_;
  std::uint32_t crc_ = 0;     ///< of all but the summary
  std::deque<Mark> marks_;    ///< the newest
  McapStatistics in_chunks_;  ///< of those that have ended
  McapChunkBuilder chunk_;
  std::vector<McapSchema> schemas_;
  std::vector<McapChannel> channels_;
  std::vector<McapChunkIndex> chunks_;
  std::vector<std::vector<std::uint8_t>> attachment_indexes_, metadata_indexes_;
  McapStatistics statistics_;
};

}  // namespace palpate::recording
