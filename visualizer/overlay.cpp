#include "visualizer/overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "visualizer/plots.h"
#include "visualizer/status_table.h"

namespace palpate::visualizer {
namespace {

constexpr double kMargin = 16;
constexpr double kStaleAge = 0.5;  // organ positions older than this are marked [s]

void add_notice(const std::string& text, const Box2& box, Overlay& out) {
  if (text.empty()) return;
  const double width = std::min(box.width - 2 * kMargin, 7.2 * double(text.size()) + 24);
  out.rects.push_back(
      {{box.x + 0.5 * (box.width - width), box.top() - 92, width, 26}, palette::kPanel, 0.85});
  out.texts.push_back(
      {box.x + 0.5 * box.width, box.top() - 79, text, 13, palette::kWarning, Align::kCenter});
}

/// Lines in the middle of a box, one below the other.
void add_panel(const std::vector<std::string>& lines, const Box2& box, Overlay& out) {
  constexpr double kLine = 22;
  std::size_t longest = 0;
  for (const std::string& line : lines) longest = std::max(longest, line.size());
  const double width = std::min(box.width, 7.6 * double(longest) + 40);
  const double height = kLine * double(lines.size()) + 20, middle = box.x + 0.5 * box.width;
  const double top = box.y + 0.5 * (box.height + height);
  out.rects.push_back({{middle - 0.5 * width, top - height, width, height}, palette::kPanel, 0.9});
  for (std::size_t i = 0; i < lines.size(); ++i) {
    out.texts.push_back(
        {middle, top - 21 - kLine * double(i), lines[i], 13, palette::kText, Align::kCenter});
  }
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
  out.texts.push_back({kMargin, box.top() - 72, line, 14, palette::kWarning});
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

std::string text_of(const char* format, double value) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, value);
  return buffer.data();
}

Layout make_layout(int width, int height) {
  const double panel = std::min(360.0, 0.4 * width);
  Layout layout;
  layout.scene = {0, 0, std::max(1.0, width - panel), double(height)};
  const double x = layout.scene.right(), table_height = std::min(170.0, 0.3 * height);
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
  out.texts.push_back({kMargin, y, view.scene().name, 20, palette::kText, Align::kLeft, true});
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
  out.texts.push_back({kMargin, y - 24, line, 14, palette::kQuiet});
  const double age = view.positions_age(now_ns);
  if (!paused && !steps && std::isfinite(age) && age > kStaleAge) {
    out.texts.push_back({box.right() - kMargin, y, text_of("no new organ shape for %.1f s", age),
                         14, palette::kBad, Align::kRight});
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

void add_arrow_labels(const DrawList& list, const Camera& camera, Overlay& out) {
  constexpr int kSize = 15;
  for (const ArrowItem& arrow : list.arrows) {
    const auto tip = project(camera, arrow.tip), tail = project(camera, arrow.tail);
    if (!tip || !tail) continue;
    const bool to_the_left = tip->x < tail->x;
    const double x = tip->x + (to_the_left ? -16 : 16), y = tip->y + 12;
    const double width = 0.68 * kSize * double(arrow.label.size()) + 10;
    out.rects.push_back(
        {{to_the_left ? x + 5 - width : x - 5, y - 11, width, 22}, palette::kPanel, 0.6});
    out.texts.push_back(
        {x, y, arrow.label, kSize, arrow.color, to_the_left ? Align::kRight : Align::kLeft, true});
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
  constexpr double kLine = 20, kWidth = 372, kKeyWidth = 136;
  const auto keys = key_meanings();
  const double height = kLine * double(keys.size()) + 20;
  const Box2 panel{std::max(box.x, box.x + 0.5 * (box.width - kWidth)),
                   box.y + 0.5 * (box.height - height), kWidth, height};
  out.rects.push_back({panel, palette::kPanel, 0.95});
  double y = panel.top() - 20;
  for (const auto& [key, meaning] : keys) {
    out.texts.push_back({panel.x + kKeyWidth, y, key, 12, palette::kWarning, Align::kRight, true});
    out.texts.push_back({panel.x + kKeyWidth + 12, y, meaning, 12, palette::kText});
    y -= kLine;
  }
}

Overlay make_overlay(const SceneView& view, const DrawList& list, const Interaction& interaction,
                     const Layout& layout, std::int64_t now_ns) {
  Overlay out;
  const Box2& box = layout.scene;
  add_title(view, interaction.options, box, now_ns, out);
  add_hand(view, interaction, out, box);
  add_scale_bar(view, interaction.camera, box, out);
  add_color_bar(view, interaction.options.coloring, {box.right() - 276, box.y + 36, 240, 14}, out);
  add_arrow_labels(list, interaction.camera, out);
  out.texts.push_back({kMargin, 18, "h: keys", 12, palette::kQuiet});
  const std::string missing = what_is_missing(view);
  add_notice(missing.empty() ? interaction.notice() : missing, box, out);
  add_plots(view, layout.plots, out);
  add_status_table(view, layout.table, now_ns, out);
  if (view.ended()) add_felt(view, box, out);
  if (interaction.options.help) add_help(box, out);
  return out;
}

}  // namespace palpate::visualizer
