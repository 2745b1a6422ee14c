#include "modules/scene/models.h"

#include <algorithm>
#include <array>

#include "modules/core/error.h"
#include "modules/scene/scene.h"

namespace palpate::scene {
namespace {

constexpr auto kLinear = MeshKind::kLinearTetrahedra, kQuadratic = MeshKind::kQuadraticTetrahedra;
/// Without a pressure of its own an element answers a change of volume with E/(3(1−2ν)).
constexpr double kBelowIncompressible = 0.4999;
constexpr const char* kPasses = "passes over the constraints";
constexpr const char* kGradients = "conjugate gradients at most";

constexpr std::array<ModelFormat, 17> kFormats{{
    {.word = "mass_spring",
     .meaning = "springs alone",
     .has_integrator = true,
     .takes_organ_contacts = true},
    {.word = "implicit_volume",
     .meaning = "springs and one implicit volume constraint",
     .has_integrator = true,
     .takes_organ_contacts = true,
     .has_volume_corrections = true},
    {.word = "penalty",
     .meaning = "pressure proportional to the volume lost",
     .takes_organ_contacts = true},
    {.word = "baumgarte",
     .meaning = "volume constraint on accelerations, stabilised",
     .takes_organ_contacts = true},
    {.word = "promayon",
     .meaning = "projection along the volume's gradient after the step",
     .takes_organ_contacts = true},
    {.word = "post_stabilisation",
     .meaning = "volume constraint on velocities, positions projected afterwards",
     .takes_organ_contacts = true},
    {.word = "bourguignon_cani",
     .meaning = "springs to the barycentre",
     .takes_organ_contacts = true},
    {.word = "zordan",
     .meaning = "pressures of pyramids over the triangles",
     .takes_organ_contacts = true},
    {.word = "element_volume",
     .meaning = "one volume constraint per pyramid",
     .takes_organ_contacts = true},
    {.word = "chainmail", .meaning = "3D ChainMail: links with bounds, no forces"},
    {.word = "xpbd_springs",
     .meaning = "springs and volume by extended position-based dynamics",
     .iterations = 1,
     .iterates = kPasses},
    {.word = "xpbd_tetrahedra",
     .meaning = "neo-Hookean tetrahedra by extended position-based dynamics",
     .mesh = kLinear,
     .iterations = 1,
     .iterates = kPasses,
     .largest_poisson_ratio = kBelowIncompressible},
    {.word = "corotational",
     .meaning = "corotational linear tetrahedra, implicit",
     .mesh = kLinear,
     .iterations = 80,
     .iterates = kGradients,
     .may_change_mesh = true,
     .largest_poisson_ratio = kBelowIncompressible},
    {.word = "nodal_pressure",
     .meaning = "neo-Hookean linear tetrahedra with averaged nodal pressures, implicit",
     .mesh = kLinear,
     .iterations = 25,
     .iterates = kGradients,
     .may_change_mesh = true},
    {.word = "quadratic_pressure",
     .meaning = "neo-Hookean quadratic tetrahedra with a pressure each, implicit",
     .mesh = kQuadratic,
     .iterations = 36,
     .iterates = kGradients,
     .may_change_mesh = true},
    {.word = "modal",
     .meaning = "lowest eigenmodes of quadratic_elements",
     .mesh = kQuadratic,
     .has_modes = true},
    {.word = "quadratic_elements",
     .meaning = "neo-Hookean Taylor–Hood tetrahedra, implicit, solved to the end",
     .mesh = kQuadratic},
}};

bool has_filling(const Organ& organ) {
  return !organ.filling.points.empty() || organ.filling.breathing_amplitude != 0;
}

/// A key some models ignore.
struct OptionalKey {
  const char* key;
  bool (*is_read)(const ModelFormat&);
  bool (*is_default)(const Organ&);
  void (*reset)(Organ&);
};

const Organ kDefaults;
bool of_solids(const ModelFormat& format) { return format.is_solid(); }
bool of_surfaces(const ModelFormat& format) { return !format.is_solid(); }

const std::array kOptionalKeys{
    OptionalKey{"iterations", [](const ModelFormat& f) { return f.iterations > 0; },
                [](const Organ& o) { return o.iterations == kDefaults.iterations; },
                [](Organ& o) { o.iterations = kDefaults.iterations; }},
    OptionalKey{"integrator", [](const ModelFormat& f) { return f.has_integrator; },
                [](const Organ& o) { return o.integrator == kDefaults.integrator; },
                [](Organ& o) { o.integrator = kDefaults.integrator; }},
    OptionalKey{"volume_corrections", [](const ModelFormat& f) { return f.has_volume_corrections; },
                [](const Organ& o) { return o.volume_corrections == kDefaults.volume_corrections; },
                [](Organ& o) { o.volume_corrections = kDefaults.volume_corrections; }},
    OptionalKey{
        "tissue.wall_thickness_m", of_surfaces,
        [](const Organ& o) { return o.tissue.wall_thickness == kDefaults.tissue.wall_thickness; },
        [](Organ& o) { o.tissue.wall_thickness = kDefaults.tissue.wall_thickness; }},
    OptionalKey{
        "tissue.damping_ratio", [](const ModelFormat& f) { return of_surfaces(f) || f.has_modes; },
        [](const Organ& o) { return o.tissue.damping_ratio == kDefaults.tissue.damping_ratio; },
        [](Organ& o) { o.tissue.damping_ratio = kDefaults.tissue.damping_ratio; }},
    OptionalKey{"springs", of_surfaces,
                [](const Organ& o) { return o.springs == kDefaults.springs; },
                [](Organ& o) { o.springs = kDefaults.springs; }},
    OptionalKey{
        "solid.poisson_ratio", of_solids,
        [](const Organ& o) { return o.solid.poisson_ratio == kDefaults.solid.poisson_ratio; },
        [](Organ& o) { o.solid.poisson_ratio = kDefaults.solid.poisson_ratio; }},
    OptionalKey{"solid.element_size_m", of_solids,
                [](const Organ& o) { return o.solid.element_size == kDefaults.solid.element_size; },
                [](Organ& o) { o.solid.element_size = kDefaults.solid.element_size; }},
    OptionalKey{"solid.refine", of_solids, [](const Organ& o) { return !o.solid.refine.any(); },
                [](Organ& o) { o.solid.refine = kDefaults.solid.refine; }},
    OptionalKey{"solid.modes", [](const ModelFormat& f) { return f.has_modes; },
                [](const Organ& o) { return o.solid.modes == kDefaults.solid.modes; },
                [](Organ& o) { o.solid.modes = kDefaults.solid.modes; }}};

/// The words of the models for which something holds, "a, b, c".
template <class Holds>
std::string words_where(Holds holds) {
  std::string words;
  for (const ModelFormat& format : kFormats) {
    if (holds(format)) words.append(words.empty() ? "" : ", ").append(format.word);
  }
  return words;
}

}  // namespace

std::span<const ModelFormat> model_formats() { return kFormats; }

const ModelFormat& format_of(std::string_view model) {
  const auto found = std::ranges::find(kFormats, model, &ModelFormat::word);
  PALPATE_DEMAND(found != kFormats.end());
  return *found;
}

std::string model_words() {
  return words_where([](const ModelFormat&) { return true; });
}

Misfit impossible_for_model(const Organ& organ) {
  const ModelFormat& format = format_of(organ.model);
  if (!format.is_solid()) return {};
  if (has_filling(organ)) {
    return {"filling",
            "does not go with model " + organ.model + ", a solid; models of surfaces are filled"};
  }
  if (organ.solid.refine.follow && !format.may_change_mesh) {
    return {"solid.refine.follow",
            "does not go with model " + organ.model + "; tetrahedra change while they move with " +
                words_where([](const ModelFormat& f) { return f.may_change_mesh; })};
  }
  if (organ.solid.poisson_ratio <= format.largest_poisson_ratio) return {};
  return {"solid.poisson_ratio", "model " + organ.model + " needs at most 0.4999; up to 0.5 take " +
                                     words_where([](const ModelFormat& f) {
                                       return f.is_solid() && f.largest_poisson_ratio == 0.5;
                                     })};
}

Misfit ignored_by_model(const Organ& organ) {
  const ModelFormat& format = format_of(organ.model);
  for (const OptionalKey& key : kOptionalKeys) {
    if (key.is_read(format) || key.is_default(organ)) continue;
    return {key.key, "is not read by model " + organ.model +
                         "; leave it out, or take one of: " + words_where(key.is_read)};
  }
  return {};
}

Misfit misfit_of_contacts(const Scene& scene) {
  if (!scene.contacts.any()) return {};
  const std::string key = scene.contacts.organs ? "contacts.organs" : "contacts.self";
  for (const Organ& organ : scene.organs) {
    if (!format_of(organ.model).takes_organ_contacts) {
      return {key, "does not go with model " + organ.model + " of organ '" + organ.name +
                       "'; contacts of organs take " +
                       words_where([](const ModelFormat& f) { return f.takes_organ_contacts; })};
    }
    if (organ.integrator == Integrator::kBackwardEuler) {
      return {key, "does not go with integrator backward_euler of organ '" + organ.name +
                       "'; contacts of organs take symplectic_euler, which automatic then is"};
    }
  }
  return {};
}

void drop_ignored_keys(Organ& organ) {
  const ModelFormat& format = format_of(organ.model);
  for (const OptionalKey& key : kOptionalKeys) {
    if (!key.is_read(format)) key.reset(organ);
  }
}

}  // namespace palpate::scene
