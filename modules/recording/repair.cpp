#include "modules/recording/repair.h"

#include <map>

#include "modules/core/error.h"
#include "modules/core/whole_file.h"
#include "modules/recording/mcap_reader.h"
#include "modules/recording/mcap_writer.h"
#include "modules/recording/recorder.h"
#include "modules/recording/sample_reader.h"

namespace palpate::recording {
namespace {

constexpr std::uint32_t kMostIds = 0xFFFF;

/// Puts records into a file that numbers schemas and channels itself.
class Copy {
 public:
  Copy(const std::filesystem::path& file, const std::filesystem::path& named)
      : writer_(file, named) {}

  /// The numbers of its schemas and channels are its own.
  void begin_part() {
    ++parts_;
    writer_.end_chunk();  // its clocks, which come next, are for what comes behind them
    schemas_.clear();
    channels_.clear();
  }
  void operator()(const McapSchema& schema) {
    if (schemas_.contains(schema.id)) return;
    demand_id(writer_.statistics().schema_count);
    schemas_[schema.id] = writer_.add_schema(schema);
  }
  void operator()(McapChannel channel) {
    const std::uint16_t id = channel.id;
    if (channels_.contains(id)) return;
    demand_id(writer_.statistics().channel_count);
    if (channel.schema_id != 0) channel.schema_id = schemas_.at(channel.schema_id);
    channels_[id] = writer_.add_channel(std::move(channel));
  }
  void operator()(McapMessage message) {
    message.channel_id = channels_.at(message.channel_id);
    writer_.add_message(message, message.data);
  }
  void operator()(const McapMetadata& metadata) {
    if (parts_ > 1 && metadata.name == kCostMetadata) return;  // true of its part alone
    writer_.add_metadata(metadata);
  }
  void operator()(const McapAttachment& attachment) { writer_.add_attachment(attachment); }

  std::uint64_t close() {
    writer_.close();
    return writer_.statistics().message_count;
  }

 private:
  static void demand_id(std::uint32_t used) {
    if (used >= kMostIds) throw InputError("more schemas or channels than one recording can have");
  }

  int parts_ = 0;
  McapWriter writer_;
  std::map<std::uint16_t, std::uint16_t> schemas_, channels_;
};

McapMap session_of(const std::filesystem::path& file) {
  McapReader reader(file, McapDamage::kSkip);
  while (const auto record = reader.next()) {
    const auto* metadata = std::get_if<McapMetadata>(&*record);
    if (metadata != nullptr && metadata->name == kSessionMetadata) return metadata->entries;
    if (std::holds_alternative<McapMessage>(*record)) break;  // it comes before them
  }
  return {};
}

/// As a SampleReader goes on, though what they hold may be damaged.
std::vector<std::filesystem::path> parts_of(const std::filesystem::path& recording,
                                            std::vector<std::string>& warnings) {
  std::vector<std::filesystem::path> parts{recording};
  McapMap before = session_of(recording);
  for (auto number = part_after(recording, 1); number; number = part_after(recording, *number)) {
    const auto part = part_of(recording, *number);
    try {
      McapMap session = session_of(part);
      if (!goes_on(before, session)) {
        warnings.push_back(part.string() +
                           ": of another session, or begun earlier; this part is left out");
        break;
      }
      before = std::move(session);
      parts.push_back(part);
    } catch (const InputError& unreadable) {
      warnings.push_back(std::string(unreadable.what()) + "; this part is left out");
    }
  }
  return parts;
}

}  // namespace

RepairReport repair(const std::filesystem::path& damaged, const std::filesystem::path& repaired) {
  RepairReport report;
  const auto parts = parts_of(damaged, report.warnings);  // before one may be made of that name
  std::error_code none;
  if (std::filesystem::exists(repaired, none)) {
    throw InputError(repaired.string() +
                     ": is there already; a repaired recording replaces nothing");
  }
  check_recording_target(repaired);
  FileInTheMaking making(repaired);
  Copy copy(making.part(), repaired);
  for (const auto& part : parts) {
    McapReader reader(part, McapDamage::kSkip);
    copy.begin_part();
    while (auto record = reader.next()) std::visit(copy, std::move(*record));
    report.skipped += reader.skipped();
    report.torn |= reader.torn();
  }
  report.samples = copy.close();
  making.finish();
  report.parts = static_cast<int>(parts.size());
  return report;
}

}  // namespace palpate::recording
