#include "visualizer/overlay_actor.h"

#include <vtkBrush.h>
#include <vtkContext2D.h>
#include <vtkContextActor.h>
#include <vtkContextItem.h>
#include <vtkContextScene.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPen.h>
#include <vtkRenderer.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <filesystem>
#include <vector>

namespace palpate::visualizer {
namespace {

constexpr const char* kFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf";
constexpr const char* kBoldFont = "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf";

unsigned char alpha(double opacity) { return static_cast<unsigned char>(255 * opacity + 0.5); }

void paint(vtkContext2D& painter, const RectItem& rect) {
  painter.GetPen()->SetLineType(vtkPen::NO_PEN);
  painter.GetBrush()->SetColor(rect.color[0], rect.color[1], rect.color[2], alpha(rect.opacity));
  painter.DrawRect(static_cast<float>(rect.box.x), static_cast<float>(rect.box.y),
                   static_cast<float>(rect.box.width), static_cast<float>(rect.box.height));
}

void paint(vtkContext2D& painter, const PolylineItem& line) {
  painter.GetPen()->SetLineType(vtkPen::SOLID_LINE);
  painter.GetPen()->SetWidth(static_cast<float>(line.width));
  painter.GetPen()->SetColor(line.color[0], line.color[1], line.color[2], alpha(line.opacity));
  painter.DrawPoly(const_cast<float*>(line.points.data()),
                   static_cast<int>(line.points.size() / 2));
}

/// A plain sans-serif face where the system has it, else VTK's own.
void set_font(vtkTextProperty& text, bool bold) {
  static const bool kPresent = std::filesystem::exists(kFont) && std::filesystem::exists(kBoldFont);
  if (kPresent) {
    text.SetFontFamily(VTK_FONT_FILE);
    text.SetFontFile(bold ? kBoldFont : kFont);
  } else {
    text.SetFontFamilyToArial();
    text.SetBold(bold);
  }
}

void paint(vtkContext2D& painter, const TextItem& item) {
  if (item.text.empty()) return;
  vtkTextProperty* text = painter.GetTextProp();
  set_font(*text, item.bold);
  text->SetFontSize(item.size);
  text->SetColor(item.color[0] / 255.0, item.color[1] / 255.0, item.color[2] / 255.0);
  text->SetOrientation(item.angle);
  text->SetVerticalJustificationToCentered();
  switch (item.align) {
    case Align::kLeft:
      text->SetJustificationToLeft();
      break;
    case Align::kCenter:
      text->SetJustificationToCentered();
      break;
    case Align::kRight:
      text->SetJustificationToRight();
      break;
  }
  painter.DrawString(static_cast<float>(item.x), static_cast<float>(item.y), item.text.c_str());
}

class Painter : public vtkContextItem {
 public:
  static Painter* New();
  vtkTypeMacro(Painter, vtkContextItem) Painter(const Painter&) = delete;
  Painter& operator=(const Painter&) = delete;

  Overlay overlay;  // this painter's share

  bool Paint(vtkContext2D* painter) override {
    for (const RectItem& rect : overlay.rects) paint(*painter, rect);
    for (const PolylineItem& line : overlay.lines) paint(*painter, line);
    for (const TextItem& text : overlay.texts) paint(*painter, text);
    return true;
  }

 protected:
  Painter() = default;
  ~Painter() override = default;
};

vtkStandardNewMacro(Painter)

    /// VTK keeps the images of 50 texts per actor; with more in one, each frame renders all anew.
    constexpr std::size_t kTextsPerActor = 40;

struct PaintedActor {
  vtkNew<vtkContextActor> actor;
  vtkNew<Painter> painter;

  explicit PaintedActor(vtkRenderer& layer) {
    actor->GetScene()->AddItem(painter);
    layer.AddActor(actor);
  }
};

}  // namespace

struct OverlayActor::Impl {
  vtkRenderer& layer;
  std::vector<std::unique_ptr<PaintedActor>> actors;
};

OverlayActor::OverlayActor(vtkRenderer& layer) : impl_(new Impl{layer, {}}) {}

OverlayActor::~OverlayActor() = default;

void OverlayActor::update(const Overlay& overlay) {
  const std::size_t needed = overlay.texts.size() / kTextsPerActor + 1;
  while (impl_->actors.size() < needed) {
    impl_->actors.push_back(std::make_unique<PaintedActor>(impl_->layer));
  }
  for (std::size_t i = 0; i < impl_->actors.size(); ++i) {
    Painter& painter = *impl_->actors[i]->painter;
    painter.overlay = {};
    if (i == 0) {
      painter.overlay.rects = overlay.rects;
      painter.overlay.lines = overlay.lines;
    }
    const std::size_t first = std::min(i * kTextsPerActor, overlay.texts.size());
    const std::size_t last = std::min(first + kTextsPerActor, overlay.texts.size());
    painter.overlay.texts.assign(overlay.texts.begin() + static_cast<std::ptrdiff_t>(first),
                                 overlay.texts.begin() + static_cast<std::ptrdiff_t>(last));
    painter.GetScene()->SetDirty(true);
  }
}

}  // namespace palpate::visualizer
