// A small scene for tests: a ball of 5 cm radius on a fixed foot, and a finger above it that any
// program may move.
#pragma once

#include <fstream>
#include <sstream>
#include <string>

#include "modules/geometry/mesh_io.h"
#include "modules/geometry/primitives.h"
#include "tests/palpate/shell_script.h"

namespace palpate::testing {

inline constexpr double kBallRadius = 0.05;      // [m]
inline constexpr double kFingerRadius = 0.01;    // [m]
inline constexpr double kFingerStart = 0.09;     // height of the finger's origin [m]
inline constexpr double kFingerPressing = 0.05;  // height at which it is 1 cm deep [m]

/// Files of the scene, as long as this object lives.
class BallScene {
 public:
  explicit BallScene(const std::string& device = "mouse: {start_m: [0, 0, 0.09]}",
                     const std::string& more = "") {
    geometry::write_surface(geometry::make_ball(kBallRadius, 3), files_.folder() / "ball.ply");
    file_ = files_.folder() / "press.yaml";
    set_device(device, more);
  }
  /// Writes the scene anew. @param more  further top-level keys
  void set_device(const std::string& device, const std::string& more = "") {
    std::ofstream(file_) << "palpate_scene: 1\n"
                            "organs:\n"
                            "  - name: ball\n"
                            "    mesh: {file: ball.ply}\n"
                            "    tissue: {youngs_modulus_pa: 20e3, drag_per_s: 20}\n"
                            "    springs: {inner_ratio: 0.5}\n"
                            "    fixed: [{box: {min_m: [-1, -1, -1], max_m: [1, 1, -0.03]}}]\n"
                            "probes:\n"
                            "  - name: finger\n"
                            "    shape: {sphere: {radius_m: 0.01}}\n"
                            "    device: {"
                         << device << "}\n"
                         << more;
  }
  /// @param text  an item of the list of organs, indented by two
  void add_organ(const std::string& text) {
    std::stringstream all;
    all << std::ifstream(file_).rdbuf();
    std::string with_it = all.str();
    with_it.insert(with_it.find("probes:"), text);
    std::ofstream(file_) << with_it;
  }
  const std::filesystem::path& file() const { return file_; }
  const std::filesystem::path& folder() const { return files_.folder(); }

 private:
  Scripts files_;
  std::filesystem::path file_;
};

}  // namespace palpate::testing
