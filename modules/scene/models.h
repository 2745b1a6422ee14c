// The deformation models a scene can name, one row each: what the format must know of them. How
// they move is deformation's (deformation/models.h). Charts and tables list them in this order,
// plain springs first, the most accurate last; nothing else depends on it.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace palpate::scene {

struct Organ;
struct Scene;

/// What joins an organ's nodes.
enum class MeshKind { kSurfaceSprings, kLinearTetrahedra, kQuadraticTetrahedra };

struct ModelFormat {
  const char* word = "";     ///< value of the key `model`
  const char* meaning = "";  ///< law and method, for tables
  MeshKind mesh = MeshKind::kSurfaceSprings;
  bool has_integrator = false;  ///< reads `integrator`: has no steps of its own
  /// Goes with `contacts`: springs that symplectic Euler can step.
  bool takes_organ_contacts = false;
  bool has_volume_corrections = false;  ///< reads `volume_corrections`
  std::size_t iterations = 0;           ///< of `iterations` the model's own; 0: it has no such key
  const char* iterates = "";            ///< what those are
  bool has_modes = false;               ///< reads `solid.modes`
  /// Goes with `solid.refine.follow`: a step needs no more of the last than positions, velocities.
  bool may_change_mesh = false;
  double largest_poisson_ratio = 0.5;  ///< of `solid.poisson_ratio`, of a model of solids

  bool is_solid() const { return mesh != MeshKind::kSurfaceSprings; }
  bool is_quadratic() const { return mesh == MeshKind::kQuadraticTetrahedra; }
  /// Becomes too stiff as Poisson's ratio goes to ½, where it has to stay below it, too.
  bool locks() const { return is_solid() && largest_poisson_ratio < 0.5; }
};

std::span<const ModelFormat> model_formats();

/// The row of a word. Readers refuse other words, so that one is a broken promise.
const ModelFormat& format_of(std::string_view model);

inline bool is_solid(std::string_view model) { return format_of(model).is_solid(); }
inline bool is_quadratic(std::string_view model) { return format_of(model).is_quadratic(); }

/// All words, "a, b, c".
std::string model_words();

/// A key of an organ that does not go with its model.
struct Misfit {
  std::string key = {};  ///< "springs", "solid.modes"; empty: all is well
  std::string why = {};

  bool none() const { return key.empty(); }
};

/// What the organ asks of its model that this cannot do.
Misfit impossible_for_model(const Organ& organ);

/// Which of the organ's keys its model ignores though they have other values than their defaults.
Misfit ignored_by_model(const Organ& organ);

/// Either of these.
inline Misfit misfit_of_model(const Organ& organ) {
  const Misfit impossible = impossible_for_model(organ);
  return impossible.none() ? ignored_by_model(organ) : impossible;
}

/// What the scene's `contacts` ask of an organ whose steps do not take them.
Misfit misfit_of_contacts(const Scene& scene);

/// Gives keys that the organ's model ignores their defaults.
void drop_ignored_keys(Organ& organ);

}  // namespace palpate::scene
