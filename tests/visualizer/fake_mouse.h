// Sends made-up mouse and key events to a window, through the X server named by DISPLAY.
#pragma once

#include <string>

struct _XDisplay;

namespace palpate::visualizer::testing {

class FakeMouse {
 public:
  FakeMouse();
  ~FakeMouse();
  FakeMouse(const FakeMouse&) = delete;
  FakeMouse& operator=(const FakeMouse&) = delete;

  /// True once a window with this title exists; events go there from then on.
  bool find_window(const std::string& title);

  // Left button, in window pixels with y down.
  void press(int x, int y, bool shift);
  void move(int x, int y);
  void release(int x, int y);
  /// A key by its X name: "space", "q", …
  void key(const std::string& name);

 private:
  _XDisplay* display_;
  unsigned long window_ = 0;
};

}  // namespace palpate::visualizer::testing
