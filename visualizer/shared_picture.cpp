#include "visualizer/shared_picture.h"

#include <X11/Xlib.h>
#include <X11/Xutil.h>
#include <X11/extensions/XShm.h>
#include <sys/ipc.h>
#include <sys/shm.h>

#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate::visualizer {
namespace {

bool on_this_host(Display* display) {
  const std::string_view name = DisplayString(display);
  return name.starts_with(":") || name.starts_with("unix:");
}

/// Said by the handler of Xlib's errors, which knows nobody else.
bool refused = false;

/// False where the server cannot: it is of another user or IPC namespace, as in a container. Xlib's
/// own handler would end the program.
bool attach(Display* display, XShmSegmentInfo& segment) {
  XSync(display, False);  // errors of before are another handler's
  refused = false;
  const auto before = XSetErrorHandler([](Display*, XErrorEvent*) {
    refused = true;
    return 0;
  });
  const bool asked = XShmAttach(display, &segment) != 0;
  XSync(display, False);
  XSetErrorHandler(before);
  return asked && !refused;
}

/// Bytes R, G, B, A as one little-endian number → B, G, R, A.
std::uint32_t red_and_blue_swapped(std::uint32_t rgba) {
  return (rgba & 0xff00ff00u) | ((rgba & 0xffu) << 16) | ((rgba >> 16) & 0xffu);
}

}  // namespace

struct SharedPicture::Impl {
  Display* display = nullptr;
  Window window = 0;
  XWindowAttributes attributes{};
  GC context = nullptr;
  XShmSegmentInfo segment{};
  XImage* image = nullptr;
  bool attached = false;  ///< by the server, too

  /// None is left if it could not.
  bool make_image(int width, int height) {
    drop_image();
    image = XShmCreateImage(display, attributes.visual, static_cast<unsigned>(attributes.depth),
                            ZPixmap, nullptr, &segment, static_cast<unsigned>(width),
                            static_cast<unsigned>(height));
    attached = image != nullptr && image->bits_per_pixel == 32 && share_memory();
    if (!attached) drop_image();
    return attached;
  }

  bool share_memory() {
    const auto size = static_cast<std::size_t>(image->bytes_per_line) * std::size_t(image->height);
    segment.shmid = shmget(IPC_PRIVATE, size, IPC_CREAT | 0600);
    if (segment.shmid < 0) return false;
    void* memory = shmat(segment.shmid, nullptr, 0);
    const bool mapped = memory != reinterpret_cast<void*>(-1);
    if (mapped) segment.shmaddr = image->data = static_cast<char*>(memory);
    segment.readOnly = True;
    const bool done = mapped && attach(display, segment);
    shmctl(segment.shmid, IPC_RMID, nullptr);  // gone with the last that holds it, however it ends
    return done;
  }

  void drop_image() {
    if (image == nullptr) return;
    if (attached) {
      XShmDetach(display, &segment);
      XSync(display, False);
    }
    if (segment.shmaddr != nullptr) shmdt(segment.shmaddr);
    attached = false;
    image->data = nullptr;
    XDestroyImage(image);
    image = nullptr;
    segment = {};
  }
};

SharedPicture::SharedPicture(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

SharedPicture::~SharedPicture() {
  impl_->drop_image();
  XFreeGC(impl_->display, impl_->context);
}

std::unique_ptr<SharedPicture> SharedPicture::make(Display* display, unsigned long window) {
  if (!on_this_host(display) || XShmQueryExtension(display) == False) return nullptr;
  auto impl = std::make_unique<Impl>();
  impl->display = display;
  impl->window = window;
  XGetWindowAttributes(display, window, &impl->attributes);
  const Visual& visual = *impl->attributes.visual;
  if (visual.red_mask != 0xff0000 || visual.green_mask != 0xff00 || visual.blue_mask != 0xff ||
      ImageByteOrder(display) != LSBFirst) {
    return nullptr;
  }
  impl->context = XCreateGC(display, window, 0, nullptr);
  return std::unique_ptr<SharedPicture>(new SharedPicture(std::move(impl)));
}

bool SharedPicture::show(std::span<const std::uint8_t> rgba, int width, int height) {
  if (rgba.size() < 4 * std::size_t(width) * std::size_t(height)) return false;
  XImage*& image = impl_->image;
  if (image == nullptr || image->width != width || image->height != height) {
    if (!impl_->make_image(width, height)) return false;
  }
  std::vector<std::uint32_t> row(static_cast<std::size_t>(width));
  for (int y = 0; y < height; ++y) {
    const std::size_t length = 4 * row.size();
    std::memcpy(row.data(), rgba.data() + length * std::size_t(height - 1 - y), length);
    for (std::uint32_t& pixel : row) pixel = red_and_blue_swapped(pixel);
    std::memcpy(image->data + std::size_t(image->bytes_per_line) * std::size_t(y), row.data(),
                length);
  }
  XShmPutImage(impl_->display, impl_->window, impl_->context, image, 0, 0, 0, 0,
               static_cast<unsigned>(width), static_cast<unsigned>(height), False);
  XSync(impl_->display, False);  // the memory is written again for the next picture
  return true;
}

}  // namespace palpate::visualizer
