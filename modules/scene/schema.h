// The schema of a scene, written once: every key with its unit, range and meaning.
//
// describe(visitor, object) names each key of an object together with the field that holds it.
// Visitors walk it: ObjectReader (YAML → Scene), YamlWriter (Scene → YAML), SchemaTable (the table
// in docs/scene.md) and KeyList (which keys an object may have). A visitor offers
//   field(key, field, about)       a value, an object, a list of objects, or one of some Words
//   option<T>(key, variant, about) one alternative of a variant; exactly one key is given
//   require(holds, rule)           a rule across fields of the object
//   unique_names(key, list)        the rule that no two entries of a list share a name
// What is told of a key is in about.h; the keys of devices are in device_schema.h.
#pragma once

#include <algorithm>
#include <array>
#include <string>

#include "modules/core/organ_limits.h"
#include "modules/scene/about.h"
#include "modules/scene/device_schema.h"
#include "modules/scene/models.h"
#include "modules/scene/processes.h"
#include "modules/scene/scene.h"

namespace palpate::scene {

/// Version of the file format, the value of the first key.
inline constexpr std::size_t kSceneFormat = 1;
inline constexpr const char* kFormatKey = "palpate_scene";

template <>
struct Words<Integrator> {
  static constexpr std::array texts{"automatic", "symplectic_euler", "backward_euler"};
};
template <>
struct Words<Needs::Contents> {
  static constexpr std::array texts{"fluid", "solid"};
};

template <class V>
void describe(V& v, Mesh& mesh) {
  v.field("file", mesh.file,
          plain("surface mesh, or tetrahedra (.msh, .vtk), relative to the scene file").needed());
  About unit = plain("unit of the mesh file's numbers: m, dm, cm, mm, um or in");
  unit.is_length_unit = true;
  v.field("unit", mesh.unit, unit);
  v.field("nodes", mesh.nodes,
          ranged("", 0, double(kMaxNodes), "resample to this many nodes; 0 = as the file is"));
  constexpr std::size_t kLeastNodes = 4;  // of a tetrahedron
  v.fits("nodes is 0, or 4 at least",
         mesh.nodes == 0 || mesh.nodes >= kLeastNodes
             ? Misfit{}
             : Misfit{"nodes", "must be 0, or 4 at least: no closed surface has fewer"});
}

template <class V>
void describe(V& v, Tissue& tissue) {
  v.field("youngs_modulus_pa", tissue.youngs_modulus,
          ranged("Pa", 100, 1e7, "stiffness of the wall"));
  v.field("wall_thickness_m", tissue.wall_thickness, ranged("m", 1e-4, 0.05, "of the wall"));
  v.field("density_kg_per_m3", tissue.density,
          ranged("kg/m³", 100, 5000, "of the filled organ: mass over enclosed volume"));
  v.field("damping_ratio", tissue.damping_ratio,
          ranged("", 0, 2, "of each spring, over critical damping"));
  v.field("drag_per_s", tissue.drag,
          ranged("1/s", 0, 100, "velocity decay by the organ's surroundings"));
}

template <class V>
void describe(V& v, Springs& springs) {
  v.field("bending_ratio", springs.bending_ratio,
          ranged("", 0, 10, "stiffness of bending springs over structural ones; 0 = none"));
  v.field("inner_ratio", springs.inner_ratio,
          ranged("", 0, 100, "stiffness per area of inner springs over E t / R²; 0 = none"));
  v.field("virtual_nodes", springs.virtual_nodes,
          ranged("", 0, 64, "nodes on the dominant axis that the inner springs hang on"));
  v.require(springs.virtual_nodes > 0 || springs.inner_ratio == 0,
            "inner_ratio must be 0 where virtual_nodes is 0 (inner springs hang on virtual nodes)");
}

template <class V>
void describe(V& v, Refinement& refine) {
  v.field("near", refine.near, plain("regions of W that are touched; none = nowhere"));
  v.field("follow", refine.follow, plain("smaller tetrahedra under the probes, wherever they go"));
  v.field("edge_m", refine.edge_length,
          ranged("m", 1e-4, 1, "longest edge there; half a probe's radius is a start")
              .otherwise("0.004 in regions; under a probe by its radius and needs.force_error"));
  v.field("growth", refine.growth,
          ranged("", 0.05, 100, "how much longer edges may be per metre of distance")
              .otherwise("0.5; quadratic tetrahedra that follow 1"));
  v.field("nodes", refine.nodes,
          ranged("", 100, 50000, "most of an organ that follows; edges are longer where needed")
              .otherwise("2500; of quadratic tetrahedra 5000"));
}

template <class V>
void describe(V& v, Solid& solid) {
  v.field("poisson_ratio", solid.poisson_ratio, ranged("", 0, 0.5, "of the tissue"));
  v.field("element_size_m", solid.element_size,
          ranged("m", 0, 1, "wanted edges inside; 0 = as long as the surface's"));
  v.field("modes", solid.modes, ranged("", 1, 400, "vibrations of model modal, lowest first"));
  v.field("refine", solid.refine, plain("smaller tetrahedra where it will be touched"));
}

template <class V>
void describe(V& v, SphereRegion& sphere) {
  v.field("center_m", sphere.center, point("centre").needed());
  v.field("radius_m", sphere.radius, ranged("m", 1e-4, 10, "radius"));
}

template <class V>
void describe(V& v, BoxRegion& box) {
  v.field("min_m", box.min, point("lowest corner").needed());
  v.field("max_m", box.max, point("highest corner").needed());
  v.require((box.min.array() < box.max.array()).all(),
            "min_m must be below max_m in each of x, y, z");
}

template <class V>
void describe(V& v, Region& region) {
  v.template option<SphereRegion>("sphere", region, plain("a ball"));
  v.template option<BoxRegion>("box", region, plain("a box along the axes of W"));
}

template <class V>
void describe(V& v, Filling::Point& point) {
  v.field("at_s", point.time, ranged("s", 0, 1e6, "simulated time").needed());
  v.field("volume_ratio", point.ratio, ranged("", 0.2, 5, "volume over rest volume").needed());
}

template <class V>
void describe(V& v, Filling& filling) {
  v.field("points", filling.points,
          plain("smooth between them, held before the first and after the last"));
  v.field("breathing_amplitude", filling.breathing_amplitude,
          ranged("", 0, 0.5, "a in a sin(2π f t), added to the volume ratio"));
  v.field("breathing_hz", filling.breathing_rate, ranged("Hz", 0.01, 5, "f"));
  v.field("max_rate_per_s", filling.max_rate,
          ranged("1/s", 1e-3, 10, "fastest change of the volume ratio, whatever is asked"));
  v.require(std::adjacent_find(filling.points.begin(), filling.points.end(),
                               [](const auto& a, const auto& b) { return b.time <= a.time; }) ==
                filling.points.end(),
            "at_s must rise from point to point");
}

template <class V>
void describe(V& v, Organ& organ) {
  v.field("name", organ.name, plain("unique among organs").otherwise("`organ_` and its index"));
  v.field("mesh", organ.mesh, plain("closed surface").needed());
  describe_pose(v, organ.pose, "where the mesh's origin is in W", "unit quaternion, of the mesh");
  v.field("tissue", organ.tissue, plain("what it is made of"));
  v.field("springs", organ.springs, plain("spring families without a continuum meaning"));
  v.field("solid", organ.solid, plain("what models filled with tetrahedra need beside"));
  About model = plain("how its contents are modelled; see the table of models");
  model.is_model = true;
  v.field("model", organ.model, model);
  v.field("volume_corrections", organ.volume_corrections,
          ranged("", 0, 5, "Newton corrections of the volume in each step, of implicit_volume"));
  v.field("iterations", organ.iterations,
          ranged("", 0, 1000, "per step; 0 = the model's own, see the table of models"));
  v.field("integrator", organ.integrator,
          plain("of implicit_volume and mass_spring; automatic = what costs less here"));
  v.field("filling", organ.filling, plain("the volume asked for, over the rest volume"));
  v.field("fixed", organ.fixed,
          plain("regions of W whose nodes do not move; a probe feels a block of tissue there"));
  v.field("process", organ.process,
          ranged("", 1, kMaxProcesses, "deformation process that simulates it, counted from 1"));
  v.fits("a key that the model does not read must be left out, see the table of models",
         misfit_of_model(organ));
}

template <class V>
void describe(V& v, SphereShape& sphere) {
  v.field("radius_m", sphere.radius, ranged("m", 1e-4, 0.5, "radius"));
}

template <class V>
void describe(V& v, CapsuleShape& capsule) {
  v.field("radius_m", capsule.radius, ranged("m", 1e-4, 0.5, "radius"));
  v.field("length_m", capsule.length,
          ranged("m", 1e-4, 2, "between the centres of its ends, along the probe's z"));
}

template <class V>
void describe(V& v, BoxShape& box) {
  v.field("size_m", box.size, ranged("m", 1e-4, 2, "full extents about the probe's origin"));
}

template <class V>
void describe(V& v, ConeShape& cone) {
  v.field("radius_m", cone.radius, ranged("m", 1e-4, 0.5, "of its base"));
  v.field("length_m", cone.length,
          ranged("m", 1e-4, 2, "from its point, the probe's origin, along the probe's z"));
}

template <class V>
void describe(V& v, GrasperShape& jaws) {
  v.field("length_m", jaws.length, ranged("m", 1e-4, 2, "of a jaw"));
  v.field("width_m", jaws.width, ranged("m", 1e-4, 2, "along the probe's x"));
  v.field("thickness_m", jaws.thickness, ranged("m", 1e-4, 0.5, "of a jaw"));
  v.field("opening_rad", jaws.opening, ranged("rad", 0.02, 1.5, "between the jaws' inner faces"));
}

template <class V>
void describe(V&, PlaneShape&) {}

template <class V>
void describe(V& v, MeshShape& shape) {
  describe(v, shape.mesh);
}

template <class V>
void describe(V& v, ProbeShape& shape) {
  v.template option<SphereShape>("sphere", shape, plain("a ball about the probe's origin"));
  v.template option<CapsuleShape>("capsule", shape, plain("a rod with round ends"));
  v.template option<BoxShape>("box", shape, plain("a box"));
  v.template option<ConeShape>("cone", shape, plain("a point, as of a needle; 32 flats"));
  v.template option<GrasperShape>(
      "grasper", shape, plain("two jaws that stand open, their tips about the probe's origin"));
  v.template option<PlaneShape>("plane", shape, plain("solid where the probe's z ≤ 0; write {}"));
  v.template option<MeshShape>("mesh", shape, plain("any closed surface, in the probe's frame"));
}

template <class V>
void describe(V& v, Probe& probe) {
  v.field("name", probe.name, plain("unique among probes").otherwise("`probe_` and its index"));
  v.field("shape", probe.shape, plain("what touches").needed());
  v.field("friction", probe.friction, ranged("", 0, 2, "Coulomb coefficient"));
  v.field("device", probe.device, plain("where its pose comes from").needed());
}

template <class V>
void describe(V& v, OrganContacts& contacts) {
  v.field("organs", contacts.organs, plain("organs touch each other"));
  v.field("self", contacts.self, plain("an organ touches itself"));
  v.field("friction", contacts.friction,
          ranged("", 0, 2, "Coulomb coefficient of tissue on tissue"));
}

template <class V>
void describe(V& v, Rates& rates) {
  v.field("haptics_hz", rates.haptics, ranged("Hz", 500, 4000, "haptic ticks"));
  v.field("collision_hz", rates.collision, ranged("Hz", 10, 2000, "contact searches"));
  v.field("deformation_hz", rates.deformation,
          ranged("Hz", 10, 2000, "updates of node positions and contact models"));
  v.field("visualizer_hz", rates.visualizer, ranged("Hz", 1, 120, "pictures"));
}

template <class V>
void describe(V& v, Haptics& haptics) {
  v.field("max_force_n", haptics.max_force, ranged("N", 0.1, 100, "largest force commanded"));
  v.field("max_force_rate_n_per_s", haptics.max_force_rate,
          ranged("N/s", 1, 1e5, "fastest change of the force"));
  v.field("device_damping_n_s_per_m", haptics.device_damping,
          ranged("N·s/m", 0, 50, "physical damping of the device"));
  v.field("stale_after_s", haptics.stale_after,
          ranged("s", 0.005, 1,
                 "a contact model older than this fades; from 0.05 s up, probes and contacts "
                 "older than it give no force; tissue is held off a round probe without contacts"));
  v.field("fade_time_s", haptics.fade_time, ranged("s", 0.005, 1, "from full force to none"));
}

template <class V>
void describe(V& v, Needs& needs) {
  v.field("contents", needs.contents,
          plain("what the organ is: a wall filled with fluid, or one solid"));
  v.field("force_error", needs.force_error,
          ranged("", 1e-3, 10,
                 "of a probe's force where it is worst, of the force there; without truths RMS "
                 "over its RMS")
              .otherwise("any"));
  v.field("surface_error_m", needs.surface_error,
          ranged("m", 1e-6, 1, "of the surface's positions, RMS").otherwise("any"));
  v.field("volume_error", needs.volume_error,
          ranged("", 1e-12, 1, "largest difference from the volume asked for, over it")
              .otherwise("any"));
  v.field("step_hz", needs.step_rate, ranged("Hz", 10, 2000, "least rate of deformation"));
  v.field("haptics_hz", needs.haptics_rate, ranged("Hz", 500, 4000, "least rate of haptic ticks"));
  v.field("cores", needs.cores, ranged("", 1, 64, "of the machine, for all processes"));
}

template <class V>
void describe(V& v, Camera& camera) {
  v.field("position_m", camera.position, point("where it stands").otherwise("all in view"));
  v.field("target_m", camera.target, point("what it looks at").otherwise("all in view"));
  v.require(!camera.position || !camera.target || *camera.position != *camera.target,
            "position_m and target_m must differ");
}

/// Gives entries of a list that have no name one of their index.
template <class T>
void name_by_index(const char* prefix, std::vector<T>& list) {
  for (std::size_t i = 0; i < list.size(); ++i) {
    if (list[i].name.empty()) list[i].name = prefix + std::to_string(i);
  }
}

template <class V>
void describe(V& v, Scene& scene) {
  std::size_t format = kSceneFormat;
  v.field(kFormatKey, format,
          ranged("", kSceneFormat, kSceneFormat, "version of this format; the first key").needed());
  v.field("name", scene.name,
          plain("of the scene").otherwise("the scene file's name without extension"));
  v.field("organs", scene.organs, plain("soft bodies").needed());
  name_by_index("organ_", scene.organs);
  v.unique_names("organs", scene.organs);
  v.field("probes", scene.probes, plain("instruments").needed());
  name_by_index("probe_", scene.probes);
  v.unique_names("probes", scene.probes);
  v.field("contacts", scene.contacts, plain("what organs touch beside probes"));
  v.fits("contacts need models of springs, stepped by symplectic_euler", misfit_of_contacts(scene));
  v.fits("the organs' processes are 1, 2, … without a gap; organs that touch each other share one",
         misfit_of_processes(scene));
  v.field("gravity_m_per_s2", scene.gravity,
          ranged("m/s²", -100, 100, "acceleration; the rest shape is free of it"));
  v.field("duration_s", scene.duration, ranged("s", 0, 1e6, "of a run; 0 = until stopped"));
  v.field("rates", scene.rates, plain("cycles per second of each process"));
  v.field("deformation_threads", scene.deformation_threads,
          ranged("", 1, 16, "cores of deformation; more than one only helps large meshes"));
  v.field("haptics", scene.haptics, plain("limits of the force given to the hand"));
  v.field("needs", scene.needs, plain("what `palpate plan` shall find a model for"));
  v.field("camera", scene.camera, plain("of the visualizer"));
}

}  // namespace palpate::scene
