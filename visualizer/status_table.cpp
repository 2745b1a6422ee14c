#include "visualizer/status_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "modules/core/text.h"
#include "modules/core/units.h"
#include "modules/messages/describe.h"

namespace palpate::visualizer {
namespace {

constexpr double kFirstRow = 20, kRowHeight = 18;

constexpr double kNarrow = 330;  // a narrower table has no rates and overruns

struct Columns {
  double name, state, rate, overruns, age;  ///< right ends but for name and state
  bool narrow;
};

std::string age_text(const ModuleStatus& status) {
  double newest = std::numeric_limits<double>::infinity();
  for (const auto& input : status.inputs) newest = std::min(newest, input.age);
  if (!std::isfinite(newest)) return "-";
  return newest < 10 ? text_of("%.0f ms", 1000 * newest) : text_of("%.0f s", newest);
}

Rgb color_of(ModuleState state) {
  switch (state) {
    case ModuleState::kRunning:
      return palette::kGood;
    case ModuleState::kDegraded:
      return palette::kWarning;
    case ModuleState::kFault:
      return palette::kBad;
    default:
      return palette::kQuiet;
  }
}

/// The text broken at a space into at most two lines that fit the table; the rest is cut.
std::array<std::string, 2> two_lines(const std::string& text, double width) {
  const std::size_t letters = static_cast<std::size_t>(std::max(8.0, width / (0.6 * 11)));
  if (text.size() <= letters) return {text, ""};
  const std::size_t space = text.rfind(' ', letters);
  const std::string first(cut_at_letter(text, space == std::string::npos ? letters : space));
  const std::string second = text.substr(first.size() + (text[first.size()] == ' ' ? 1 : 0));
  if (second.size() <= letters) return {first, second};
  return {first, std::string(cut_at_letter(second, letters - 3)) + "..."};
}

void add_row(const ModuleView& module, const Columns& columns, double y, std::int64_t now_ns,
             Overlay& out) {
  const ModuleStatus& status = module.status;
  const double silent = seconds_from_ns(now_ns - module.received_ns);
  const bool stopped = status.state == ModuleState::kStopped;
  const bool lost = silent > kLostAfter && !stopped;
  const Rgb numbers = lost || stopped ? palette::kQuiet : palette::kText;
  out.texts.push_back({columns.name, y, status.module, 12, numbers});
  out.texts.push_back({columns.state, y,
                       lost ? text_of("lost %.0f s", silent) : messages::word_of(status.state), 12,
                       lost ? palette::kBad : color_of(status.state)});
  if (!columns.narrow) {
    out.texts.push_back(
        {columns.rate, y, text_of("%.0f", status.rate_hz), 12, numbers, Align::kRight});
    out.texts.push_back(
        {columns.overruns, y, std::to_string(status.overruns), 12, numbers, Align::kRight});
  }
  out.texts.push_back({columns.age, y, age_text(status), 12, numbers, Align::kRight});
}

}  // namespace

void add_status_table(const SceneView& view, const Box2& box, std::int64_t now_ns, Overlay& out) {
  if (view.modules().empty()) return;  // in lockstep nobody tells the visualizer of himself
  const Columns columns{box.x + 16,  box.x + 104,      box.x + 230,
                        box.x + 268, box.right() - 20, box.width < kNarrow};
  double y = box.top() - kFirstRow;
  out.texts.push_back({columns.name, y, "process", 12, palette::kQuiet});
  out.texts.push_back({columns.state, y, "state", 12, palette::kQuiet});
  if (!columns.narrow) {
    out.texts.push_back({columns.rate, y, "rate [Hz]", 12, palette::kQuiet, Align::kRight});
    out.texts.push_back({columns.overruns, y, "late", 12, palette::kQuiet, Align::kRight});
  }
  out.texts.push_back({columns.age, y, "input age", 12, palette::kQuiet, Align::kRight});
  out.lines.push_back({{float(columns.name), float(y - 10), float(columns.age), float(y - 10)},
                       palette::kFrame,
                       1,
                       1});
  std::string error;
  for (const auto& [name, module] : view.modules()) {
    y -= kRowHeight;
    if (y < box.y + 44) break;  // what is below belongs to the error
    add_row(module, columns, y - 4, now_ns, out);
    if (!module.status.last_error.empty()) error = name + ": " + module.status.last_error;
  }
  double line_y = box.y + 31;
  for (const std::string& line : two_lines(error, box.width - 36)) {
    out.texts.push_back({columns.name, line_y, line, 11, palette::kWarning});
    line_y -= 15;
  }
}

}  // namespace palpate::visualizer
