// What keys do.
#include <algorithm>
#include <array>
#include <string_view>

#include "modules/scene/models.h"
#include "visualizer/interaction.h"

namespace palpate::visualizer {
namespace {

constexpr double kMarginAroundOrgans = 1.25;
constexpr double kUsualShape = 920.0 / 720;  // of the 3-D part in a window of 1280 x 720
constexpr double kCutStep = 0.1;             // of the organs' radius
constexpr std::array<const char*, 3> kFamilies{"structural", "bending", "inner"};

constexpr std::array kKeys{
    KeyMeaning{"drag on an organ", "press it there: the further, the deeper"},
    KeyMeaning{"wheel, ctrl + drag", "while pressing: depth; slide over it"},
    KeyMeaning{"shift + drag", "press, whatever is before the organ"},
    KeyMeaning{"drag a probe", "move it; wheel: in and out"},
    KeyMeaning{"g", "give probes back to their scripts"},
    KeyMeaning{"drag beside", "turn the camera"},
    KeyMeaning{"middle drag", "shift the camera"},
    KeyMeaning{"wheel, right drag", "nearer, further"},
    KeyMeaning{"Home, 0", "the camera as at the start"},
    KeyMeaning{"c", "colour by strain or displacement"},
    KeyMeaning{"1 2 3", "structural, bending, inner springs"},
    KeyMeaning{"t", "edges of tetrahedra"},
    KeyMeaning{"w", "wireframe"},
    KeyMeaning{"x", "a plane through the inside"},
    KeyMeaning{", .", "move the plane"},
    KeyMeaning{"space", "pause, go on"},
    KeyMeaning{"n", "one step"},
    KeyMeaning{"m", "slow motion"},
    KeyMeaning{"r", "reset"},
    KeyMeaning{"v", "record, end of recording"},
    KeyMeaning{"s", "screenshot (PNG)"},
    KeyMeaning{"h", "this help"},
    KeyMeaning{"q", "end the run"}};

/// Held beside another key, or of the desktop.
bool is_modifier(std::string_view name) {
  for (const std::string_view part : {"Shift", "Control", "Alt", "Meta", "Super", "Hyper", "Lock",
                                      "ISO_", "XF86", "Mode_switch", "Menu"}) {
    if (name.find(part) != std::string_view::npos) return true;
  }
  return name.empty();
}

bool has_solid(const SceneView& view) {
  return std::ranges::any_of(
      view.scene().organs, [](const scene::Organ& organ) { return scene::is_solid(organ.model); });
}

}  // namespace

std::span<const KeyMeaning> key_meanings() { return kKeys; }

Camera home_camera(const SceneView& view, int width, int height) {
  Camera camera = frontal_camera(view.center(), kMarginAroundOrgans * view.radius(), width, height);
  const auto& wanted = view.scene().camera;
  if (wanted.target) camera.target = *wanted.target;
  if (wanted.position) {
    // What the scene's camera shows in a window of usual shape is seen in a narrower one, too.
    const double further = std::max(1.0, kUsualShape * camera.height / camera.width);
    camera.position = camera.target + further * (*wanted.position - camera.target);
  }
  return camera;
}

void Interaction::key(const std::string& name, Requests& requests, const SceneView& view) {
  if (is_modifier(name)) return;
  notice_.clear();
  if (session_key(name, requests) || view_key(name, view)) return;
  if (name == "g") {
    if (hands_off.empty()) give_back(view);
    if (!hands_off.empty()) notice_ = hands_off;
  } else if (name == "s") {
    requests.screenshot = true;
  } else if (name == "q" || name == "Escape") {
    requests.close = requests.end_run = true;
  } else {
    notice_ = "Key '" + name + "' does nothing here; h lists those that do.";
  }
}

/// Keys that conduct the session.
bool Interaction::session_key(const std::string& name, Requests& requests) {
  const bool known = name == "space" || name == "n" || name == "m" || name == "r" || name == "v";
  if (!known) return false;
  if (!hands_off.empty()) {
    notice_ = hands_off;
    return true;
  }
  if (name == "space") requests.pause_or_resume = true;
  if (name == "n") requests.step = true;
  if (name == "m") requests.slow_motion = true;
  if (name == "v") requests.record = true;
  if (name == "r") {  // all is as at the start, probes with their scripts, too
    let_go();
    taken_.clear();
    requests.reset = true;
  }
  return true;
}

/// Keys that concern the picture alone.
bool Interaction::view_key(const std::string& name, const SceneView& view) {
  if (name == "h") {
    options.help = !options.help;
  } else if (name == "c") {
    options.coloring =
        options.coloring == Coloring::kStrain ? Coloring::kDisplacement : Coloring::kStrain;
  } else if (name == "1" || name == "2" || name == "3") {
    toggle_springs(static_cast<std::size_t>(name[0] - '1'), view);
  } else if (name == "t") {
    toggle_tetrahedra(view);
  } else if (name == "w") {
    options.wireframe = !options.wireframe;
  } else if (name == "x") {
    options.cut = options.cut ? std::nullopt : std::optional(0.0);
  } else if (name == "comma" || name == "period") {
    move_cut(name == "comma" ? -kCutStep : kCutStep);
  } else if (name == "Home" || name == "0") {
    go_home(view);
  } else {
    return false;
  }
  return true;
}

void Interaction::toggle_springs(std::size_t family, const SceneView& view) {
  const bool any = std::ranges::any_of(view.organs(), [&](const OrganView& organ) {
    return !organ.springs[family].empty() && !organ.solid;
  });
  if (any) options.springs[family] = !options.springs[family];
  if (!any) notice_ = std::string("No organ here has ") + kFamilies[family] + " springs.";
}

void Interaction::toggle_tetrahedra(const SceneView& view) {
  if (has_solid(view)) options.tetrahedra = !options.tetrahedra;
  if (!has_solid(view)) notice_ = "No organ here is made of tetrahedra: 1 2 3 show its springs.";
}

void Interaction::move_cut(double by) {
  if (!options.cut) notice_ = "There is no plane to move: x cuts.";
  if (options.cut) options.cut = std::clamp(*options.cut + by, -1.0, 1.0);
}

void Interaction::go_home(const SceneView& view) {
  camera = home_camera(view, camera.width, camera.height);
}

}  // namespace palpate::visualizer
