#include "deformation/model/body.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "modules/core/error.h"
#include "modules/scene/region.h"

namespace palpate::deformation {

bool is_fixed(const scene::Organ& organ, const Vec3& rest_position) {
  return std::any_of(organ.fixed.begin(), organ.fixed.end(),
                     [&](const auto& region) { return scene::contains(region, rest_position); });
}

double fixed_stiffness(const Body& body, std::uint32_t triangle) {
  const Vec3 area = geometry::area_vector(body.rest_positions, body.triangles[triangle]);
  return body.youngs_modulus * std::sqrt(area.norm());
}

double fixed_yielding(const Body& body, std::uint32_t triangle, const Vec3& barycentric) {
  double share = 0;
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t node = body.triangles[triangle][static_cast<std::size_t>(k)];
    if (body.inverse_masses[node] == 0) share += barycentric[k];
  }
  return share > 0 ? share * share / fixed_stiffness(body, triangle) : 0;
}

void fix_nodes(const scene::Organ& organ, std::size_t count, Body& body) {
  body.youngs_modulus = organ.tissue.youngs_modulus;
  std::size_t held = 0;  // of the surface
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!is_fixed(organ, body.rest_positions[i])) continue;
    body.inverse_masses[i] = 0;
    body.fixed_nodes.push_back(i);
    held += i < body.surface_node_count ? 1 : 0;
  }
  if (held == body.surface_node_count) {
    throw InputError("organ '" + organ.name + "': key 'fixed' holds every one of its " +
                     std::to_string(body.surface_node_count) + " nodes; leave some free to move");
  }
}

double highest_squared_frequency_bound(const Body& body) {
  double bound = 0;
  for (std::size_t i = 0; i < body.node_count(); ++i) {
    bound = std::max(bound, 2 * body.node_stiffness[i] * body.inverse_masses[i]);
  }
  return bound;
}

}  // namespace palpate::deformation
