// The flat part of the picture, painted with VTK's 2-D context.
#pragma once

#include <memory>

#include "visualizer/overlay.h"

class vtkRenderer;

namespace palpate::visualizer {

class OverlayActor {
 public:
  explicit OverlayActor(vtkRenderer& layer);
  ~OverlayActor();

  void update(const Overlay& overlay);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::visualizer
