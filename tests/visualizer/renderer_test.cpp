#include "visualizer/renderer.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "tests/file_size_limit.h"
#include "tests/visualizer/display_or_skip.h"
#include "tests/visualizer/studio.h"

using namespace palpate;
using namespace palpate::visualizer;
using visualizer::testing::Picture;
using visualizer::testing::Studio;

TEST_CASE("renderer: the organ is where the camera projects it, and moves with it",
          "[visualizer]") {
  // Oracle: analytic projection of the ball's middle and of places beside its outline.
  if (!visualizer::testing::xvfb_or_skip()) return;
  Studio studio;
  const Picture empty = studio.draw_nothing();
  const Picture rest = studio.draw();
  REQUIRE(rest.pixels.size() ==
          std::size_t{3} * visualizer::testing::kWidth * visualizer::testing::kHeight);
  const auto covered = [&](const Picture& picture, const Vec3& p) {
    const Pixel pixel = studio.pixel_of(p);
    return picture.at(pixel.x, pixel.y) != empty.at(pixel.x, pixel.y);
  };
  for (const Vec3& inside : {Vec3(0, 0, 0), Vec3(0.045, 0, 0), Vec3(-0.045, 0, 0),
                             Vec3(0, 0, 0.045), Vec3(0, 0, -0.045)}) {
    CHECK(covered(rest, inside));
  }
  for (const Vec3& outside :
       {Vec3(0.056, 0, 0), Vec3(-0.056, 0, 0), Vec3(0, 0, 0.056), Vec3(0, 0, -0.056)}) {
    CHECK_FALSE(covered(rest, outside));
  }
  const Rgb middle = rest.at(studio.pixel_of(Vec3::Zero()).x, studio.pixel_of(Vec3::Zero()).y);
  CHECK(middle[0] > middle[2] + 20);  // lit tissue is pink; the background is bluish
  studio.move_ball(Vec3(0.04, 0, 0));
  const Picture moved = studio.draw();
  CHECK(covered(moved, Vec3(0.08, 0, 0)));
  CHECK_FALSE(covered(moved, Vec3(-0.03, 0, 0)));
}

TEST_CASE("renderer: the same state gives the same picture", "[visualizer]") {
  // Oracle: identity.
  if (!visualizer::testing::xvfb_or_skip()) return;
  Studio studio;
  const Picture first = studio.draw(true);
  CHECK(studio.draw(true).differing(first) == 0);
}

TEST_CASE("renderer: writes a PNG or says which file it could not write", "[visualizer][fault]") {
  // Oracle: the PNG signature; the message, EFBIG as a full disk's reason.
  if (!visualizer::testing::xvfb_or_skip()) return;
  Studio studio;
  studio.draw(true);
  const auto folder = std::filesystem::temp_directory_path() /
                      ("palpate_renderer_test_" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  studio.renderer.write_png(folder / "picture.png");
  std::ifstream file(folder / "picture.png", std::ios::binary);
  std::string start(8, '\0');
  file.read(start.data(), 8);
  CHECK(start == "\x89PNG\r\n\x1a\n");
  const auto nowhere = folder / "missing" / "picture.png";
  CHECK_THROWS_WITH(studio.renderer.write_png(nowhere), Catch::Contains(nowhere.string()));
  const auto cut = folder / "cut.png";
  {
    const palpate::FileSizeLimit full(1000);
    CHECK_THROWS_WITH(studio.renderer.write_png(cut),
                      "cannot write " + cut.string() + ": File too large");
  }
  CHECK(std::distance(std::filesystem::directory_iterator(folder), {}) == 1);  // no half file
  std::filesystem::remove_all(folder);
}
