// The scene of a recording with its files where they are now: those that are not where they were,
// or not what they were, come from the recording itself, which has them attached.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "modules/messages/messages.h"
#include "modules/recording/mcap_records.h"

namespace palpate::launcher {

class UnpackedScene {
 public:
  /// @param folder  for the scene and files of the recording, which have to be looked at as long as
  ///                these are there
  /// @param log     told of each file that is taken from the recording
  /// @throws InputError as recorded_scene() does
  UnpackedScene(const std::filesystem::path& recording, const std::filesystem::path& folder,
                std::ostream& log);

  /// As it was told, but for the names of files.
  const SceneDescription& here() const { return here_; }
  const std::filesystem::path& file() const { return file_; }

  /// A resolved text with the names of files as they were told.
  std::string as_told(const std::string& resolved_text) const;
  /// What was taken from the recording, for one that is made of it.
  const std::vector<recording::McapAttachment>& taken() const { return taken_; }

 private:
  std::filesystem::path placed(const std::filesystem::path& named,
                               const recording::McapAttachment& attached,
                               const std::filesystem::path& folder, std::ostream& log);

  SceneDescription here_;
  std::filesystem::path file_;
  std::map<std::filesystem::path, std::filesystem::path> told_;  ///< names, by where files are now
  std::vector<recording::McapAttachment> taken_;
};

}  // namespace palpate::launcher
