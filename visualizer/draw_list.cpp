#include "visualizer/draw_list.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <span>

namespace palpate::visualizer {
namespace {

constexpr std::array<Rgb, 4> kProbeColors{
    {{126, 203, 255}, {255, 214, 102}, {150, 230, 150}, {230, 160, 255}}};
constexpr std::array<Rgb, 3> kSpringColors{{{205, 215, 225}, {255, 196, 84}, {96, 214, 214}}};
constexpr Rgb kVirtualNodeColor{96, 214, 214};
constexpr Rgb kContactColor{255, 255, 255};
constexpr Rgb kForceColor{255, 236, 90};
constexpr double kSmallestForce = 1e-3;  // shown as an arrow [N]

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
  const bool looks_inside = options.springs[static_cast<std::size_t>(SpringFamily::kInner)] ||
                            options.springs[static_cast<std::size_t>(SpringFamily::kBending)];
  item.opacity = looks_inside ? 0.35 : 1;
  list.surfaces.push_back(std::move(item));

  for (std::size_t f = 0; f < organ.springs.size(); ++f) {
    if (!options.springs[f]) continue;
    list.springs.push_back(
        {index, static_cast<SpringFamily>(f), organ.springs[f], kSpringColors[f]});
  }
  if (!options.springs[static_cast<std::size_t>(SpringFamily::kInner)]) return;
  for (auto i = organ.surface.surface_node_count; i < organ.node_count(); ++i) {
    list.points.push_back({organ.node(i), kVirtualNodeColor, 12});
  }
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
  std::span<const std::uint32_t> nodes = probe.contacts.face_nodes;
  for (const FaceContacts& face : probe.contacts.faces) {
    const auto own = nodes.first(face.node_count);
    nodes = nodes.subspan(face.node_count);
    if (face.organ >= view.organs().size()) continue;
    const OrganView& organ = view.organs()[face.organ];
    for (const std::uint32_t node : own) {
      if (node >= organ.node_count()) continue;
      const Vec3 tissue_P = probe.contacts.probe_pose.to_body(organ.node(node));
      add_contact(probe, contact_on_face(face, tissue_P), normal_length, list);
    }
  }
  for (const Contact& contact : probe.contacts.contacts) {
    add_contact(probe, contact, normal_length, list);
  }
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

  const double force = probe.has_force ? probe.force.force.norm() : 0;
  if (force < kSmallestForce) return;
  ArrowItem arrow;
  arrow.tail = probe.pose.position;
  arrow.tip = arrow.tail + force_scale(view) * probe.force.force;
  arrow.shaft_radius = 0.012 * view.radius();
  arrow.color = kForceColor;
  std::array<char, 32> label{};
  std::snprintf(label.data(), label.size(), "%.2f N", force);
  arrow.label = label.data();
  list.arrows.push_back(arrow);
}

}  // namespace

Rgb probe_color(std::size_t probe) { return kProbeColors[probe % kProbeColors.size()]; }

double force_scale(const SceneView& view) {
  const double longest = 1.6 * view.radius() / view.scene().haptics.max_force;
  return round_up(longest / 2);
}

DrawList make_draw_list(const SceneView& view, const ViewOptions& options) {
  DrawList list;
  for (std::size_t i = 0; i < view.organs().size(); ++i) {
    if (view.organs()[i].known) add_organ(view.organs()[i], i, view, options, list);
  }
  for (std::size_t i = 0; i < view.probes().size(); ++i) {
    if (view.probes()[i].seen) add_probe(view.probes()[i], i, view, list);
  }
  return list;
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
