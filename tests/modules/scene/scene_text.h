// Scenes as texts, with the files they name, for tests of the reader.
#pragma once

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <string>

#include "modules/core/error.h"
#include "modules/scene/scene_reader.h"
#include "tests/scratch_folder.h"

namespace palpate::scene::test {

/// While it lives, files are opened with the rights of a user who owns none of them: the
/// superuser may read everything.
class AsNobody {
 public:
  AsNobody() : user_(geteuid()) {
    if (user_ == 0) REQUIRE(seteuid(65534) == 0);
  }
  ~AsNobody() {
    if (user_ == 0 && seteuid(0) != 0) std::abort();
  }
  AsNobody(const AsNobody&) = delete;
  AsNobody& operator=(const AsNobody&) = delete;

 private:
  uid_t user_;
};

/// A folder with the files that the scenes below name. Their contents are not read here.
class SceneFolder : public ScratchFolder {
 public:
  SceneFolder() {
    using std::filesystem::perms;
    std::filesystem::permissions(  // so that AsNobody may enter
        path(), perms::owner_all | perms::group_exec | perms::others_exec);
    write("organ.ply", "an organ");
    write("tool.stl", "a tool");
    write("press.csv", "t,x,y,z,qx,qy,qz,qw\n");
  }
  Scene parse(const std::string& text) const { return parse_scene(text, path() / "scene.yaml"); }

  /// The refusal of a text, with this folder's name left out.
  std::string refusal(const std::string& text) const {
    try {
      parse(text);
    } catch (const InputError& error) {
      std::string message = error.what();
      const std::string folder = path().string() + "/";
      for (auto at = message.find(folder); at != std::string::npos; at = message.find(folder)) {
        message.erase(at, folder.size());
      }
      return message;
    }
    return "accepted";
  }
};

inline const std::string kMinimalScene = R"(palpate_scene: 1
organs:
  - mesh: {file: organ.ply}
probes:
  - shape: {sphere: {}}
    device: {topic: {start_m: [0, 0, 0.1]}}
)";

/// Every key there is, none at its default. The tests count on the line numbers.
inline const std::string kFullScene = R"(palpate_scene: 1
name: full
organs:
  - name: stomach
    mesh: {file: organ.ply, unit: mm, nodes: 550}
    position_m: [0.1, 0.2, 0.3]
    rotation_xyzw: [0, 0, 0.6, 0.8]
    tissue:
      youngs_modulus_pa: 20e3
      wall_thickness_m: 0.004
      density_kg_per_m3: 1000
      damping_ratio: 0.2
      drag_per_s: 3
    springs:
      bending_ratio: 0.4
      inner_ratio: 0.7
      virtual_nodes: 5
    model: implicit_volume
    volume_corrections: 2
    integrator: backward_euler
    filling:
      points:
        - {at_s: 0, volume_ratio: 1}
        - {at_s: 5, volume_ratio: 1.25}
      breathing_amplitude: 0.1
      breathing_hz: 0.4
      max_rate_per_s: 0.7
    fixed:
      - sphere: {center_m: [0.01, 0.02, 0.03], radius_m: 0.04}
      - box:
          min_m: [-1, -2, -3]
          max_m: [1, 2, 3]
  - name: liver
    mesh: {file: organ.ply}
probes:
  - name: tip
    shape: {sphere: {radius_m: 0.007}}
    friction: 0.3
    device:
      scripted:
        start_m: [0, 0, 0.2]
        rotation_xyzw: [1, 0, 0, 0]
        moves:
          - {to_m: [0, 0, 0.1], duration_s: 2.5}
          - {wait_s: 0.5}
  - name: rod
    shape: {capsule: {radius_m: 0.003, length_m: 0.2}}
    device:
      trajectory: {
        file: press.csv,
        position_m: [0.4, 0.5, 0.6], columns: [time, px, py, pos z, q0, 6, q2, q3], time_unit: ms, length_unit: cm, quaternion: wxyz,
        rotation_xyzw: [0, 1, 0, 0],
        loop: true}
  - name: hand
    shape: {box: {size_m: [0.01, 0.02, 0.03]}}
    device: {topic: {start_m: [0, 0, 0.3], rotation_xyzw: [0, 0, 1, 0]}}
  - name: table
    shape: {plane: {}}
    device: {mouse: {start_m: [0, 0, -0.3], rotation_xyzw: [0, 1, 0, 0]}}
  - name: tool
    shape: {mesh: {file: tool.stl, unit: cm, nodes: 100}}
    device: {topic: {start_m: [0, 0, 0.4]}}
  - name: held
    shape: {sphere: {}}
    device:
      emulated:
        kind: omega
        start_m: [0, 0, 0.5]
        rotation_xyzw: [0, 1, 0, 0]
        mass_kg: 0.3
        damping_n_s_per_m: 0.7
        max_force_n: 6
        encoder_step_m: 1e-6
        rate_hz: 4000
        transport_delay_s: 5e-4
        hand:
          mass_kg: 0.25
          damping_n_s_per_m: 3
          stiffness_n_per_m: 150
          push_n: [0, 0, -0.15]
          moves: [{to_m: [0, 0, 0.3], duration_s: 2},
                  {wait_s: 1}]
        axis: [0, 0.6, 0.8]
gravity_m_per_s2: [0, 0, -9.81]
duration_s: 20
rates: {haptics_hz: 2000, collision_hz: 500, deformation_hz: 400, visualizer_hz: 60}
haptics:
  max_force_n: 5
  max_force_rate_n_per_s: 300
  device_damping_n_s_per_m: 0.4
  stale_after_s: 0.06
  fade_time_s: 0.07
camera: {position_m: [0, -1, 0], target_m: [0, 0, 0.1]}
deformation_threads: 3
contacts: {organs: false, self: false, friction: 0.25}
)";

/// kFullScene with one place changed; a text that is not there exactly once is a broken test.
inline std::string changed(const std::string& from, const std::string& to,
                           std::string text = kFullScene) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  REQUIRE(text.find(from, at + 1) == std::string::npos);
  return text.replace(at, from.size(), to);
}

/// What kFullScene is told with one place changed.
inline std::string refusal(const std::string& from, const std::string& to) {
  return SceneFolder().refusal(changed(from, to));
}

}  // namespace palpate::scene::test
