#include "studies/rigs/indented_block.h"

#include <sstream>

#include "modules/geometry/tools/gmsh_tool.h"

namespace palpate::rigs {

std::string text_of(const BlockSizes& sizes) {
  std::ostringstream square, text;
  square << "(x*x + y*y + (z-" << kBlockHeight << ")^2)";
  text << sizes.finest << " + " << sizes.growth << "*(" << square.str() << "/(" << square.str()
       << " + " << sizes.flat * sizes.flat << "))^2";
  return text.str();
}

geometry::TetMesh whole_block(const BlockSizes& sizes) {
  return geometry::mesh_block({-kBlockHalfWidth, -kBlockHalfWidth, 0},
                              {kBlockHalfWidth, kBlockHalfWidth, kBlockHeight}, text_of(sizes));
}

geometry::TetMesh quarter_block(double size) {
  return geometry::mesh_block(Vec3::Zero(), {kBlockHalfWidth, kBlockHalfWidth, kBlockHeight},
                              text_of({size * kIndenterRadius, 0.012, 0.02}));
}

bool is_constrained_in_quarter(const Vec3& p, int axis) {
  return p.z() == 0 || (axis < 2 && p[axis] == 0);
}

scene::Region block_base() { return scene::BoxRegion{{-1, -1, -1}, {1, 1, 1e-6}}; }

void add_indenter(scene::Scene& scene) {
  scene.probes.push_back(
      {"indenter", scene::SphereShape{kIndenterRadius}, 0.0, scene::ScriptedDevice{}});
}

Vec3 indenter_at(double depth) { return {0, 0, kBlockHeight + kIndenterRadius - depth}; }

}  // namespace palpate::rigs
