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
  /// As end(). It ends by itself, too, if this process dies.
  ~RecorderChild();
  RecorderChild(const RecorderChild&) = delete;
  RecorderChild& operator=(const RecorderChild&) = delete;

  bool running();  ///< false once it has ended by itself
  /// Ends it and waits until it has written the end, ten seconds at most: then it is killed.
  /// @returns whether the recording is whole, by its exit code
  bool end();
  const std::filesystem::path& file() const { return file_; }

 private:
  std::filesystem::path file_;
  pid_t process_id_ = -1;  ///< -1: it has ended
  bool whole_ = false;     ///< once it has ended
};

}  // namespace palpate::visualizer
