#include "deformation/contact/inner_cores.h"

#include <cmath>
#include <variant>

#include "modules/geometry/inner_lines.h"

namespace palpate::deformation {

using geometry::RoundedSegment;

namespace {

std::vector<RoundedSegment> axis_of(const scene::ConeShape& cone) {
  const double inset = geometry::inner_inset(cone.length);
  const double radius = inset * cone.radius / std::hypot(cone.radius, cone.length);
  return {{{0, 0, inset}, {0, 0, cone.length - inset}, radius}};
}

}  // namespace

std::vector<RoundedSegment> inner_cores(const scene::ProbeShape& shape,
                                        const geometry::TriangleSurface& mesh) {
  const auto* const cone = std::get_if<scene::ConeShape>(&shape);
  return cone != nullptr ? axis_of(*cone) : geometry::inner_lines(scene::form_of(shape, mesh));
}

}  // namespace palpate::deformation
