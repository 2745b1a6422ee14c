#include "visualizer/scene_actors.h"

#include <vtkActor.h>
#include <vtkActorCollection.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPlane.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkShaderProperty.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>

#include "visualizer/lamps.h"

namespace palpate::visualizer {
namespace {

constexpr double kSharpEdge = 40;  // degrees: sharper edges of a probe are not smoothed

// How an organ takes the light.
constexpr double kAmbient = 0.12, kGlint = 0.28;

std::string vec3_text(const Vec3& v) {
  return "vec3(" + std::to_string(v.x()) + ", " + std::to_string(v.y()) + ", " +
         std::to_string(v.z()) + ")";
}

/// The lamps on an organ, written out: VTK's loop over lights, with a power for each glint, takes a
/// third of a fine organ's picture in software. The glint's 32nd power is five squares.
std::string light_shader() {
  std::string code = "  vec3 shade = vec3(" + std::to_string(kAmbient) + "), glint = vec3(0.0);\n";
  for (const Lamp& lamp : kLamps) {
    const Vec3 from = Vec3(lamp.from.data()).normalized();
    const Vec3 color = lamp.intensity * Vec3(lamp.color.data());
    code += "  {\n    float facing = max(0.0, dot(normalVCVSOutput, " + vec3_text(from) + "));\n" +
            "    shade += facing * " + vec3_text(color) + ";\n";
    if (from.z() > 0) {  // from behind, nothing that is seen glints
      code += "    float g = max(0.0, 2.0 * facing * normalVCVSOutput.z - " +
              std::to_string(from.z()) + ");\n    g *= g; g *= g; g *= g; g *= g; g *= g;\n" +
              "    glint += g * " + vec3_text(kGlint * color) + ";\n";
    }
    code += "  }\n";
  }
  return code + "  fragOutput0 = vec4(diffuseColor * shade + glint, opacity);\n";
}

void set_color(vtkActor& actor, const Rgb& rgb) {
  actor.GetProperty()->SetColor(rgb[0] / 255.0, rgb[1] / 255.0, rgb[2] / 255.0);
}

template <class Cells>
void set_cells(vtkCellArray& out, const Cells& cells) {
  out.Reset();
  for (const auto& cell : cells) {
    out.InsertNextCell(static_cast<vtkIdType>(cell.size()));
    for (const auto i : cell) out.InsertCellPoint(i);
  }
  out.Modified();
}

/// Copies 3-component values into an array that keeps its memory.
template <class Array, class Value>
void copy_triples(Array& array, std::span<const Value> values) {
  array.SetNumberOfTuples(static_cast<vtkIdType>(values.size() / 3));
  std::copy(values.begin(), values.end(), array.GetPointer(0));
  array.Modified();
}

void set_surface(vtkPolyData& data, const geometry::TriangleSurface& surface) {
  vtkNew<vtkPoints> points;
  for (const Vec3& p : surface.nodes) points->InsertNextPoint(p.data());
  vtkNew<vtkCellArray> cells;
  set_cells(*cells, surface.triangles);
  data.SetPoints(points);
  data.SetPolys(cells);
}

/// A mesh with its mapper and actor.
struct Part {
  vtkNew<vtkPolyData> data;
  vtkNew<vtkPolyDataMapper> mapper;
  vtkNew<vtkActor> actor;

  explicit Part(vtkRenderer& layer) {
    mapper->SetInputData(data);
    actor->SetMapper(mapper);
    // Blended in the actors' order: VTK's pass for what is seen through costs half a picture in
    // software, however little that is.
    actor->ForceOpaqueOn();
    layer.AddActor(actor);
  }
  /// Drawn on one side of the plane only; nullptr: all.
  void cut(vtkPlane* plane) {
    const bool is_cut = mapper->GetNumberOfClippingPlanes() > 0;
    if (is_cut && plane == nullptr) mapper->RemoveAllClippingPlanes();
    if (!is_cut && plane != nullptr) mapper->AddClippingPlane(plane);
  }
};

/// An organ and its springs, which share the organ's points.
struct OrganPart {
  std::uint64_t shape_version = 0, positions_version = 0;
  vtkNew<vtkPoints> points;
  vtkNew<vtkFloatArray> coordinates, normals;
  vtkNew<vtkUnsignedCharArray> colors;
  Part surface;
  std::array<std::unique_ptr<Part>, 3> springs;
  std::array<std::uint64_t, 3> spring_versions{};

  explicit OrganPart(vtkRenderer& layer) : surface(layer) {
    coordinates->SetNumberOfComponents(3);
    normals->SetNumberOfComponents(3);
    colors->SetNumberOfComponents(3);
    points->SetData(coordinates);
    normals->SetName("Normals");
    surface.data->SetPoints(points);
    surface.data->GetPointData()->SetNormals(normals);
    surface.data->GetPointData()->SetScalars(colors);
    // Lines on the surface stay in front of it.
    surface.mapper->SetResolveCoincidentTopologyToPolygonOffset();
    surface.mapper->SetRelativeCoincidentTopologyPolygonOffsetParameters(1, 1);
    vtkProperty* look = surface.actor->GetProperty();
    look->SetInterpolationToPhong();
    surface.actor->GetShaderProperty()->AddFragmentShaderReplacement("//VTK::Light::Impl", true,
                                                                     light_shader(), false);
    look->SetAmbient(kAmbient);
    look->SetDiffuse(0.9);
  }

  void update(const SurfaceItem& item, vtkPlane* cut) {
    surface.cut(cut);
    if (shape_version != item.shape_version) {
      vtkNew<vtkCellArray> cells;
      set_cells(*cells, item.triangles);
      surface.data->SetPolys(cells);
      shape_version = item.shape_version;
    }
    if (positions_version != item.positions_version) {
      copy_triples(*coordinates, item.positions);
      copy_triples(*normals, item.normals);
      points->Modified();
      positions_version = item.positions_version;
    }
    copy_triples(*colors, std::span<const std::uint8_t>(item.colors));
    surface.data->Modified();
    surface.actor->GetProperty()->SetOpacity(item.opacity);
    vtkProperty* look = surface.actor->GetProperty();
    look->SetRepresentation(item.wireframe ? VTK_WIREFRAME : VTK_SURFACE);
    // Closed, so what faces away is hidden, unless one looks inside.
    look->SetBackfaceCulling(!item.wireframe && !cut);
  }

  void update(const SpringItem& item, vtkPlane* cut, vtkRenderer& layer) {
    const auto family = static_cast<std::size_t>(item.family);
    auto& part = springs[family];
    if (!part) {
      part = std::make_unique<Part>(layer);
      part->data->SetPoints(points);
      part->actor->GetProperty()->LightingOff();
      part->actor->GetProperty()->SetLineWidth(item.family == SpringFamily::kInner ? 1.2f : 1.0f);
      part->actor->GetProperty()->SetOpacity(0.7);
      set_color(*part->actor, item.color);
    }
    if (spring_versions[family] != shape_version) {
      vtkNew<vtkCellArray> cells;
      set_cells(*cells, item.ends);
      part->data->SetLines(cells);
      spring_versions[family] = shape_version;
    }
    part->cut(cut);
    part->data->Modified();
    part->actor->VisibilityOn();
  }
};

/// A probe among the solids, and its ghost where tissue hides it.
struct BodyPart {
  Part solid, ghost;
  vtkNew<vtkMatrix4x4> placement;

  BodyPart(vtkRenderer& solids, vtkRenderer& see_through, const geometry::TriangleSurface& surface)
      : solid(solids), ghost(see_through) {
    vtkNew<vtkPolyData> plain;
    set_surface(*plain, surface);
    vtkNew<vtkPolyDataNormals> smooth;
    smooth->SetInputData(plain);
    smooth->SetFeatureAngle(kSharpEdge);
    smooth->Update();
    for (Part* part : {&solid, &ghost}) {
      part->data->ShallowCopy(smooth->GetOutput());
      part->actor->SetUserMatrix(placement);
      part->actor->VisibilityOff();
      part->actor->GetProperty()->SetSpecular(0.5);
      part->actor->GetProperty()->SetSpecularPower(40);
    }
    ghost.actor->GetProperty()->BackfaceCullingOn();
  }

  void update(const BodyItem& item) {
    const Mat3 rotation = item.scale * item.pose.rotation.toRotationMatrix();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        placement->SetElement(row, column, rotation(row, column));
      }
      placement->SetElement(row, 3, item.pose.position[row]);
    }
    for (Part* part : {&solid, &ghost}) {
      set_color(*part->actor, item.color);
      part->actor->VisibilityOn();
    }
    solid.actor->GetProperty()->SetOpacity(item.opacity);
    ghost.actor->GetProperty()->SetOpacity(0.3 * item.opacity);
  }
};

/// Contacts, virtual nodes and arrows: few, made anew for each frame.
struct Marks {
  Part lines;
  std::vector<std::unique_ptr<Part>> points, shadows, arrows;

  explicit Marks(vtkRenderer& layer) : lines(layer) {
    lines.actor->GetProperty()->LightingOff();
    lines.actor->GetProperty()->SetLineWidth(1.5f);
  }

  static Part& part(std::vector<std::unique_ptr<Part>>& parts, std::size_t i, vtkRenderer& layer) {
    if (i == parts.size()) parts.push_back(std::make_unique<Part>(layer));
    parts[i]->actor->VisibilityOn();
    return *parts[i];
  }
  static void hide_from(const std::vector<std::unique_ptr<Part>>& parts, std::size_t first) {
    for (std::size_t i = first; i < parts.size(); ++i) parts[i]->actor->VisibilityOff();
  }

  void update_points(const std::vector<PointItem>& items, vtkRenderer& layer);
  void update_lines(const std::vector<LineItem>& items);
  void update_shadows(const std::vector<DiscItem>& items, vtkRenderer& layer);
  void update_arrows(const std::vector<ArrowItem>& items, vtkRenderer& layer);
};

void Marks::update_points(const std::vector<PointItem>& items, vtkRenderer& layer) {
  std::map<double, std::vector<const PointItem*>> by_size;  // one actor has one size
  for (const PointItem& item : items) by_size[item.size].push_back(&item);
  std::size_t count = 0;
  for (const auto& [size, group] : by_size) {
    Part& drawn = part(points, count++, layer);
    vtkNew<vtkPoints> positions;
    vtkNew<vtkCellArray> cells;
    vtkNew<vtkUnsignedCharArray> colors;
    colors->SetNumberOfComponents(3);
    for (const PointItem* item : group) {
      const vtkIdType id = positions->InsertNextPoint(item->position.data());
      cells->InsertNextCell(1, &id);
      colors->InsertNextTypedTuple(item->color.data());
    }
    drawn.data->SetPoints(positions);
    drawn.data->SetVerts(cells);
    drawn.data->GetPointData()->SetScalars(colors);
    drawn.actor->GetProperty()->SetPointSize(static_cast<float>(size));
    drawn.actor->GetProperty()->RenderPointsAsSpheresOn();
  }
  hide_from(points, count);
}

void Marks::update_lines(const std::vector<LineItem>& items) {
  lines.actor->SetVisibility(!items.empty());
  vtkNew<vtkPoints> positions;
  vtkNew<vtkCellArray> cells;
  vtkNew<vtkUnsignedCharArray> colors;
  colors->SetNumberOfComponents(3);
  for (const LineItem& item : items) {
    const std::array<vtkIdType, 2> ends{positions->InsertNextPoint(item.from.data()),
                                        positions->InsertNextPoint(item.to.data())};
    cells->InsertNextCell(2, ends.data());
    for (int end = 0; end < 2; ++end) colors->InsertNextTypedTuple(item.color.data());
  }
  lines.data->SetPoints(positions);
  lines.data->SetLines(cells);
  lines.data->GetPointData()->SetScalars(colors);
}

void Marks::update_shadows(const std::vector<DiscItem>& items, vtkRenderer& layer) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    Part& drawn = part(shadows, i, layer);
    geometry::TriangleSurface disc;
    append_disc(items[i], disc);
    set_surface(*drawn.data, disc);
    vtkProperty* look = drawn.actor->GetProperty();
    look->LightingOff();
    look->SetColor(0, 0, 0);
    look->SetOpacity(items[i].opacity);
    look->BackfaceCullingOn();  // on the far side of an organ there is nothing to see
  }
  hide_from(shadows, items.size());
}

void Marks::update_arrows(const std::vector<ArrowItem>& items, vtkRenderer& layer) {
  for (std::size_t i = 0; i < items.size(); ++i) {
    Part& drawn = part(arrows, i, layer);
    geometry::TriangleSurface solid;
    append_arrow(items[i], solid);
    set_surface(*drawn.data, solid);
    drawn.actor->GetProperty()->SetAmbient(0.35);
    set_color(*drawn.actor, items[i].color);
  }
  hide_from(arrows, items.size());
}

}  // namespace

struct SceneActors::Impl {
  vtkRenderer& solids;
  vtkRenderer& see_through;
  std::map<std::size_t, std::unique_ptr<OrganPart>> organs;
  std::vector<std::unique_ptr<BodyPart>> bodies;
  Marks marks;
  vtkNew<vtkPlane> plane;
  std::vector<vtkActor*> last;  // what is seen through, as drawn
  int actor_count = 0;

  Impl(vtkRenderer& s, vtkRenderer& t) : solids(s), see_through(t), marks(t) {}
  void draw_last_what_is_seen_through();
};

/// Blending needs it: organs, then shadows on them, then probes, then probes' ghosts.
void SceneActors::Impl::draw_last_what_is_seen_through() {
  std::vector<vtkActor*> wanted;
  for (const auto& [index, organ] : organs) wanted.push_back(organ->surface.actor);
  for (const auto& shadow : marks.shadows) wanted.push_back(shadow->actor);
  for (const auto& body : bodies) wanted.push_back(body->solid.actor);
  std::erase_if(wanted, [](vtkActor* actor) { return actor->GetProperty()->GetOpacity() == 1; });
  const int count =
      solids.GetActors()->GetNumberOfItems() + see_through.GetActors()->GetNumberOfItems();
  if (wanted == last && count == actor_count) return;
  last = wanted;
  actor_count = count;
  for (vtkActor* actor : wanted) {
    solids.RemoveActor(actor);
    solids.AddActor(actor);
  }
  for (const auto& body : bodies) {
    see_through.RemoveActor(body->ghost.actor);
    see_through.AddActor(body->ghost.actor);
  }
}

SceneActors::SceneActors(vtkRenderer& solids, vtkRenderer& see_through,
                         std::vector<geometry::TriangleSurface> probe_surfaces)
    : impl_(std::make_unique<Impl>(solids, see_through)) {
  for (const auto& surface : probe_surfaces) {
    impl_->bodies.push_back(std::make_unique<BodyPart>(solids, see_through, surface));
  }
}

SceneActors::~SceneActors() = default;

void SceneActors::update(const DrawList& list) {
  vtkPlane* cut = list.cut ? impl_->plane.Get() : nullptr;
  if (list.cut) {
    impl_->plane->SetOrigin(list.cut->point.x(), list.cut->point.y(), list.cut->point.z());
    impl_->plane->SetNormal(list.cut->normal.x(), list.cut->normal.y(), list.cut->normal.z());
  }
  for (const auto& [index, organ] : impl_->organs) {
    for (const auto& part : organ->springs) {
      if (part) part->actor->VisibilityOff();
    }
  }
  for (const SurfaceItem& item : list.surfaces) {
    auto& organ = impl_->organs[item.organ];
    if (!organ) organ = std::make_unique<OrganPart>(impl_->solids);
    organ->update(item, cut);
  }
  for (const SpringItem& item : list.springs) {
    impl_->organs.at(item.organ)->update(item, cut, impl_->solids);
  }
  for (const BodyItem& item : list.bodies) impl_->bodies.at(item.probe)->update(item);
  impl_->marks.update_points(list.points, impl_->see_through);
  impl_->marks.update_lines(list.lines);
  impl_->marks.update_shadows(list.shadows, impl_->solids);
  impl_->marks.update_arrows(list.arrows, impl_->see_through);
  impl_->draw_last_what_is_seen_through();
}

}  // namespace palpate::visualizer
