#include "modules/recording/repair.h"

#include <algorithm>
#include <map>
#include <set>

#include "modules/core/error.h"
#include "modules/core/text.h"
#include "modules/core/whole_file.h"
#include "modules/recording/mcap_bytes.h"
#include "modules/recording/mcap_codec.h"
#include "modules/recording/mcap_reader.h"
#include "modules/recording/mcap_writer.h"
#include "modules/recording/own_types.h"
#include "modules/recording/recorder.h"
#include "modules/recording/sample_reader.h"
#include "modules/runtime/program.h"

namespace palpate::recording {
namespace {

constexpr std::uint32_t kMostIds = 0xFFFF;

/// What a part of a recording says of itself, beside its records.
struct Part {
  std::filesystem::path file;
  bool own = false;  ///< recorded by this version: its types are known
  std::optional<McapSummary> summary;
};

/// Puts records into a file that numbers schemas and channels itself.
class Copy {
 public:
  Copy(const std::filesystem::path& file, const std::filesystem::path& named)
      : writer_(file, named) {}

  /// The numbers of its schemas and channels are its own. What its summary says of them, which has
  /// a CRC, counts; else of a damaged one of this version its samples are left out.
  void begin_part(const Part& part) {
    ++parts_;
    writer_.end_chunk();  // its clocks, which come next, are for what comes behind them
    part_ = &part;
    schemas_.clear();
    channels_.clear();
    types_.clear();
    repeated_.clear();
    if (!part.summary) return;
    for (const auto& [id, schema] : part.summary->schemas) add(schema);
    for (const auto& [id, channel] : part.summary->channels) add(channel);
  }
  /// @returns how many of the summary's the data section did not have, or had otherwise
  std::size_t mended() const {
    if (!part_->summary) return 0;
    return part_->summary->schemas.size() + part_->summary->channels.size() - repeated_.size();
  }
  void operator()(const McapSchema& schema) {
    if (!part_->summary) return add(schema);
    note(part_->summary->schemas, schema);
  }
  void operator()(const McapChannel& channel) {
    if (!part_->summary) return add(channel);
    note(part_->summary->channels, channel);
  }
  void operator()(McapMessage message) {
    const auto channel = channels_.find(message.channel_id);
    if (channel == channels_.end()) {
      ++left_out_;
      return;
    }
    message.channel_id = channel->second;
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
  std::uint64_t left_out() const { return left_out_; }
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  void add(const McapSchema& schema) {
    if (types_.contains(schema.id)) return;
    types_[schema.id] = schema.name;
    if (is_left_out(why_foreign(schema))) return;
    demand_id(writer_.statistics().schema_count);
    schemas_[schema.id] = writer_.add_schema(schema);
  }
  void add(McapChannel channel) {
    const std::uint16_t id = channel.id;
    if (channels_.contains(id)) return;
    const bool has_type = channel.schema_id == 0 || schemas_.contains(channel.schema_id);
    if (!has_type || is_left_out(why_foreign(channel, types_[channel.schema_id]))) return;
    demand_id(writer_.statistics().channel_count);
    if (channel.schema_id != 0) channel.schema_id = schemas_.at(channel.schema_id);
    channels_[id] = writer_.add_channel(std::move(channel));
  }
  /// A type of another version is kept as it is: only that version reads it.
  bool is_left_out(const std::string& foreign) {
    if (!part_->own || foreign.empty()) return false;
    warnings_.push_back(part_->file.string() + ": " + printable(foreign) +
                        ", or damaged; its samples are left out");
    return true;
  }
  void note(const auto& of_summary, const auto& definition) {
    const auto known = of_summary.find(definition.id);
    if (known == of_summary.end()) return;
    McapContent content = content_of(known->second);
    if (content == content_of(definition)) repeated_.insert(std::move(content));
  }
  static void demand_id(std::uint32_t used) {
    if (used >= kMostIds) throw InputError("more schemas or channels than one recording can have");
  }

  int parts_ = 0;
  McapWriter writer_;
  const Part* part_ = nullptr;
  std::map<std::uint16_t, std::uint16_t> schemas_, channels_;
  std::map<std::uint16_t, std::string> types_;  ///< by schema, those left out, too
  std::set<McapContent> repeated_;              ///< of the summary, in the data section
  std::uint64_t left_out_ = 0;
  std::vector<std::string> warnings_;
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

/// One that lacks the schema of a channel is of no use.
std::optional<McapSummary> copies_in(const std::filesystem::path& file) {
  std::optional<McapSummary> summary = sound_summary(file);
  if (!summary || summary->channels.empty()) return std::nullopt;
  const bool whole = std::ranges::all_of(summary->channels, [&](const auto& channel) {
    return channel.second.schema_id == 0 || summary->schemas.contains(channel.second.schema_id);
  });
  return whole ? summary : std::nullopt;
}

Part part_at(const std::filesystem::path& file) {
  const McapMap session = session_of(file);
  const auto version = session.find("version");
  return {file, version != session.end() && version->second == runtime::version_text(),
          copies_in(file)};
}

/// @throws InputError if what was written of a recording of this version is none
void check_readable(const std::filesystem::path& written, const std::filesystem::path& damaged) {
  try {
    SampleReader reader(written);
    while (reader.next()) {
    }
  } catch (const InputError& error) {
    const std::string what = error.what();
    throw InputError(damaged.string() + ": cannot be mended: what is left of it is no recording" +
                     what.substr(std::min(what.size(), written.string().size())));
  }
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
  bool own = true;
  for (const auto& file : parts) {
    const Part part = part_at(file);
    own = own && part.own;
    McapReader reader(file, McapDamage::kSkip);
    if (part.summary) reader.take(*part.summary);
    copy.begin_part(part);
    while (auto record = reader.next()) std::visit(copy, std::move(*record));
    report.mended += copy.mended();
    report.skipped += reader.skipped();
    report.samples_left_out += reader.undefined_messages();
    report.torn |= reader.torn();
  }
  report.samples = copy.close();
  report.samples_left_out += copy.left_out();
  report.warnings.insert(report.warnings.end(), copy.warnings().begin(), copy.warnings().end());
  if (own) check_readable(making.part(), damaged);
  making.finish();
  report.parts = static_cast<int>(parts.size());
  return report;
}

}  // namespace palpate::recording
