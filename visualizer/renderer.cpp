#include "visualizer/renderer.h"

#include <vtkAutoInit.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include <algorithm>
#include <array>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "modules/core/whole_file.h"
#include "visualizer/lamps.h"
#include "visualizer/overlay_actor.h"
#include "visualizer/scene_actors.h"
#include "visualizer/shared_picture.h"

VTK_MODULE_INIT(vtkRenderingOpenGL2)
VTK_MODULE_INIT(vtkRenderingContextOpenGL2)
VTK_MODULE_INIT(vtkRenderingFreeType)
VTK_MODULE_INIT(vtkInteractionStyle)

namespace palpate::visualizer {
namespace {

// Background, from bottom to top, of the whole window.
constexpr double kBottom[3] = {0.055, 0.07, 0.095};
constexpr double kTop[3] = {0.17, 0.205, 0.26};

void light(vtkRenderer& layer) {
  layer.AutomaticLightCreationOff();
  for (const Lamp& lamp : kLamps) {
    vtkNew<vtkLight> made;
    made->SetLightTypeToCameraLight();
    made->SetPosition(lamp.from[0], lamp.from[1], lamp.from[2]);
    made->SetFocalPoint(0, 0, 0);
    made->SetColor(lamp.color.data());
    made->SetIntensity(lamp.intensity);
    layer.AddLight(made);
  }
}

MouseButton button_of(unsigned long event) {
  switch (event) {
    case vtkCommand::LeftButtonPressEvent:
    case vtkCommand::LeftButtonReleaseEvent:
      return MouseButton::kLeft;
    case vtkCommand::MiddleButtonPressEvent:
    case vtkCommand::MiddleButtonReleaseEvent:
      return MouseButton::kMiddle;
    case vtkCommand::RightButtonPressEvent:
    case vtkCommand::RightButtonReleaseEvent:
      return MouseButton::kRight;
    default:
      return MouseButton::kNone;
  }
}

InputEvent translate(vtkRenderWindowInteractor& source, unsigned long event) {
  InputEvent out;
  out.x = source.GetEventPosition()[0];
  out.y = source.GetEventPosition()[1];
  out.shift = source.GetShiftKey() != 0;
  out.control = source.GetControlKey() != 0;
  out.button = button_of(event);
  switch (event) {
    case vtkCommand::LeftButtonPressEvent:
    case vtkCommand::MiddleButtonPressEvent:
    case vtkCommand::RightButtonPressEvent:
      out.kind = InputEvent::Kind::kPress;
      break;
    case vtkCommand::LeftButtonReleaseEvent:
    case vtkCommand::MiddleButtonReleaseEvent:
    case vtkCommand::RightButtonReleaseEvent:
      out.kind = InputEvent::Kind::kRelease;
      break;
    case vtkCommand::MouseWheelForwardEvent:
    case vtkCommand::MouseWheelBackwardEvent:
      out.kind = InputEvent::Kind::kWheel;
      out.wheel_steps = event == vtkCommand::MouseWheelForwardEvent ? 1 : -1;
      break;
    case vtkCommand::KeyPressEvent:
      out.kind = InputEvent::Kind::kKey;
      out.key = source.GetKeySym() != nullptr ? source.GetKeySym() : "";
      break;
    case vtkCommand::ExitEvent:
      out.kind = InputEvent::Kind::kClose;
      break;
    default:
      break;
  }
  return out;
}

}  // namespace

struct Renderer::Impl {
  // Layers: background and solids; then what is seen through them; then the flat part.
  vtkNew<vtkRenderWindow> window;
  vtkNew<vtkRenderer> backdrop, solids, see_through, flat;
  vtkSmartPointer<vtkRenderWindowInteractor> interactor;  // none without a window
  vtkNew<vtkCallbackCommand> listener;
  std::unique_ptr<SceneActors> actors;
  std::unique_ptr<OverlayActor> overlay;
  std::unique_ptr<SharedPicture> screen;  // without a graphics card: the way into the window
  vtkNew<vtkUnsignedCharArray> drawn;
  std::vector<InputEvent> events;

  void set_up_window(const RendererOptions& options);
  void set_up_layers();
  void suit_driver(bool live);
  void show();
  void listen();
  void aim(const Camera& camera);
};

void Renderer::Impl::set_up_window(const RendererOptions& options) {
  window->SetSize(options.width, options.height);
  window->SetWindowName(options.title.c_str());
  window->SetMultiSamples(0);  // FXAA smooths edges at less cost
  window->SetNumberOfLayers(4);
  if (!options.window) {
    window->SetShowWindow(false);
    window->SetUseOffScreenBuffers(true);
  }
}

void Renderer::Impl::set_up_layers() {
  backdrop->SetLayer(0);
  backdrop->SetInteractive(false);
  backdrop->GradientBackgroundOn();
  backdrop->SetBackground(kBottom);
  backdrop->SetBackground2(kTop);
  solids->SetLayer(1);
  see_through->SetLayer(2);
  flat->SetLayer(3);
  flat->SetInteractive(false);
  see_through->SetActiveCamera(solids->GetActiveCamera());
  light(*solids);
  light(*see_through);
  for (vtkRenderer* layer : {backdrop.Get(), solids.Get(), see_through.Get(), flat.Get()}) {
    window->AddRenderer(layer);
  }
}

/// Without a graphics card a live window does without FXAA, which takes two thirds of a picture's
/// time, and without VTK's way from memory to the window, which takes half of the rest.
void Renderer::Impl::suit_driver(bool live) {
  solids->UseFXAAOn();
  if (!live) return;
  window->Render();  // the driver is not known before
  const std::string driver = window->ReportCapabilities();
  const bool software =
      driver.find("llvmpipe") != std::string::npos || driver.find("softpipe") != std::string::npos;
  solids->SetUseFXAA(!software);
  if (!software) return;
  screen = SharedPicture::make(static_cast<_XDisplay*>(window->GetGenericDisplayId()),
                               reinterpret_cast<unsigned long>(window->GetGenericWindowId()));
  window->SetSwapBuffers(screen == nullptr);
}

void Renderer::Impl::show() {
  if (!screen) return;
  const int width = window->GetSize()[0], height = window->GetSize()[1];
  window->GetRGBACharPixelData(0, 0, width - 1, height - 1, /*front=*/0, drawn);
  const auto size = static_cast<std::size_t>(drawn->GetNumberOfValues());
  if (screen->show({drawn->GetPointer(0), size}, width, height)) return;
  screen.reset();
  window->SwapBuffersOn();
}

void Renderer::Impl::listen() {
  interactor = vtkSmartPointer<vtkRenderWindowInteractor>::New();
  listener->SetClientData(this);
  listener->SetCallback([](vtkObject* source, unsigned long event, void* self, void*) {
    auto* interactor_source = vtkRenderWindowInteractor::SafeDownCast(source);
    static_cast<Impl*>(self)->events.push_back(translate(*interactor_source, event));
  });
  for (const auto event :
       {vtkCommand::LeftButtonPressEvent, vtkCommand::LeftButtonReleaseEvent,
        vtkCommand::MiddleButtonPressEvent, vtkCommand::MiddleButtonReleaseEvent,
        vtkCommand::RightButtonPressEvent, vtkCommand::RightButtonReleaseEvent,
        vtkCommand::MouseMoveEvent, vtkCommand::MouseWheelForwardEvent,
        vtkCommand::MouseWheelBackwardEvent, vtkCommand::KeyPressEvent, vtkCommand::ExitEvent}) {
    interactor->AddObserver(event, listener);
  }
  interactor->SetInteractorStyle(nullptr);  // the camera is ours
  interactor->SetRenderWindow(window);
  interactor->Initialize();
}

void Renderer::Impl::aim(const Camera& camera) {
  vtkCamera* to = solids->GetActiveCamera();
  const auto& p = camera.position;
  const auto& t = camera.target;
  to->SetPosition(p.x(), p.y(), p.z());
  to->SetFocalPoint(t.x(), t.y(), t.z());
  to->SetViewUp(camera.up.x(), camera.up.y(), camera.up.z());
  to->SetViewAngle(camera.view_angle * 180 / std::numbers::pi);
  const double fraction = std::min(1.0, double(camera.width) / window->GetSize()[0]);
  solids->SetViewport(0, 0, fraction, 1);
  see_through->SetViewport(0, 0, fraction, 1);
  solids->ResetCameraClippingRange();
  const double range[2] = {0.05 * (p - t).norm(), 20 * (p - t).norm()};
  double solid_range[2];
  to->GetClippingRange(solid_range);
  // The see-through layer may hold more than the solids (a probe far away).
  to->SetClippingRange(std::min(solid_range[0], std::max(range[0], 0.2 * solid_range[0])),
                       std::max(solid_range[1], range[1]));
}

Renderer::Renderer(const RendererOptions& options,
                   std::vector<geometry::TriangleSurface> probe_surfaces)
    : impl_(std::make_unique<Impl>()) {
  impl_->set_up_window(options);
  impl_->set_up_layers();
  impl_->actors =
      std::make_unique<SceneActors>(*impl_->solids, *impl_->see_through, std::move(probe_surfaces));
  impl_->overlay = std::make_unique<OverlayActor>(*impl_->flat);
  if (options.window) impl_->listen();
  impl_->suit_driver(options.window);
}

Renderer::~Renderer() {
  if (impl_->interactor) impl_->interactor->RemoveObserver(impl_->listener);
  impl_->screen.reset();
  impl_->window->Finalize();
}

void Renderer::draw(const DrawList& list, const Overlay& overlay, const Camera& camera) {
  impl_->actors->update(list);
  impl_->overlay->update(overlay);
  impl_->aim(camera);
  impl_->window->Render();
  impl_->show();
}

int Renderer::width() const { return impl_->window->GetSize()[0]; }
int Renderer::height() const { return impl_->window->GetSize()[1]; }

std::vector<InputEvent> Renderer::take_events() {
  if (impl_->interactor) impl_->interactor->ProcessEvents();
  return std::exchange(impl_->events, {});
}

void Renderer::write_png(const std::filesystem::path& file) {
  vtkNew<vtkWindowToImageFilter> grab;
  grab->SetInput(impl_->window);
  grab->ReadFrontBufferOff();
  grab->ShouldRerenderOff();
  grab->Update();
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(grab->GetOutputPort());
  writer->WriteToMemoryOn();  // VTK says that a file could not be written, not why
  writer->SetCompressionLevel(4);
  writer->Write();
  vtkUnsignedCharArray* const bytes = writer->GetResult();
  if (writer->GetErrorCode() != 0 || bytes == nullptr) {
    throw std::runtime_error("cannot make picture " + file.string());
  }
  write_whole_file(file, {reinterpret_cast<const char*>(bytes->GetPointer(0)),
                          static_cast<std::size_t>(bytes->GetNumberOfValues())});
}

std::vector<std::uint8_t> Renderer::pixels() {
  vtkNew<vtkUnsignedCharArray> data;
  impl_->window->GetPixelData(0, 0, width() - 1, height() - 1, /*front=*/0, data);
  return {data->GetPointer(0), data->GetPointer(0) + data->GetNumberOfValues()};
}

}  // namespace palpate::visualizer
