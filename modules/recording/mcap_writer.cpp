#include "modules/recording/mcap_writer.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>
#include <utility>

#include "modules/core/error.h"
#include "modules/core/output_file.h"
#include "modules/recording/mcap_bytes.h"
#include "modules/recording/mcap_codec.h"

namespace palpate::recording {
namespace {

constexpr std::size_t kFlushBytes = 1u << 20;
/// Places to end at on a full disk: between them and its end the summary has room.
constexpr std::size_t kMarks = 64;

template <class Record>
std::vector<McapContent> contents_of(const std::vector<Record>& records) {
  std::vector<McapContent> contents;
  for (const Record& record : records) contents.push_back(content_of(record));
  return contents;
}

std::string why_failed(const std::filesystem::path& file, const char* doing, int system_error) {
  return file.string() + ": cannot " + doing + ": " + std::generic_category().message(system_error);
}

/// A scene, or a mesh it names, given as the recording by mistake.
void refuse_to_replace_what_is_no_recording(const std::filesystem::path& file) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(file, none)) return;
  std::array<std::uint8_t, kMcapMagic.size()> first{};
  std::ifstream stream(file, std::ios::binary);
  stream.read(reinterpret_cast<char*>(first.data()), first.size());
  const auto count = static_cast<std::size_t>(stream.gcount());
  if (count == 0 || std::equal(first.begin(), first.end(), kMcapMagic.begin())) return;
  throw InputError(file.string() + ": is no recording, and is not replaced by one");
}

[[noreturn]] void refuse_written(const std::filesystem::path& file) {
  throw InputError(file.string() + ": another program is writing it");
}

/// Its writer holds a lock; the question gives it back at once.
void refuse_to_replace_what_is_written(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return;
  const bool written = ::flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  if (written) refuse_written(file);
}

}  // namespace

void check_recording_target(const std::filesystem::path& file) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(file.string() + ": cannot be recorded to: " + why);
  };
  std::error_code none;
  const auto type = std::filesystem::symlink_status(file, none).type();
  if (type != std::filesystem::file_type::not_found &&
      !std::filesystem::is_regular_file(file, none))
    refuse("it is there and no regular file");
  // Not only what the file's mode says: parts may come beside it.
  for (const auto& name : {file, std::filesystem::path(file.string() + ".part")}) {
    if (const std::string why = why_not_writable(name); !why.empty()) refuse(why);
  }
  refuse_to_replace_what_is_no_recording(file);
  refuse_to_replace_what_is_written(file);
}

McapWriter::McapWriter(Names names) : file_(names.file), named_(names.named) {}

// Delegated: where this throws, the destructor closes what is open, and its lock.
McapWriter::McapWriter(const std::filesystem::path& file, const std::filesystem::path& named)
    : McapWriter(Names{file, named}) {
  refuse_to_replace_what_is_no_recording(file);
  descriptor_ = ::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644);
  if (descriptor_ < 0) fail("open", errno);
  if (std::filesystem::is_regular_file(file)) empty();
  pending_.assign(kMcapMagic.begin(), kMcapMagic.end());
  appended(kMcapMagic.size());
  append(McapOpcode::kHeader, content_of(McapHeader{"", "palpate"}));  // no profile: schemas tell
  marks_.clear();                                                      // none without a header
  flush();
}

/// By nobody while another writes it; the kernel gives the lock back with the descriptor.
void McapWriter::empty() {
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) refuse_written(named_);
  if (::ftruncate(descriptor_, 0) != 0) fail("empty", errno);
}

McapWriter::~McapWriter() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::uint16_t McapWriter::add_schema(McapSchema schema) {
  PALPATE_DEMAND(schemas_.size() < 0xFFFF);
  schema.id = static_cast<std::uint16_t>(schemas_.size() + 1);
  append(McapOpcode::kSchema, content_of(schema));
  schemas_.push_back(std::move(schema));
  statistics_.schema_count = static_cast<std::uint16_t>(schemas_.size());
  return schemas_.back().id;
}

std::uint16_t McapWriter::add_channel(McapChannel channel) {
  PALPATE_DEMAND(channel.schema_id <= schemas_.size() && channels_.size() < 0xFFFF);
  channel.id = static_cast<std::uint16_t>(channels_.size() + 1);
  append(McapOpcode::kChannel, content_of(channel));
  channels_.push_back(std::move(channel));
  statistics_.channel_count = static_cast<std::uint32_t>(channels_.size());
  return channels_.back().id;
}

void McapWriter::add_message(const McapMessage& message, std::span<const std::uint8_t> data) {
  PALPATE_DEMAND(message.channel_id >= 1 && message.channel_id <= channels_.size());
  chunk_.add(message, data);

  McapStatistics& s = statistics_;
  const bool first = s.message_count == 0;
  s.message_start_time_ns =
      first ? message.log_time_ns : std::min(s.message_start_time_ns, message.log_time_ns);
  s.message_end_time_ns = std::max(s.message_end_time_ns, message.log_time_ns);
  ++s.message_count;
  ++s.channel_message_counts[message.channel_id];
  if (chunk_.due()) end_chunk();
}

void McapWriter::end_chunk() {
  if (chunk_.empty()) return;
  mark();
  const std::size_t before = pending_.size();
  chunks_.push_back(chunk_.finish(offset_, pending_));
  ++statistics_.chunk_count;
  in_chunks_ = statistics_;
  appended(pending_.size() - before);
}

void McapWriter::add_metadata(const McapMetadata& metadata) {
  const std::uint64_t offset = offset_;
  append(McapOpcode::kMetadata, content_of(metadata));
  ByteWriter(metadata_indexes_.emplace_back())
      .u64(offset)
      .u64(offset_ - offset)
      .text(metadata.name);
  ++statistics_.metadata_count;
}

void McapWriter::add_attachment(const McapAttachment& attachment) {
  const std::uint64_t offset = offset_;
  append(McapOpcode::kAttachment, content_of(attachment));
  ByteWriter(attachment_indexes_.emplace_back())
      .u64(offset)
      .u64(offset_ - offset)
      .u64(attachment.log_time_ns)
      .u64(0)  // when it was made
      .u64(attachment.data.size())
      .text(attachment.name)
      .text(attachment.media_type);
  ++statistics_.attachment_count;
}

void McapWriter::append(McapOpcode opcode, std::span<const std::uint8_t> content) {
  PALPATE_DEMAND(descriptor_ >= 0);
  mark();
  const std::size_t before = pending_.size();
  append_record(pending_, opcode, content);
  appended(pending_.size() - before);
}

void McapWriter::appended(std::size_t bytes) {
  offset_ += bytes;
  crc_ = crc32(std::span(pending_).last(bytes), crc_);
  if (pending_.size() >= kFlushBytes) flush();
}

void McapWriter::mark() {
  marks_.push_back({offset_, crc_, schemas_.size(), channels_.size(), chunks_.size(),
                    attachment_indexes_.size(), metadata_indexes_.size(), in_chunks_});
  if (marks_.size() > kMarks) marks_.pop_front();
}

void McapWriter::go_back_to(const Mark& mark) {
  offset_ = mark.offset;
  crc_ = mark.crc;
  pending_.clear();
  schemas_.resize(mark.schemas);
  channels_.resize(mark.channels);
  chunks_.resize(mark.chunks);
  attachment_indexes_.resize(mark.attachments);
  metadata_indexes_.resize(mark.metadata);
  statistics_ = mark.messages;
  statistics_.schema_count = static_cast<std::uint16_t>(mark.schemas);
  statistics_.channel_count = static_cast<std::uint32_t>(mark.channels);
  statistics_.chunk_count = static_cast<std::uint32_t>(mark.chunks);
  statistics_.attachment_count = static_cast<std::uint32_t>(mark.attachments);
  statistics_.metadata_count = static_cast<std::uint32_t>(mark.metadata);
}

/// Where no more can be written: at the latest place from which the summary fits.
/// @returns false if there is none: then no message fits, and the file goes
bool McapWriter::end_short() {
  const std::uint64_t written = offset_ - pending_.size();
  if (marks_.empty() && statistics_.message_count == 0) remove_empty();  // not even a header fits
  const std::deque<Mark> places = std::exchange(marks_, {});
  for (auto place = places.rbegin(); place != places.rend(); ++place) {
    if (place->offset > written) continue;
    if (place->messages.message_count == 0) {
      remove_empty();
      break;
    }
    const auto end = static_cast<off_t>(place->offset);
    if (::ftruncate(descriptor_, end) != 0 || ::lseek(descriptor_, end, SEEK_SET) != end) break;
    go_back_to(*place);
    append_end();
    if (write_pending() != 0) continue;
    ::close(std::exchange(descriptor_, -1));
    return true;
  }
  return false;
}

/// It would refuse the next try.
void McapWriter::remove_empty() {
  std::error_code none;
  if (std::filesystem::is_regular_file(file_, none)) std::filesystem::remove(file_, none);
  ::close(std::exchange(descriptor_, -1));
}

void McapWriter::flush() {
  const int failure = write_pending();
  if (failure == 0) return;
  if (is_disk_full(failure) && end_short()) throw DiskFull(why_failed(named_, "write", failure));
  fail("write", failure);
}

/// @returns the system's reason where not all could be; 0 if all was
int McapWriter::write_pending() {
  std::size_t done = 0;
  int failure = 0;
  while (done < pending_.size() && failure == 0) {
    const ssize_t written = ::write(descriptor_, pending_.data() + done, pending_.size() - done);
    if (written >= 0) done += static_cast<std::size_t>(written);
    if (written < 0 && errno != EINTR) failure = errno;
  }
  pending_.erase(pending_.begin(), pending_.begin() + static_cast<std::ptrdiff_t>(done));
  return failure;
}

void McapWriter::close() {
  if (descriptor_ < 0) return;
  end_chunk();
  flush();
  append_end();
  flush();
  const char* const gone = why_gone();
  if (::close(std::exchange(descriptor_, -1)) != 0) fail("close", errno);
  if (*gone != '\0') throw std::runtime_error(named_.string() + ": " + gone);
}

/// What was removed, moved or cut meanwhile took the recording along; empty: nothing was.
const char* McapWriter::why_gone() const {
  struct stat open {
  }, named{};
  if (::fstat(descriptor_, &open) != 0) fail("look at", errno);
  if (!S_ISREG(open.st_mode)) return "";
  const bool there = ::stat(file_.c_str(), &named) == 0;
  if (!there || named.st_ino != open.st_ino || named.st_dev != open.st_dev) {
    return "was removed or replaced while it was recorded";
  }
  std::array<char, kMcapMagic.size()> begin{};
  std::ifstream(file_, std::ios::binary).read(begin.data(), begin.size());
  const bool as_begun = std::memcmp(begin.data(), kMcapMagic.data(), begin.size()) == 0;
  return as_begun ? "" : "was cut while it was recorded";
}

/// With the CRC of all before it.
void McapWriter::append_end() {
  McapContent content;
  ByteWriter(content).u32(crc_);
  mark();
  const std::size_t before = pending_.size();
  append_record(pending_, McapOpcode::kDataEnd, content);
  offset_ += pending_.size() - before;
  append_summary();
}

// Each kind of record as one group, then one offset per group.
void McapWriter::append_summary() {
  std::vector<std::pair<McapOpcode, std::vector<McapContent>>> groups{
      {McapOpcode::kSchema, contents_of(schemas_)},
      {McapOpcode::kChannel, contents_of(channels_)},
      {McapOpcode::kStatistics, {content_of(statistics_)}},
      {McapOpcode::kChunkIndex, contents_of(chunks_)},
      {McapOpcode::kAttachmentIndex, attachment_indexes_},
      {McapOpcode::kMetadataIndex, metadata_indexes_}};
  std::vector<std::uint8_t> summary, offsets;
  for (const auto& [opcode, contents] : groups) {
    if (contents.empty()) continue;
    const std::uint64_t start = summary.size();
    for (const auto& content : contents) append_record(summary, opcode, content);
    McapContent content;
    ByteWriter(content)
        .u8(static_cast<std::uint8_t>(opcode))
        .u64(offset_ + start)
        .u64(summary.size() - start);
    append_record(offsets, McapOpcode::kSummaryOffset, content);
  }
  const std::uint64_t offsets_start = offset_ + summary.size();
  ByteWriter(summary).raw(offsets);
  // The CRC covers the summary and the footer up to the CRC itself.
  ByteWriter(summary)
      .u8(static_cast<std::uint8_t>(McapOpcode::kFooter))
      .u64(kFooterBytes)
      .u64(offset_)
      .u64(offsets_start);
  ByteWriter(summary).u32(crc32(summary)).raw(kMcapMagic);
  ByteWriter(pending_).raw(summary);
  offset_ += summary.size();
}

void McapWriter::fail(const char* doing, int system_error) const {
  throw std::runtime_error(why_failed(named_, doing, system_error));
}

}  // namespace palpate::recording
