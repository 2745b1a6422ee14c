// An X display for machines without one: an Xvfb child that lives as long as this object.
#pragma once

#include <sys/types.h>

#include <memory>
#include <string>

namespace palpate::visualizer {

using XConnection = std::unique_ptr<void, void (*)(void*)>;

/// To the X server that DISPLAY names; none if there is none or it does not let us in. To be kept
/// until the window is there: some servers reset when their last client leaves, and what comes at
/// that moment dies.
XConnection connect_to_display();

/// Software OpenGL draws with one thread instead of one per core (unless LP_NUM_THREADS says
/// otherwise), so that the other processes keep theirs. Call before the first window.
void draw_with_one_thread();

class OffscreenDisplay {
 public:
  /// Starts Xvfb on a free display number, waits until it accepts clients and sets DISPLAY.
  /// @param program  name or path of Xvfb
  /// @throws std::runtime_error saying what to install if it cannot be started
  explicit OffscreenDisplay(const std::string& program = "Xvfb");
  /// Ends Xvfb. It also ends by itself if this process dies in whatever way.
  ~OffscreenDisplay();
  OffscreenDisplay(const OffscreenDisplay&) = delete;
  OffscreenDisplay& operator=(const OffscreenDisplay&) = delete;

  const std::string& name() const { return name_; }  ///< ":99"
  pid_t process_id() const { return process_id_; }

 private:
  std::string name_;
  pid_t process_id_ = -1;
};

}  // namespace palpate::visualizer
