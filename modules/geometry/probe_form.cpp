#include "modules/geometry/probe_form.h"

#include "modules/geometry/primitives.h"

#include "modules/core/rotation_vector.h"

namespace palpate::geometry {
namespace {

/// One function out of one per form.
template <class... Functions>
struct Forms : Functions... {
  using Functions::operator()...;
};
template <class... Functions>
Forms(Functions...) -> Forms<Functions...>;

TriangleSurface rounded(const RoundedSegment& core) {
  const Vec3 axis = core.b - core.a;
  TriangleSurface surface =
      core.is_ball() ? make_ball(core.radius, 3) : make_capsule(core.radius, axis.norm(), 32);
  const Quat turn = core.is_ball() ? Quat::Identity() : rotation_between(Vec3::UnitZ(), axis);
  for (Vec3& node : surface.nodes) node = turn * node + 0.5 * (core.a + core.b);
  return surface;
}

TriangleSurface square_patch(double size) {
  const double h = 0.5 * size;
  return {{{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}

}  // namespace

TriangleSurface surface_of(const ProbeForm& form, double patch_size) {
  return std::visit(Forms{[](const RoundedSegment& core) { return rounded(core); },
                          [](const Box& box) { return make_box(box.size); },
                          [&](const HalfSpace&) { return square_patch(patch_size); },
                          [](const TriangleSurface& surface) { return surface; }},
                    form);
}

double tip_radius(const ProbeForm& form) {
  if (const auto* core = std::get_if<RoundedSegment>(&form)) return core->radius;
  if (const auto* box = std::get_if<Box>(&form)) return box->size.minCoeff() / 2;
  return 0;
}

}  // namespace palpate::geometry
