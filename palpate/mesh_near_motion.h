// `palpate mesh … --near TRAJECTORY`: tetrahedra that are small where a recorded motion touches.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "modules/geometry/tet_mesh.h"
#include "modules/scene/scene.h"

namespace palpate::geometry {

struct NearMotion {
  std::filesystem::path file;        ///< as the device `trajectory` takes it; empty: none
  std::string unit = "m";            ///< of its positions, see metres_per_unit()
  std::vector<std::string> columns;  ///< of a table: time, x, y, z; empty: by its header
  std::string topic;                 ///< of a bag; empty: the only one with poses
  /// Of the recording's frame in the mesh's, as the device's keys: x, y, z [m] and a unit
  /// quaternion; empty: none.
  std::vector<double> position, rotation;
  std::optional<double> radius;  ///< of the sphere that moves so; needed [m]
  std::optional<double> edge;    ///< longest where it touches; none: half its radius [m]
  std::optional<double> growth;  ///< per metre of distance; none: as the scene's key
};

/// A mesh that was halved near the places that were touched.
struct TouchedMesh {
  TetMesh mesh;
  scene::Refinement refine;  ///< by which
};

/// Where the sphere was, sample by sample, in the mesh's frame.
struct SphereWay {
  std::vector<Vec3> places;
  std::vector<std::string> notes;  ///< what is to be said of the recording
};

/// @throws InputError naming the file that cannot be read, or an option that is wrong
SphereWay read_way(const NearMotion& motion);

/// @throws InputError for a way that touches nothing, or a mesh that gets too large
TouchedMesh refined_near(const TetMesh& mesh, const NearMotion& motion, const SphereWay& way);

}  // namespace palpate::geometry
