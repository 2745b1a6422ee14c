// Looked at through the renderer: VTK stays out of the tests.
#include <catch2/catch.hpp>

#include "tests/visualizer/display_or_skip.h"
#include "tests/visualizer/studio.h"

using namespace palpate;
using namespace palpate::visualizer;
using visualizer::testing::Picture;
using visualizer::testing::Studio;

TEST_CASE("overlay actor: text and plots are painted beside the organ", "[visualizer]") {
  // Oracle: pictures with and without the flat part differ, mostly in the right-hand panel.
  if (!visualizer::testing::xvfb_or_skip()) return;
  Studio studio;
  CHECK(studio.draw(true).differing(studio.draw(false)) > 2000);
}

TEST_CASE("overlay actor: rectangles, lines and any number of texts come to their places",
          "[visualizer]") {
  // Oracle: the colours put in. More texts than one actor holds: the last one is painted too.
  if (!visualizer::testing::xvfb_or_skip()) return;
  Studio studio;
  const DrawList nothing;
  Overlay overlay;
  overlay.rects.push_back({{10, 20, 30, 40}, {200, 10, 20}, 1});
  overlay.lines.push_back({{100, 50, 200, 50}, {10, 200, 20}, 3, 1});
  for (int i = 0; i < 100; ++i) overlay.texts.push_back({300, 300, "", 20, {255, 255, 255}});
  studio.renderer.draw(nothing, overlay, studio.interaction.camera);
  const Picture without{studio.renderer.pixels()};
  CHECK(without.at(25, 40) == Rgb{200, 10, 20});
  CHECK(without.at(150, 50) == Rgb{10, 200, 20});
  CHECK(without.at(150, 40) != Rgb{10, 200, 20});
  for (auto& text : overlay.texts) text.text.assign(1, 'x');
  overlay.texts.back() = {400, 100, "MMMM", 20, {255, 255, 255}};
  studio.renderer.draw(nothing, overlay, studio.interaction.camera);
  const Picture with{studio.renderer.pixels()};
  std::size_t white = 0;
  for (int x = 400; x < 470; ++x) white += with.at(x, 100) != without.at(x, 100);
  CHECK(white > 5);
  CHECK(with.at(380, 100) == without.at(380, 100));
}
