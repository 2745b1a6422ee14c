// A picture's way from memory into a window of an X server on the same host, by shared memory.
//
// Without a graphics card OpenGL draws into memory anyway; VTK's way from there to the window (a
// textured rectangle, then a swap of buffers) takes as much time as drawing an organ.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

struct _XDisplay;

namespace palpate::visualizer {

class SharedPicture {
 public:
  /// None where the server is on another host, has no shared memory, or its pixels are not 32 bits
  /// of blue, green, red.
  static std::unique_ptr<SharedPicture> make(_XDisplay* display, unsigned long window);
  ~SharedPicture();
  SharedPicture(const SharedPicture&) = delete;
  SharedPicture& operator=(const SharedPicture&) = delete;

  /// Shows red, green, blue, alpha bytes, rows from the bottom up  (width × height × 4).
  /// @returns false if it could not; nothing is shown then
  bool show(std::span<const std::uint8_t> rgba, int width, int height);

 private:
  struct Impl;
  explicit SharedPicture(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::visualizer
