// The picture of a SceneView as plain lists: surfaces, springs, bodies, points, arrows. Made anew
// for each frame; big arrays are views into the SceneView, valid until it changes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "modules/geometry/triangle_surface.h"
#include "visualizer/color_map.h"
#include "visualizer/scene_view.h"
#include "visualizer/view_options.h"

namespace palpate::visualizer {

/// An organ. Triangles and springs change only with shape_version.
struct SurfaceItem {
  std::size_t organ = 0;
  std::uint64_t shape_version = 0;
  std::uint64_t positions_version = 0;
  std::span<const float> positions;  ///< (node_count × 3) in W [m]
  std::span<const float> normals;    ///< (node_count × 3)
  std::span<const TriangleIndices> triangles;
  std::vector<std::uint8_t> colors;  ///< (node_count × 3)
  double opacity = 1;
  bool wireframe = false;
};

/// One spring family of one organ, between nodes of its SurfaceItem.
struct SpringItem {
  std::size_t organ = 0;
  SpringFamily family = SpringFamily::kStructural;
  std::span<const OrganView::SpringEnds> ends;
  Rgb color{};
};

/// A probe; its surface is the scene's and does not change.
struct BodyItem {
  std::size_t probe = 0;
  Pose pose;
  double scale = 1;  ///< of the surface
  Rgb color{};
  double opacity = 1;
};

struct PointItem {
  Vec3 position;  ///< in W [m]
  Rgb color{};
  double size = 6;  ///< diameter [pixels]
};

struct LineItem {
  Vec3 from, to;  ///< in W [m]
  Rgb color{};
};

struct ArrowItem {
  Vec3 tail, tip;               ///< in W [m]
  double shaft_radius = 0.001;  ///< [m]
  Rgb color{};
  std::string label;  ///< beside the tip
};

/// A plane: organs are drawn on its far side only.
struct CutItem {
  Vec3 point, normal;  ///< in W [m], unit, to what is drawn
};

/// A flat round shadow on a surface.
struct DiscItem {
  Vec3 center, normal;  ///< in W [m], unit
  double radius = 0;    ///< [m]
  double opacity = 0;
};

struct DrawList {
  std::vector<SurfaceItem> surfaces;
  std::vector<SpringItem> springs;
  std::vector<BodyItem> bodies;
  std::vector<PointItem> points;
  std::vector<LineItem> lines;
  std::vector<DiscItem> shadows;
  std::vector<ArrowItem> arrows;
  std::optional<CutItem> cut;
};

/// @param view_direction  unit, of the camera: the cut is across it
DrawList make_draw_list(const SceneView& view, const ViewOptions& options,
                        const Vec3& view_direction = Vec3::UnitY());

/// Colour of a probe in the picture and in the plots.
Rgb probe_color(std::size_t probe);

/// Length that 1 N has in the picture [m]: a round number, such that the largest force the scene
/// allows is about as long as the organs' radius.
double force_scale(const SceneView& view);

/// The disc as a fan of triangles, appended to `out`.
void append_disc(const DiscItem& disc, geometry::TriangleSurface& out);

/// The arrow as a solid: a shaft and a head, appended to `out`. Nothing if tail = tip.
void append_arrow(const ArrowItem& arrow, geometry::TriangleSurface& out);

}  // namespace palpate::visualizer
