#include "tests/visualizer/fake_mouse.h"

#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include <stdexcept>

namespace palpate::visualizer::testing {
namespace {

void send(Display* display, Window window, XEvent& event, long mask) {
  XSendEvent(display, window, True, mask, &event);
  XFlush(display);
}

XEvent button_event(Display* display, Window window, int type, int x, int y, unsigned state) {
  XEvent event{};
  event.xbutton.type = type;
  event.xbutton.display = display;
  event.xbutton.window = window;
  event.xbutton.x = x;
  event.xbutton.y = y;
  event.xbutton.state = state;
  event.xbutton.button = Button1;
  event.xbutton.same_screen = True;
  return event;
}

}  // namespace

FakeMouse::FakeMouse() : display_(XOpenDisplay(nullptr)) {
  if (display_ == nullptr) throw std::runtime_error("no X display");
}

FakeMouse::~FakeMouse() { XCloseDisplay(display_); }

bool FakeMouse::find_window(const std::string& title) {
  Window root = 0, parent = 0, *children = nullptr;
  unsigned count = 0;
  XQueryTree(display_, DefaultRootWindow(display_), &root, &parent, &children, &count);
  for (unsigned i = 0; i < count; ++i) {
    char* name = nullptr;
    if (XFetchName(display_, children[i], &name) != 0 && title == name) window_ = children[i];
    if (name != nullptr) XFree(name);
  }
  if (children != nullptr) XFree(children);
  return window_ != 0;
}

void FakeMouse::press(int x, int y, bool shift) {
  XEvent event = button_event(display_, window_, ButtonPress, x, y, shift ? ShiftMask : 0);
  send(display_, window_, event, ButtonPressMask);
}

void FakeMouse::move(int x, int y) {
  // The window asks the server where the pointer is.
  XWarpPointer(display_, None, window_, 0, 0, 0, 0, x, y);
  XEvent event{};
  event.xmotion.type = MotionNotify;
  event.xmotion.display = display_;
  event.xmotion.window = window_;
  event.xmotion.x = x;
  event.xmotion.y = y;
  event.xmotion.state = Button1Mask;
  event.xmotion.same_screen = True;
  send(display_, window_, event, PointerMotionMask);
}

void FakeMouse::release(int x, int y) {
  XEvent event = button_event(display_, window_, ButtonRelease, x, y, Button1Mask);
  send(display_, window_, event, ButtonReleaseMask);
}

void FakeMouse::key(const std::string& name) {
  XEvent event{};
  event.xkey.type = KeyPress;
  event.xkey.display = display_;
  event.xkey.window = window_;
  event.xkey.keycode = XKeysymToKeycode(display_, XStringToKeysym(name.c_str()));
  event.xkey.same_screen = True;
  send(display_, window_, event, KeyPressMask);
}

}  // namespace palpate::visualizer::testing
