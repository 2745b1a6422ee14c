// Two balls side by side, each with a finger of its own from above, and a third finger, large, that
// comes down into the valley between them and touches both.
#pragma once

#include "tests/palpate/ball_scene.h"

namespace palpate::testing {

inline constexpr double kBallsApart = 0.12;  // between their centres [m]

/// From a height above the place x down by 2 cm, and there.
inline std::string press_from(double height, double x = 0) {
  const auto at = [&](double z) {
    return "[" + std::to_string(x) + ", 0, " + std::to_string(z) + "]";
  };
  return "scripted: {start_m: " + at(height) + ", moves: [{to_m: " + at(height - 0.02) +
         ", duration_s: 0.3}]}";
}

/// Files of the scene, as long as this object lives.
class TwoBallsScene {
 public:
  /// @param process  value of the second ball's key; empty: without it
  /// @param between  a device of the third finger; empty: there is none
  explicit TwoBallsScene(const std::string& process, const std::string& between = "") {
    geometry::write_surface(geometry::make_ball(kBallRadius, 3), files_.folder() / "ball.ply");
    file_ = files_.folder() / "balls.yaml";
    std::ofstream file(file_);
    file << "palpate_scene: 1\nname: balls\norgans:\n";
    for (const int i : {0, 1}) {
      file << "  - mesh: {file: ball.ply}\n    position_m: [" << kBallsApart * i
           << ", 0, 0]\n"
              "    tissue: {youngs_modulus_pa: 20e3, drag_per_s: 20}\n"
              "    springs: {inner_ratio: 0.5}\n"
              "    fixed: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, -0.03]}}]\n";
      if (i == 1 && !process.empty()) file << "    process: " << process << "\n";
    }
    file << "probes:\n"
            "  - {shape: {sphere: {radius_m: 0.01}}, device: {"
         << press_from(0.065) << "}}\n"
         << "  - {shape: {sphere: {radius_m: 0.01}}, device: {" << press_from(0.065, kBallsApart)
         << "}}\n";
    if (!between.empty()) {
      file << "  - {shape: {sphere: {radius_m: 0.03}}, device: {" << between << "}}\n";
    }
    file << "rates: {collision_hz: 250, deformation_hz: 250}\n";
  }

  const std::filesystem::path& file() const { return file_; }
  const std::filesystem::path& folder() const { return files_.folder(); }

 private:
  Scripts files_;
  std::filesystem::path file_;
};

}  // namespace palpate::testing
