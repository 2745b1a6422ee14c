// The 3-D part of the picture as VTK objects, kept from frame to frame: moving nodes are updated
// in place, topology only when its version changes.
#pragma once

#include <memory>
#include <vector>

#include "modules/geometry/triangle_surface.h"
#include "visualizer/draw_list.h"

class vtkRenderer;

namespace palpate::visualizer {

class SceneActors {
 public:
  /// @param solids  layer of organs, springs and probes
  /// @param see_through  layer on top of it, with its own depth: forces, contacts, and the ghosts
  ///        of probes that are behind tissue
  SceneActors(vtkRenderer& solids, vtkRenderer& see_through,
              std::vector<geometry::TriangleSurface> probe_surfaces);
  ~SceneActors();

  void update(const DrawList& list);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::visualizer
