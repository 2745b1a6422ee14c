// A recorder of the session that a key starts and ends: the program palpate-recorder, as a child.
#pragma once

#include <sys/types.h>

#include <filesystem>

#include "modules/bus/bus.h"

namespace palpate::visualizer {

class RecorderChild {
 public:
  /// Starts recording into `file`.
  /// @param program  palpate-recorder
  /// @throws std::runtime_error if no process can be made
  RecorderChild(const std::filesystem::path& program, const std::filesystem::path& file,
                const bus::BusOptions& session);
  /// Ends it and waits until the recording is whole. It ends by itself, too, if this process dies.
  ~RecorderChild();
  RecorderChild(const RecorderChild&) = delete;
  RecorderChild& operator=(const RecorderChild&) = delete;

  bool running();  ///< false once it has ended by itself: it could not record
  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  pid_t process_id_ = -1;
};

}  // namespace palpate::visualizer
