#include "modules/recording/repair.h"

#include <map>

#include "modules/core/error.h"
#include "modules/recording/mcap_reader.h"
#include "modules/recording/mcap_writer.h"

namespace palpate::recording {
namespace {

/// Puts records into a file that numbers schemas and channels itself.
class Copy {
 public:
  explicit Copy(const std::filesystem::path& file) : writer_(file) {}

  void operator()(const McapSchema& schema) {
    if (!schemas_.contains(schema.id)) schemas_[schema.id] = writer_.add_schema(schema);
  }
  void operator()(McapChannel channel) {
    const std::uint16_t id = channel.id;
    if (channels_.contains(id)) return;
    if (channel.schema_id != 0) channel.schema_id = schemas_.at(channel.schema_id);
    channels_[id] = writer_.add_channel(std::move(channel));
  }
  void operator()(McapMessage message) {
    message.channel_id = channels_.at(message.channel_id);
    writer_.add_message(message, message.data);
  }
  void operator()(const McapMetadata& metadata) { writer_.add_metadata(metadata); }
  void operator()(const McapAttachment& attachment) { writer_.add_attachment(attachment); }

  std::uint64_t close() {
    writer_.close();
    return writer_.statistics().message_count;
  }

 private:
  McapWriter writer_;
  std::map<std::uint16_t, std::uint16_t> schemas_, channels_;
};

}  // namespace

RepairReport repair(const std::filesystem::path& damaged, const std::filesystem::path& repaired) {
  McapReader reader(damaged, McapDamage::kSkip);
  std::error_code none;
  if (std::filesystem::exists(repaired, none)) {
    throw InputError(repaired.string() +
                     ": is there already; a repaired recording replaces nothing");
  }
  Copy copy(repaired);
  while (auto record = reader.next()) std::visit(copy, std::move(*record));
  return {copy.close(), reader.skipped(), reader.torn()};
}

}  // namespace palpate::recording
