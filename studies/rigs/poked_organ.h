// Organs of shipped scenes, held as their scenes hold them, poked by a sphere from the front (+y).
#pragma once

#include <optional>

#include "modules/geometry/triangle_surface.h"
#include "modules/scene/scene.h"

namespace palpate::rigs {

inline constexpr double kPokerRadius = 8e-3;  ///< [m]

/// Where an organ is poked: along y at (x, z) [m].
struct PokedPlace {
  const char* scene;  ///< file of the organ
  double x = 0, z = 0;
};
inline constexpr PokedPlace kOnLiver{"liver_probe.yaml", -0.020, 0.013};
inline constexpr PokedPlace kOnStomach{"stomach_probe.yaml", 0.022, -0.004};

/// The first organ of the place's scene.
/// @throws InputError if the scene cannot be read
scene::Organ poked_organ(const PokedPlace& place);
/// Its surface with about so many nodes.
/// @throws InputError if its mesh cannot be read
geometry::TriangleSurface surface_of(scene::Organ organ, std::size_t nodes);

/// Where the line along y at (x, z) first meets the surface, from the front [m]; none: nowhere.
std::optional<double> find_front(const geometry::TriangleSurface& surface, double x, double z);
/// The same; it must.
double front_of(const geometry::TriangleSurface& surface, double x, double z);

/// Where the sphere's middle is `depth` after it touched the surface at rest [m].
Vec3 poker_at(const geometry::TriangleSurface& surface, const PokedPlace& place, double depth);

}  // namespace palpate::rigs
