#include "visualizer/draw_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <span>

#include "visualizer/surface_pick.h"

namespace palpate::visualizer {
namespace {

constexpr std::array<Rgb, 4> kProbeColors{
    {{126, 203, 255}, {255, 214, 102}, {150, 230, 150}, {230, 160, 255}}};
constexpr std::array<Rgb, 3> kSpringColors{{{205, 215, 225}, {255, 196, 84}, {96, 214, 214}}};
constexpr Rgb kVirtualNodeColor{96, 214, 214};
constexpr Rgb kContactColor{255, 255, 255};
constexpr Rgb kForceColor{255, 236, 90};
constexpr Rgb kPlumbColor{190, 200, 214};
constexpr Rgb kPatchColor{255, 250, 235};
constexpr double kSmallestForce = 1e-3;  // shown as an arrow [N]
constexpr double kPatchTint = 0.8;
constexpr double kDarkest = 0.5;      // of a shadow
constexpr double kShadowWidth = 1.2;  // in radii of the probe

void add_organ(const OrganView& organ, std::size_t index, const SceneView& view,
               const ViewOptions& options, DrawList& list) {
  const bool by_strain = options.coloring == Coloring::kStrain;
  SurfaceItem item;
  item.organ = index;
  item.shape_version = organ.shape_version;
  item.positions_version = organ.positions_version;
  item.positions = organ.newest.positions;
  item.normals = organ.normals;
  item.triangles = organ.surface.triangles;
  append_colors(by_strain ? organ.node_strain : organ.displacement,
                by_strain ? view.strain_top() : view.displacement_top(), item.colors);
  const bool looks_inside = (options.tetrahedra && organ.solid) ||
                            options.springs[static_cast<std::size_t>(SpringFamily::kInner)] ||
                            options.springs[static_cast<std::size_t>(SpringFamily::kBending)];
  item.opacity = looks_inside && !options.wireframe ? 0.35 : 1;
  item.wireframe = options.wireframe;
  list.surfaces.push_back(std::move(item));

  for (std::size_t f = 0; f < organ.springs.size(); ++f) {
    if (organ.solid ? !options.tetrahedra : !options.springs[f]) continue;
    list.springs.push_back(
        {index, static_cast<SpringFamily>(f), organ.springs[f], kSpringColors[f]});
  }
  if (organ.solid || !options.springs[static_cast<std::size_t>(SpringFamily::kInner)]) return;
  for (auto i = organ.surface.surface_node_count; i < organ.node_count(); ++i) {
    list.points.push_back({organ.node(i), kVirtualNodeColor, 12});
  }
}

/// A touched place is as bright as nothing else: its nodes by their weights.
void tint(DrawList& list, std::uint32_t organ, std::uint32_t node, double weight) {
  for (SurfaceItem& item : list.surfaces) {
    if (item.organ != organ || 3 * std::size_t{node} + 2 >= item.colors.size()) continue;
    std::uint8_t* color = item.colors.data() + 3 * std::size_t{node};
    for (std::size_t c = 0; c < 3; ++c) {
      const double mixed = (1 - weight) * color[c] + weight * kPatchColor[c];
      color[c] = static_cast<std::uint8_t>(mixed);
    }
  }
}

/// visit(organ's number, node, contact) for each node that the probe's contact lists name.
template <class Visit>
void for_each_on_faces(const ProbeView& probe, const SceneView& view, const Visit& visit) {
  std::span<const std::uint32_t> nodes = probe.contacts.face_nodes;
  for (const FaceContacts& face : probe.contacts.faces) {
    const auto own = nodes.first(face.node_count);
    nodes = nodes.subspan(face.node_count);
    if (face.organ >= view.organs().size()) continue;
    const OrganView& organ = view.organs()[face.organ];
    for (const std::uint32_t node : own) {
      if (node >= organ.node_count()) continue;
      const Vec3 tissue_P = probe.contacts.probe_pose.to_body(organ.node(node));
      visit(face.organ, node, contact_on_face(face, tissue_P));
    }
  }
}

void tint_patch(const ProbeView& probe, const SceneView& view, DrawList& list) {
  for (const Contact& contact : probe.contacts.contacts) {
    if (contact.gap > 0) continue;
    for (const SurfaceItem& item : list.surfaces) {
      if (item.organ != contact.organ || contact.triangle >= item.triangles.size()) continue;
      const TriangleIndices& nodes = item.triangles[contact.triangle];
      for (int k = 0; k < 3; ++k) {
        tint(list, contact.organ, nodes[static_cast<std::size_t>(k)],
             kPatchTint * std::clamp(contact.barycentric[k], 0.0, 1.0));
      }
    }
  }
  for_each_on_faces(probe, view,
                    [&](std::size_t organ, std::uint32_t node, const Contact& contact) {
                      if (contact.gap <= 0) tint(list, organ, node, kPatchTint);
                    });
}

double shadow_radius(const scene::ProbeShape& shape, const SceneView& view) {
  if (const auto* sphere = std::get_if<scene::SphereShape>(&shape)) return sphere->radius;
  if (const auto* capsule = std::get_if<scene::CapsuleShape>(&shape)) return capsule->radius;
  return 0.08 * view.radius();
}

/// How far a probe is: a line to the surface below it, and a shadow there that darkens as it nears.
void add_plumb_line(const ProbeView& probe, const SceneView& view, DrawList& list) {
  const auto foot = foot_on_surface(view, probe.pose.position);
  if (!foot) return;
  const Vec3 up = probe.pose.position - foot->point;
  if (!(up.dot(foot->normal) > 0)) return;
  list.lines.push_back({probe.pose.position, foot->point, kPlumbColor});
  const double radius = shadow_radius(probe.description.shape, view);
  const double nearness = std::clamp(1.5 - up.norm() / view.radius(), 0.0, 1.0);
  list.shadows.push_back({foot->point + 0.15 * radius * foot->normal, foot->normal,
                          kShadowWidth * radius, kDarkest * nearness});
}

void add_contact(const ProbeView& probe, const Contact& contact, double normal_length,
                 DrawList& list) {
  if (contact.gap > 0) return;  // near, but apart
  const Vec3 p = probe.pose.to_world(contact.point_P);
  const Vec3 normal = probe.pose.rotation * contact.normal_P;
  list.points.push_back({p, kContactColor, 5});
  list.lines.push_back({p, p + normal_length * normal, kContactColor});
}

void add_contacts(const ProbeView& probe, const SceneView& view, DrawList& list) {
  const double normal_length = 0.08 * view.radius();
  for_each_on_faces(probe, view, [&](std::size_t, std::uint32_t, const Contact& contact) {
    add_contact(probe, contact, normal_length, list);
  });
  for (const Contact& contact : probe.contacts.contacts) {
    add_contact(probe, contact, normal_length, list);
  }
}

/// @param force  [N]
std::string force_label(const ProbeView& probe, double force) {
  std::array<char, 64> label{};
  if (probe.force_error >= 1) {
    std::snprintf(label.data(), label.size(), "%.2f N (mesh: twice too large)", force);
  } else if (probe.force_error > 0) {
    std::snprintf(label.data(), label.size(), "%.2f N (mesh +%.0f %%)", force,
                  100 * probe.force_error);
  } else {
    std::snprintf(label.data(), label.size(), "%.2f N", force);
  }
  return label.data();
}

void add_probe(const ProbeView& probe, std::size_t index, const SceneView& view, DrawList& list) {
  const bool plane =
      std::holds_alternative<geometry::HalfSpace>(scene::form_of(probe.description.shape));
  BodyItem body;
  body.probe = index;
  body.pose = probe.pose;
  body.scale = plane ? 2.2 * view.radius() : 1;
  body.color = probe_color(index);
  body.opacity = plane ? 0.35 : 1;
  list.bodies.push_back(body);
  add_contacts(probe, view, list);
  tint_patch(probe, view, list);
  if (!plane) add_plumb_line(probe, view, list);

  const double force = probe.has_force ? probe.force.force.norm() : 0;
  if (force < kSmallestForce) return;
  ArrowItem arrow;
  arrow.tail = probe.pose.position;
  arrow.tip = arrow.tail + force_scale(view) * probe.force.force;
  arrow.shaft_radius = 0.012 * view.radius();
  arrow.color = kForceColor;
  arrow.label = force_label(probe, force);
  list.arrows.push_back(arrow);
}

}  // namespace

Rgb probe_color(std::size_t probe) { return kProbeColors[probe % kProbeColors.size()]; }

double force_scale(const SceneView& view) {
  const double longest = 1.6 * view.radius() / view.scene().haptics.max_force;
  return round_up(longest / 2);
}

DrawList make_draw_list(const SceneView& view, const ViewOptions& options,
                        const Vec3& view_direction) {
  DrawList list;
  if (options.cut) {
    const Vec3 point = view.center() - *options.cut * view.radius() * view_direction;
    list.cut = CutItem{point, view_direction};
  }
  for (std::size_t i = 0; i < view.organs().size(); ++i) {
    if (view.organs()[i].known) add_organ(view.organs()[i], i, view, options, list);
  }
  for (std::size_t i = 0; i < view.probes().size(); ++i) {
    if (view.probes()[i].seen) add_probe(view.probes()[i], i, view, list);
  }
  return list;
}

void append_disc(const DiscItem& disc, geometry::TriangleSurface& out) {
  constexpr std::uint32_t kSides = 24;
  const Vec3 u = disc.normal.unitOrthogonal(), v = disc.normal.cross(u);
  const auto middle = static_cast<std::uint32_t>(out.nodes.size());
  out.nodes.push_back(disc.center);
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    out.nodes.push_back(disc.center + disc.radius * (std::cos(angle) * u + std::sin(angle) * v));
    out.triangles.push_back({middle, middle + 1 + i, middle + 1 + (i + 1) % kSides});
  }
}

void append_arrow(const ArrowItem& arrow, geometry::TriangleSurface& out) {
  constexpr int kSides = 20;
  const Vec3 axis = arrow.tip - arrow.tail;
  const double length = axis.norm();
  if (!(length > 0)) return;
  const Vec3 direction = axis / length;
  const Vec3 u = direction.unitOrthogonal(), v = direction.cross(u);
  const double head = std::min(6 * arrow.shaft_radius, 0.6 * length);
  const Vec3 neck = arrow.tip - head * direction;

  // Rings from tail to tip: closed end, shaft, shoulder; each joined to the next.
  const std::array<std::pair<Vec3, double>, 5> rings{{{arrow.tail, 0.0},
                                                      {arrow.tail, arrow.shaft_radius},
                                                      {neck, arrow.shaft_radius},
                                                      {neck, 2.6 * arrow.shaft_radius},
                                                      {arrow.tip, 0.0}}};
  const auto first = static_cast<std::uint32_t>(out.nodes.size());
  for (const auto& [center, radius] : rings) {
    for (int i = 0; i < kSides; ++i) {
      const double angle = 2 * std::numbers::pi * i / kSides;
      out.nodes.push_back(center + radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
  }
  for (std::uint32_t ring = 0; ring + 1 < rings.size(); ++ring) {
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const std::uint32_t a = first + ring * kSides + i,
                          b = first + ring * kSides + (i + 1) % kSides;
      out.triangles.push_back({a, b, b + kSides});
      out.triangles.push_back({a, b + kSides, a + kSides});
    }
  }
}

}  // namespace palpate::visualizer
