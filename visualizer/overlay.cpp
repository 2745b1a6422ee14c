#include "visualizer/overlay.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "modules/core/text.h"
#include "visualizer/plots.h"
#include "visualizer/status_table.h"

namespace palpate::visualizer {
namespace {

constexpr double kMargin = 16;
constexpr double kStaleAge = 0.5;  // organ positions older than this are marked [s]

void add_notice(const std::string& text, const Box2& box, Overlay& out) {
  if (text.empty()) return;
  const TextItem line = fitted(
      {box.x + 0.5 * box.width, box.top() - 121, text, 13, palette::kWarning, Align::kCenter},
      box.width - 2 * kMargin);
  const Box2 around = extent_of(line);
  const Box2 panel{around.x - 10, line.y - 13, around.width + 20, 26};
  clear_under(panel, out);
  out.rects.push_back({panel, palette::kPanel, 0.85});
  out.texts.push_back(line);
}

/// Lines in the middle of a box, one below the other.
void add_panel(const std::vector<std::string>& lines, const Box2& box, Overlay& out) {
  constexpr double kLine = 22;
  const double middle = box.x + 0.5 * box.width, height = kLine * double(lines.size()) + 20;
  const double top = box.y + 0.5 * (box.height + height);
  std::vector<TextItem> texts;
  double width = 0;
  for (const std::string& line : lines) {
    const double y = top - 21 - kLine * double(texts.size());
    texts.push_back(
        fitted({middle, y, line, 13, palette::kText, Align::kCenter}, box.width - 2 * kMargin));
    width = std::max(width, extent_of(texts.back()).width + 24);
  }
  const Box2 panel{middle - 0.5 * width, top - height, width, height};
  clear_under(panel, out);
  out.rects.push_back({panel, palette::kPanel, 0.9});
  out.texts.insert(out.texts.end(), texts.begin(), texts.end());
}

std::string what_is_missing(const SceneView& view) {
  for (const OrganView& organ : view.organs()) {
    if (!organ.known) return "Waiting for the surface of organ '" + organ.name + "' ...";
  }
  return {};
}

/// What the mouse does with a probe, in words: its depth, its force, how to give it back.
void add_hand(const SceneView& view, const Interaction& interaction, Overlay& out,
              const Box2& box) {
  std::string line;
  if (const SurfacePress* press = interaction.surface_press()) {
    const ProbeView& probe = view.probes()[press->probe()];
    line = probe.description.name + text_of(": %.1f mm deep", 1000 * press->depth());
    line += text_of(", %.2f N", probe.has_force ? probe.force.force.norm() : 0.0);
  } else if (const auto held = interaction.held_probe()) {
    line = view.probes()[*held].description.name + ": held";
  } else {
    for (std::size_t i = 0; i < view.probes().size(); ++i) {
      const bool mouse =
          std::holds_alternative<scene::MouseDevice>(view.probes()[i].description.device);
      if (!interaction.taken(i) || mouse || view.ended()) continue;
      line = view.probes()[i].description.name + ": taken over; g gives it back";
    }
  }
  out.texts.push_back(
      fitted({kMargin, box.top() - 72, line, 14, palette::kWarning}, box.width - 2 * kMargin));
}

void add_scale_bar(const SceneView& view, const Camera& camera, const Box2& box, Overlay& out) {
  const double size = camera.pixel_size((camera.target - camera.position).norm());
  const double length = round_up(50 * size);
  const double pixels = length / size, x = box.x + kMargin, y = box.y + 44;
  out.rects.push_back({{x, y, pixels, 3}, palette::kText, 1});
  const bool centimetres = length >= 0.01;
  out.texts.push_back(
      {x + pixels + 8, y + 1,
       centimetres ? text_of("%g cm", 100 * length) : text_of("%g mm", 1000 * length), 12,
       palette::kText});
  out.texts.push_back(
      {x, y + 16, text_of("1 N = %g mm", 1000 * force_scale(view)), 12, palette::kQuiet});
}

}  // namespace

Box2 extent_of(const TextItem& text) {
  const double width = (text.bold ? 0.68 : 0.6) * text.size * double(text.text.size());
  const double left = text.align == Align::kLeft     ? text.x
                      : text.align == Align::kCenter ? text.x - 0.5 * width
                                                     : text.x - width;
  return {left, text.y - 0.4 * text.size, width, 0.8 * text.size};
}

bool overlap(const Box2& a, const Box2& b) {
  return a.x < b.right() && b.x < a.right() && a.y < b.top() && b.y < a.top();
}

TextItem fitted(TextItem text, double width) {
  constexpr int kSmallest = 9;
  while (text.size > kSmallest && extent_of(text).width > width) --text.size;
  if (extent_of(text).width <= width) return text;
  const double letter = extent_of(text).width / double(text.text.size());
  const auto letters = static_cast<std::size_t>(std::max(3.0, width / letter));
  text.text = std::string(cut_at_letter(text.text, letters - 3)) + "...";
  return text;
}

void clear_under(const Box2& panel, Overlay& out) {
  std::erase_if(out.texts, [&](const TextItem& text) { return overlap(panel, extent_of(text)); });
  std::erase_if(out.lines, [&](const PolylineItem& line) {
    for (std::size_t i = 0; i + 1 < line.points.size(); i += 2) {
      if (panel.contains(line.points[i], line.points[i + 1])) return true;
    }
    return false;
  });
}

Layout make_layout(int width, int height) {
  Layout layout;
  layout.scale = std::max(1.0, std::floor(2 * std::min(width / 1280.0, height / 720.0)) / 2);
  const double panel = std::min(360.0 * layout.scale, 0.4 * width);
  layout.scene = {0, 0, std::max(1.0, width - panel), double(height)};
  const double x = layout.scene.right(),
               table_height = std::min(170.0 * layout.scale, 0.3 * height);
  layout.table = {x, 0, panel, table_height};
  const double each = (height - table_height) / 3;
  for (std::size_t i = 0; i < 3; ++i) {
    layout.plots[i] = {x, height - each * double(i + 1), panel, each};
  }
  return layout;
}

void add_title(const SceneView& view, const ViewOptions& options, const Box2& box,
               std::int64_t now_ns, Overlay& out) {
  const double y = box.top() - 26;
  const double width = box.width - 2 * kMargin;
  out.texts.push_back(
      fitted({kMargin, y, view.scene().name, 20, palette::kText, Align::kLeft, true}, width));
  std::string line = text_of("t = %.2f s", view.sim_time());
  const double factor = view.real_time_factor();
  if (factor > 0) line += text_of("     real time x %.2f", factor);
  const bool paused =
      view.session().header.source_time_ns > 0 && view.session().command == SessionCommand::kPause;
  const bool steps = view.session().command == SessionCommand::kStep;
  if (view.ended()) {
    line += "     ended";
  } else if (options.slow_motion) {
    line += "     slow motion";
  } else if (paused || steps) {
    line += steps ? "     one step" : "     paused";
  }
  if (options.recording) line += "     recording";
  out.texts.push_back(fitted({kMargin, y - 24, line, 14, palette::kQuiet}, width));
  const double age = view.positions_age(now_ns);
  if (!paused && !steps && std::isfinite(age) && age > kStaleAge) {
    out.texts.push_back(
        fitted({kMargin, y - 68, text_of("no new organ shape for %.1f s", age), 14, palette::kBad},
               width));
  }
}

void add_color_bar(const SceneView& view, Coloring coloring, const Box2& box, Overlay& out) {
  constexpr int kSteps = 64;
  for (int i = 0; i < kSteps; ++i) {
    const double step = box.width / kSteps;
    out.rects.push_back(
        {{box.x + i * step, box.y, step + 0.5, box.height}, map_color((i + 0.5) / kSteps), 1});
  }
  const bool strain = coloring == Coloring::kStrain;
  const double top = strain ? 100 * view.strain_top() : 1000 * view.displacement_top();
  for (int i = 0; i <= 2; ++i) {
    out.texts.push_back({box.x + 0.5 * i * box.width, box.y - 11, text_of("%g", 0.5 * i * top), 12,
                         palette::kText, Align::kCenter});
  }
  out.texts.push_back({box.x + 0.5 * box.width, box.top() + 12,
                       strain ? "principal strain [%]" : "displacement [mm]", 13, palette::kText,
                       Align::kCenter});
}

namespace {

/// Where the label of an arrow is: at its tip, or where it leaves the view. Nothing of one that
/// begins outside.
std::optional<Pixel> end_in_view(const Camera& camera, const ArrowItem& arrow) {
  constexpr int kHalvings = 24;
  const Box2 view{0, 0, double(camera.width), double(camera.height)};
  const auto at = [&](double part) {
    return project(camera, arrow.tail + part * (arrow.tip - arrow.tail));
  };
  const auto seen = [&](const std::optional<Pixel>& p) { return p && view.contains(p->x, p->y); };
  if (!seen(at(0))) return {};
  double inside = 0, outside = 1;
  if (seen(at(1))) inside = 1;
  for (int i = 0; i < kHalvings && inside < 1; ++i) {
    const double middle = 0.5 * (inside + outside);
    (seen(at(middle)) ? inside : outside) = middle;
  }
  return at(inside);
}

/// Moves a text as little as needed.
void keep_inside(const Box2& box, TextItem& text) {
  const Box2 own = extent_of(text);
  if (own.right() > box.right()) text.x -= own.right() - box.right();
  if (own.x < box.x) text.x += box.x - own.x;
  if (own.top() > box.top()) text.y -= own.top() - box.top();
  if (own.y < box.y) text.y += box.y - own.y;
}

}  // namespace

void add_arrow_labels(const DrawList& list, const Camera& camera, Overlay& out) {
  constexpr int kSize = 15, kTries = 9;
  constexpr double kStep = 13;
  for (const ArrowItem& arrow : list.arrows) {
    const auto tip = end_in_view(camera, arrow), tail = project(camera, arrow.tail);
    if (!tip || !tail) continue;
    const bool to_the_left = tip->x < tail->x;
    TextItem label{
        tip->x + (to_the_left ? -16 : 16),          tip->y + 12, arrow.label, kSize, arrow.color,
        to_the_left ? Align::kRight : Align::kLeft, true};
    keep_inside({0, 0, double(camera.width), double(camera.height)}, label);
    const auto free = [&] {
      const Box2 own = extent_of(label);
      const bool inside =
          own.x >= 0 && own.right() <= camera.width && own.y >= 0 && own.top() <= camera.height;
      return inside && std::ranges::none_of(out.texts, [&](const TextItem& other) {
               return overlap(own, extent_of(other));
             });
    };
    for (int i = 1; i <= kTries && !free(); ++i) label.y += (i % 2 == 0 ? -i : i) * kStep;
    if (!free()) continue;
    const Box2 own = extent_of(label);
    out.rects.push_back({{own.x - 5, label.y - 11, own.width + 10, 22}, palette::kPanel, 0.6});
    out.texts.push_back(label);
  }
}

/// At the end of a run: what was felt.
void add_felt(const SceneView& view, const Box2& box, Overlay& out) {
  std::vector<std::string> lines{text_of("The run has ended after %.1f s.", view.sim_time())};
  for (const ProbeView& probe : view.probes()) {
    std::string line = probe.description.name + ": ";
    if (probe.touched_for > 0) {
      line += text_of("at most %.2f N", probe.greatest_force) +
              text_of(" (at %.1f s), ", probe.greatest_at) +
              text_of("touched for %.1f s", probe.touched_for);
    } else {
      line += "felt nothing";
    }
    lines.push_back(line);
  }
  lines.push_back("q closes the window.");
  add_panel(lines, box, out);
}

void add_help(const Box2& box, Overlay& out) {
  constexpr double kWidth = 460, kKeyWidth = 158;
  const auto keys = key_meanings();
  const double line = std::min(21.0, (box.height - 4) / double(keys.size() + 1));
  const double height = line * double(keys.size() + 1);
  const Box2 panel{std::max(box.x, box.x + 0.5 * (box.width - kWidth)),
                   box.y + 0.5 * (box.height - height), kWidth, height};
  clear_under(panel, out);
  out.rects.push_back({panel, palette::kPanel, 1});
  double y = panel.top() - line;
  for (const auto& [key, meaning] : keys) {
    out.texts.push_back({panel.x + kKeyWidth, y, key, 12, palette::kWarning, Align::kRight, true});
    out.texts.push_back(fitted({panel.x + kKeyWidth + 12, y, meaning, 12, palette::kText},
                               kWidth - kKeyWidth - 16));
    y -= line;
  }
}

namespace {

Box2 shrunk(const Box2& box, double scale) {
  return {box.x / scale, box.y / scale, box.width / scale, box.height / scale};
}

void enlarge(Overlay& out, double scale) {
  for (RectItem& rect : out.rects) rect.box = shrunk(rect.box, 1 / scale);
  for (PolylineItem& line : out.lines) {
    for (float& coordinate : line.points) coordinate = static_cast<float>(scale * coordinate);
    line.width *= scale;
  }
  for (TextItem& text : out.texts) {
    text.x *= scale;
    text.y *= scale;
    text.size = static_cast<int>(std::lround(scale * text.size));
  }
}

}  // namespace

/// Laid out as for a window of ordinary size, then enlarged as a whole.
Overlay make_overlay(const SceneView& view, const DrawList& list, const Interaction& interaction,
                     const Layout& layout, std::int64_t now_ns) {
  Overlay out;
  const double scale = layout.scale;
  const Box2 box = shrunk(layout.scene, scale), table = shrunk(layout.table, scale);
  std::array<Box2, 3> plots;
  std::ranges::transform(layout.plots, plots.begin(),
                         [&](const Box2& plot) { return shrunk(plot, scale); });
  Camera camera = interaction.camera;
  camera.width = static_cast<int>(camera.width / scale);
  camera.height = static_cast<int>(camera.height / scale);
  add_title(view, interaction.options, box, now_ns, out);
  add_hand(view, interaction, out, box);
  add_scale_bar(view, camera, box, out);
  const double bar = std::min(240.0, box.width - 230);
  add_color_bar(view, interaction.options.coloring, {box.right() - bar - 36, box.y + 36, bar, 14},
                out);
  out.texts.push_back({kMargin, 18, "h: keys", 12, palette::kQuiet});
  add_plots(view, plots, out);
  add_status_table(view, table, now_ns, out);
  add_arrow_labels(list, camera, out);
  const std::string missing = what_is_missing(view);
  add_notice(missing.empty() ? interaction.notice() : missing, box, out);
  if (view.ended()) add_felt(view, box, out);
  if (interaction.options.help) add_help({0, 0, table.right(), box.height}, out);
  enlarge(out, scale);
  return out;
}

}  // namespace palpate::visualizer
