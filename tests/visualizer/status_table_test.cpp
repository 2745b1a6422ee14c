#include "visualizer/status_table.h"

#include <catch2/catch.hpp>

#include "modules/core/text.h"
#include "tests/times.h"
#include "tests/visualizer/fake_session.h"

using namespace palpate;
using namespace palpate::visualizer;

namespace {

ModuleStatus running(const std::string& module) {
  ModuleStatus status;
  status.module = module;
  status.state = ModuleState::kRunning;
  status.rate_hz = 249.6;
  status.overruns = 17;
  status.inputs = {{"probe_state", 0.5, 0, 0, 0, 0}, {"contacts", 0.0042, 0, 0, 0, 0}};
  return status;
}

std::vector<std::string> texts_of(const SceneView& view, std::int64_t now_ns) {
  Overlay overlay;
  add_status_table(view, make_layout(1280, 720).table, now_ns, overlay);
  std::vector<std::string> texts;
  for (const TextItem& item : overlay.texts) texts.push_back(item.text);
  return texts;
}

bool contains(const std::vector<std::string>& texts, const std::string& text) {
  return std::find(texts.begin(), texts.end(), text) != texts.end();
}

}  // namespace

TEST_CASE("status table: a row tells state, rate, overruns and age of the newest input",
          "[visualizer]") {
  // Oracle: the numbers put in.
  SceneView view(visualizer::testing::two_probe_scene());
  view.receive(running("deformation"), 10 * kSecond);
  const auto texts = texts_of(view, 10 * kSecond);
  for (const char* text : {"deformation", "running", "250", "17", "4 ms"}) {
    INFO(text);
    CHECK(contains(texts, text));
  }
}

TEST_CASE("status table: a silent process keeps its row and is marked lost",
          "[visualizer][fault]") {
  // Oracle: the stated rule; 7 s after the last status, with the limit at 2 s.
  SceneView view(visualizer::testing::two_probe_scene());
  view.receive(running("collision"), 10 * kSecond);
  CHECK_FALSE(contains(texts_of(view, 11 * kSecond), "lost 1 s"));
  const auto texts = texts_of(view, 17 * kSecond);
  CHECK(contains(texts, "collision"));
  CHECK(contains(texts, "lost 7 s"));
  CHECK_FALSE(contains(texts, "running"));
}

TEST_CASE("status table: one that said goodbye is stopped, not lost", "[visualizer]") {
  // Oracle: the stated rule.
  SceneView view(visualizer::testing::two_probe_scene());
  auto status = running("haptics");
  status.state = ModuleState::kStopped;
  view.receive(status, kSecond);
  CHECK(contains(texts_of(view, 100 * kSecond), "stopped"));
}

TEST_CASE("status table: a process without inputs or samples has no age", "[visualizer]") {
  // Oracle: the stated rule: infinity before the first sample.
  SceneView view(visualizer::testing::two_probe_scene());
  auto status = running("haptics");
  status.inputs = {{"probe_input", std::numeric_limits<double>::infinity(), 0, 0, 0, 0}};
  view.receive(status, kSecond);
  CHECK(contains(texts_of(view, kSecond), "-"));
}

TEST_CASE("status table: a long error is broken into two lines and cut", "[visualizer]") {
  // Oracle: the words put in, in order.
  SceneView view(visualizer::testing::two_probe_scene());
  auto status = running("haptics");
  status.last_error = "contact model older than stale_after_s: force fades to zero";
  view.receive(status, kSecond);
  auto texts = texts_of(view, kSecond);
  CHECK(texts[texts.size() - 2] + " " + texts.back() == "haptics: " + status.last_error);
  status.last_error = std::string(400, 'x');
  view.receive(status, kSecond);
  texts = texts_of(view, kSecond);
  CHECK(texts.back().size() <= 50);
  for (const std::string before : {"", "x"}) {  // letters of two bytes begin at even ones, at odd
    status.last_error = before;
    for (int i = 0; i < 200; ++i) status.last_error += "\xc3\xa9";
    view.receive(status, kSecond);
    for (const std::string& text : texts_of(view, kSecond)) CHECK(is_utf8(text));
  }
}

TEST_CASE("status table: where nobody tells of himself there is no heading", "[visualizer]") {
  // Oracle: nothing is drawn.
  CHECK(texts_of(SceneView(visualizer::testing::two_probe_scene()), kSecond).empty());
}
