// What the cases have in common. Each measure_…() is one case of cases.h.
#pragma once

#include "deformation/elements/taylor_hood.h"
#include "studies/chart/cases.h"
#include "studies/report/reference_table.h"
#include "studies/rigs/pressed_organ.h"

namespace palpate::chart {

inline constexpr double kYoungsModulus = 5e3;    // of the references [Pa]
inline constexpr double kDensity = 1060;         // [kg/m³]
inline constexpr double kPoissonRatio = 0.499;   // Solid's default
inline constexpr std::size_t kVirtualNodes = 6;  // of what has a dominant axis

using report::ReferenceTable;

/// Surface nodes 162, 642, 2,562 for every model: a quadratic one has the corners of the level
/// before, and its surface lies on the sphere.
geometry::OrganShape ball_shape(const Setting& setting);
/// @param drag  [1/s]
scene::Scene ball_scene(const Setting& setting, double drag);

/// Sizes, step, cost and volume error of the pressed so far.
Measurement summary(const rigs::PressedOrgan& pressed, const geometry::OrganShape& shape);
/// Sizes of a reference.
Measurement summary(const deformation::TaylorHoodElements& solid);

/// √(A/π), A the share of the surface, across `normal`, of nodes less than kTouchDistance outside
/// of an obstacle; a node's share is a third of its triangles [m].
/// @param outside  distance of a point from the obstacle [m]
inline constexpr double kTouchDistance = 5e-5;
double contact_radius(const rigs::PressedOrgan& pressed, const Vec3& normal,
                      const std::function<double(const Vec3&)>& outside);

Measurement measure_ball(const Setting& setting, const KeepGoing& keep_going);
Measurement measure_block(const Setting& setting, const KeepGoing& keep_going);
Measurement measure_indent(const Setting& setting, const KeepGoing& keep_going);
Measurement measure_vibration(const Setting& setting, const KeepGoing& keep_going);
Measurement measure_squeeze(const Setting& setting, const KeepGoing& keep_going);
Measurement measure_truth_cube(const Setting& setting, const KeepGoing& keep_going);
Measurement measure_beam(const Setting& setting, const KeepGoing& keep_going);
Measurement measure_liver(const Setting& setting, const KeepGoing& keep_going);
Measurement measure_stomach(const Setting& setting, const KeepGoing& keep_going);
Measurement measure_small_liver(const Setting& setting, const KeepGoing& keep_going);
Measurement measure_small_stomach(const Setting& setting, const KeepGoing& keep_going);
Measurement measure_slide(const Setting& setting, const KeepGoing& keep_going);

}  // namespace palpate::chart
