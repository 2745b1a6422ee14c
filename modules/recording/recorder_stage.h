// The recorder of a lockstep session. What it writes depends on the samples alone: two runs of the
// same scene leave the same bytes.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <vector>

#include "modules/recording/recorder.h"
#include "modules/runtime/stage.h"

namespace palpate::recording {

/// Writes every sample of the topics that carry physics (runtime::session_wires()), in the order of
/// source time, topic, key and sequence number, stamped with simulated time. Statuses and commands
/// tell of the machine and are left out.
class RecorderStage : public runtime::Stage {
 public:
  /// @throws std::runtime_error naming the file if it cannot be written
  RecorderStage(bus::Bus& bus, const std::filesystem::path& file, TopicSelection topics = {});
  ~RecorderStage() override;  ///< ends the file, if finish() did not: by a signal, or a failure
  runtime::Health cycle(const runtime::Cycle& now) override;
  void finish(const runtime::Cycle& now) override;

  void add_metadata(const McapMetadata& metadata) { file_.add_metadata(metadata); }
  void add_attachment(const McapAttachment& attachment) { file_.add_attachment(attachment); }
  const SampleFile& file() const { return file_; }

 private:
  void write_all();
  void while_there_is_room(const std::function<void()>& write) const;

  std::vector<std::unique_ptr<bus::Input>> inputs_;
  std::vector<TopicSample> samples_;
  SampleFile file_;
  SpaceWatch space_;
  std::filesystem::path name_;
};

}  // namespace palpate::recording
