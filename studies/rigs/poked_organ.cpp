#include "studies/rigs/poked_organ.h"

#include <algorithm>
#include <optional>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/scene/assets.h"
#include "modules/scene/scene_reader.h"

namespace palpate::rigs {

scene::Organ poked_organ(const PokedPlace& place) {
  return scene::load_scene(data_file("scenes") / place.scene).organs.at(0);
}

geometry::TriangleSurface surface_of(scene::Organ organ, std::size_t nodes) {
  organ.model = "implicit_volume";
  organ.mesh.nodes = nodes;
  return scene::load_organ(organ).surface;
}

std::optional<double> find_front(const geometry::TriangleSurface& surface, double x, double z) {
  std::optional<double> front;
  for (const auto& [i, j, k] : surface.triangles) {
    const Vec3 &a = surface.nodes[i], &b = surface.nodes[j], &c = surface.nodes[k];
    const double area = (b.x() - a.x()) * (c.z() - a.z()) - (c.x() - a.x()) * (b.z() - a.z());
    const double u = ((x - a.x()) * (c.z() - a.z()) - (c.x() - a.x()) * (z - a.z())) / area;
    const double v = ((b.x() - a.x()) * (z - a.z()) - (x - a.x()) * (b.z() - a.z())) / area;
    if (!(u >= 0 && v >= 0 && u + v <= 1)) continue;
    const double y = a.y() + u * (b.y() - a.y()) + v * (c.y() - a.y());
    front = std::min(front.value_or(y), y);
  }
  return front;
}

double front_of(const geometry::TriangleSurface& surface, double x, double z) {
  const std::optional<double> front = find_front(surface, x, z);
  PALPATE_DEMAND(front.has_value());
  return *front;
}

Vec3 poker_at(const geometry::TriangleSurface& surface, const PokedPlace& place, double depth) {
  return {place.x, front_of(surface, place.x, place.z) - kPokerRadius + depth, place.z};
}

}  // namespace palpate::rigs
