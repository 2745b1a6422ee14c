// The flat part of the picture as plain lists: rectangles, lines, text, in window pixels with the
// origin at the lower left.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "visualizer/camera.h"
#include "visualizer/color_map.h"
#include "visualizer/draw_list.h"
#include "visualizer/interaction.h"
#include "visualizer/scene_view.h"
#include "visualizer/view_options.h"

namespace palpate::visualizer {

struct Box2 {
  double x = 0, y = 0, width = 0, height = 0;
  double right() const { return x + width; }
  double top() const { return y + height; }
  bool contains(double px, double py) const {
    return px >= x && px <= right() && py >= y && py <= top();
  }
};

enum class Align { kLeft, kCenter, kRight };

struct RectItem {
  Box2 box;
  Rgb color{};
  double opacity = 1;
};

struct PolylineItem {
  std::vector<float> points;  ///< x, y of each point
  Rgb color{};
  double width = 1;
  double opacity = 1;
};

/// One line of text; y is the middle of its height.
struct TextItem {
  double x = 0, y = 0;
  std::string text;
  int size = 13;  ///< [pixels]
  Rgb color{};
  Align align = Align::kLeft;
  bool bold = false;
  double angle = 0;  ///< counter-clockwise [degrees]
};

struct Overlay {
  std::vector<RectItem> rects;
  std::vector<PolylineItem> lines;
  std::vector<TextItem> texts;
};

namespace palette {
inline constexpr Rgb kText{232, 236, 241}, kQuiet{158, 168, 182}, kPanel{22, 27, 36},
    kFrame{74, 84, 99}, kGood{126, 217, 150}, kWarning{255, 196, 84}, kBad{255, 110, 104},
    kCurve{126, 203, 255};
}  // namespace palette

/// Where a text lies, by the mean advance of DejaVu Sans (0.6 of the size, bold 0.68).
Box2 extent_of(const TextItem& text);
bool overlap(const Box2& a, const Box2& b);
/// The text no wider than `width`: smaller, down to 9 pixels, then cut.
TextItem fitted(TextItem text, double width);
/// What lies under a panel is not drawn over it.
void clear_under(const Box2& panel, Overlay& out);

/// Places of the window's parts.
struct Layout {
  double scale = 1;           ///< of texts and lines: 1 up to 1919 × 1079, 3 on 3840 × 2160
  Box2 scene;                 ///< the 3-D part, from the lower left corner
  std::array<Box2, 3> plots;  ///< volume error, pressure, force
  Box2 table;
};
Layout make_layout(int width, int height);

/// The flat parts of the picture: title, colour bar, plots, table, arrow labels, notices, help.
/// @param now_ns  monotonic clock, for ages
Overlay make_overlay(const SceneView& view, const DrawList& list, const Interaction& interaction,
                     const Layout& layout, std::int64_t now_ns);

// The parts, each appended to `out`.
void add_title(const SceneView& view, const ViewOptions& options, const Box2& box,
               std::int64_t now_ns, Overlay& out);
void add_color_bar(const SceneView& view, Coloring coloring, const Box2& box, Overlay& out);
/// Beside the arrows' tips, moved off other texts; none where there is no room.
void add_arrow_labels(const DrawList& list, const Camera& camera, Overlay& out);
void add_help(const Box2& box, Overlay& out);

}  // namespace palpate::visualizer
