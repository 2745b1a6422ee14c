// The scene: these structs are the schema. Each field's name carries its unit where it crosses
// the border (the YAML key is the field's name with the unit suffix given in its comment).
// Ranges are those the reader enforces (points: within ±100 m; schema.h has them in code);
// defaults are physical and printed by `palpate check`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "modules/core/types.h"
#include "modules/scene/mesh.h"
#include "modules/scene/probe_shape.h"

namespace palpate::scene {

struct Tissue {
  double youngs_modulus = 10e3;  ///< `youngs_modulus_pa` [100 … 1e7]
  double wall_thickness = 3e-3;  ///< `wall_thickness_m` [1e-4 … 0.05]
  double density = 1058;         ///< `density_kg_per_m3`, of the filled organ [100 … 5000]
  double damping_ratio = 0.1;    ///< `damping_ratio`, of each spring, of critical [0 … 2]
  double drag = 2;               ///< `drag_per_s`: velocity decay by the surroundings [0 … 100]
};

/// The spring families that have no continuum meaning of their own; 0 leaves a family out.
/// Defaults: a hollow, filled organ (docs/calibration.md); a solid one wants inner_ratio 10 and a
/// wall of 0.16 of its radius.
struct Springs {
  double bending_ratio = 0.1;  ///< `bending_ratio`: stiffness over a structural spring's [0 … 10]
  double inner_ratio = 0.05;   ///< `inner_ratio`: stiffness per area over E t / R² [0 … 100]
  std::size_t virtual_nodes = 6;  ///< `virtual_nodes` on the dominant axis [0 … 64]; 0 = no inner

  bool operator==(const Springs&) const = default;
};

/// Nodes whose rest position lies inside do not move.
struct SphereRegion {
  Vec3 center = Vec3::Zero();  ///< `center_m`, in W
  double radius = 0.01;        ///< `radius_m` [1e-4 … 10]
};
struct BoxRegion {
  Vec3 min = Vec3::Zero(), max = Vec3::Zero();  ///< `min_m`, `max_m`, in W; min < max
};
using Region = std::variant<SphereRegion, BoxRegion>;  ///< keys `sphere`, `box`

/// Where a solid's tetrahedra are smaller than elsewhere.
struct Refinement {
  std::vector<Region> near;  ///< `near`; none: nowhere
  /// `edge_m`, longest edge there [1e-4 … 1]; none: kRegionEdge in regions, under a probe what its
  /// radius and needs.force_error want
  std::optional<double> edge_length;
  /// `growth`: longer by this per metre of distance [0.05 … 100]; none: kGrowth, of quadratic
  /// tetrahedra that follow kQuadraticGrowth
  std::optional<double> growth = {};
  bool follow = false;  ///< `follow`: where probes touch, as they go
  /// `nodes` of an organ that follows, at most [100 … 50000]; none: kNodes, kQuadraticNodes
  std::optional<std::size_t> nodes = {};

  static constexpr double kRegionEdge = 4e-3, kGrowth = 0.5, kQuadraticGrowth = 1;
  static constexpr std::size_t kNodes = 2500, kQuadraticNodes = 5000;
  bool any() const { return follow || !near.empty(); }
};

/// Parameters that models of solids need beside the tissue.
struct Solid {
  double poisson_ratio = 0.499;  ///< `poisson_ratio` [0 … 0.5]
  double element_size = 0;       ///< `element_size_m`, edges inside; 0 = mean edge of the surface
  std::size_t modes = 40;        ///< `modes` of model modal, beside rigid motion [1 … 400]
  Refinement refine;             ///< `refine`
};

enum class Integrator { kAutomatic, kSymplecticEuler, kBackwardEuler };

/// The volume V* asked for, over the rest volume: a curve (1 without points) plus breathing.
struct Filling {
  struct Point {
    double time = 0;   ///< `at_s`, simulated [0 … 1e6]; rising
    double ratio = 1;  ///< `volume_ratio` [0.2 … 5]
  };
  std::vector<Point> points;       ///< `points`, minimum-jerk between them, held outside
  double breathing_amplitude = 0;  ///< `breathing_amplitude`: added a sin 2π f t [0 … 0.5]
  double breathing_rate = 0.3;     ///< `breathing_hz`, f [0.01 … 5]
  double max_rate = 0.5;           ///< `max_rate_per_s`: |dV*/dt| / V₀ at most [0.001 … 10]
};

struct Organ {
  std::string name;  ///< unique
  Mesh mesh;
  Pose pose;  ///< `position_m`, `rotation_xyzw`; applied to the mesh
  Tissue tissue;
  Springs springs;
  Solid solid;
  std::string model = "implicit_volume";  ///< `model`, a word of models.h
  std::size_t volume_corrections = 0;     ///< `volume_corrections`, Newton [0 … 5]
  std::size_t iterations = 0;             ///< `iterations` [0 … 1000]; 0: the model's own
  Integrator integrator = Integrator::kAutomatic;  ///< `integrator`
  Filling filling;                                 ///< `filling`
  std::vector<Region> fixed;                       ///< `fixed`
  std::size_t process = 1;  ///< `process` of deformation that owns it [1 … 16]
};

/// A recorded pose over time: a table, or a topic of a ROS bag (modules/trajectories).
struct TrajectoryDevice {
  enum class TimeUnit { kSeconds, kMilliseconds, kMicroseconds, kNanoseconds };
  enum class QuaternionOrder { kXyzw, kWxyz };

  std::filesystem::path file = {};  ///< `file`
  std::vector<std::string> columns =
      {};  ///< `columns`: names or numbers from 1; empty: by the header
  TimeUnit time_unit = TimeUnit::kSeconds;              ///< `time_unit`, of a table
  std::string length_unit = "m";                        ///< `length_unit`
  QuaternionOrder quaternion = QuaternionOrder::kXyzw;  ///< `quaternion`, of a table's columns
  std::optional<std::string> topic = {};  ///< `topic` of a bag; none: its only one with poses
  Pose offset = {};   ///< `position_m`, `rotation_xyzw`: X_WR of the recording's frame R
  bool loop = false;  ///< `loop`: start again at the end, else hold the last pose
};
/// Minimum-jerk moves between points.
struct ScriptedDevice {
  struct Move {
    std::optional<Vec3> to;  ///< `to_m`; absent for a wait
    double duration = 1;     ///< `duration_s` [1e-3 … 3600] (`wait_s` for a wait)
  };
  Vec3 start = Vec3::Zero();         ///< `start_m`
  Quat rotation = Quat::Identity();  ///< `rotation_xyzw`
  std::vector<Move> moves;           ///< `moves`; ends holding the last point
};
/// The driver of a real device writes its pose on topic probe_input.
struct TopicDevice {
  Vec3 start = Vec3::Zero();         ///< `start_m`: pose until the first sample
  Quat rotation = Quat::Identity();  ///< `rotation_xyzw`
};
/// The mouse in the visualizer's window, which writes on topic probe_input, too; followed smoothly.
struct MouseDevice {
  Vec3 start = Vec3::Zero();         ///< `start_m`: pose until the first sample
  Quat rotation = Quat::Identity();  ///< `rotation_xyzw`
};
/// A haptic device with the hand that holds it, by numbers (haptics/devices/emulated_device.h).
struct EmulatedDevice {
  enum class Kind { kTouch, kOmega };
  struct Hand {
    double mass = 0;                          ///< `mass_kg`, moved along [0 … 5]
    double damping = 0;                       ///< `damping_n_s_per_m`, to its target [0 … 100]
    double stiffness = 0;                     ///< `stiffness_n_per_m`, to its target [0 … 5000]
    Vec3 push = Vec3::Zero();                 ///< `push_n`, constant, in W [-100 … 100]
    std::vector<ScriptedDevice::Move> moves;  ///< `moves` of its target, which begins at the start
  };
  Kind kind = Kind::kTouch;            ///< `kind`: which sizes those below have that are absent
  Vec3 start = Vec3::Zero();           ///< `start_m`
  Quat rotation = Quat::Identity();    ///< `rotation_xyzw`, kept
  std::optional<Vec3> axis;            ///< `axis`: of W, moves along it only; absent: free
  std::optional<double> mass;          ///< `mass_kg` [0.01 … 10]
  std::optional<double> damping;       ///< `damping_n_s_per_m` [0 … 100]
  std::optional<double> max_force;     ///< `max_force_n`, of its motors [0.1 … 100]
  std::optional<double> encoder_step;  ///< `encoder_step_m` [0 … 0.01]; 0: exact
  double rate = 1000;                  ///< `rate_hz` of its own loop [100 … 10000]
  double transport_delay = 0;          ///< `transport_delay_s`, each way [0 … 0.1]
  Hand hand;
};
using Device =
    std::variant<TrajectoryDevice, ScriptedDevice, TopicDevice, MouseDevice, EmulatedDevice>;
///< keys `trajectory`, `scripted`, `topic`, `mouse`, `emulated`

struct Probe {
  std::string name;  ///< unique
  ProbeShape shape;
  double friction = 0.1;  ///< `friction`, Coulomb coefficient [0 … 2]
  Device device;
};

/// What organs touch beside probes (docs/decisions/0012-organ-contact.md).
struct OrganContacts {
  bool organs = false;    ///< `organs`: each with each other
  bool self = false;      ///< `self`: each with itself
  double friction = 0.1;  ///< `friction`, Coulomb coefficient [0 … 2]

  bool any() const { return organs || self; }
};

struct Haptics {
  double max_force = 3.3;       ///< `max_force_n` [0.1 … 100]
  double max_force_rate = 200;  ///< `max_force_rate_n_per_s` [1 … 1e5]
  double device_damping = 0.2;  ///< `device_damping_n_s_per_m`, b of the device [0 … 50]
  double stale_after = 0.05;    ///< `stale_after_s`: older contact models fade [0.005 … 1]
  double fade_time = 0.05;      ///< `fade_time_s`: from full force to zero [0.005 … 1]
};

/// Cycles per second of each process.
struct Rates {
  double haptics = 1000;     ///< `haptics_hz` [500 … 4000]
  double collision = 250;    ///< `collision_hz` [10 … 2000]
  double deformation = 250;  ///< `deformation_hz` [10 … 2000]
  double visualizer = 30;    ///< `visualizer_hz` [1 … 120]
};

/// Needs of a scene: `palpate plan` looks for the cheapest model, mesh and step that meet them.
struct Needs {
  enum class Contents { kFluid, kSolid };
  /// `contents`: what the organ is, whatever models it: a wall filled with fluid, or one solid.
  Contents contents = Contents::kFluid;
  std::optional<double> force_error;    ///< `force_error`, RMS over the probes' RMS [1e-3 … 10]
  std::optional<double> surface_error;  ///< `surface_error_m`, RMS of the surface [1e-6 … 1]
  std::optional<double> volume_error;   ///< `volume_error`, largest |V − V*|/V* [1e-12 … 1]
  double step_rate = 100;               ///< `step_hz`: contact models per second [10 … 2000]
  double haptics_rate = 1000;           ///< `haptics_hz` [500 … 4000]
  std::size_t cores = 2;                ///< `cores` to run on [1 … 64]
};

struct Camera {
  std::optional<Vec3> position, target;  ///< `position_m`, `target_m`; default: all in view
};

struct Scene {
  std::filesystem::path file;  ///< where it was read from
  std::string name;            ///< default: file name without extension
  std::vector<Organ> organs;   ///< `organs`, at least one
  std::vector<Probe> probes;   ///< `probes`, at least one
  OrganContacts contacts;
  Vec3 gravity = Vec3::Zero();  ///< `gravity_m_per_s2`; the rest shape is free of it
  double duration = 0;          ///< `duration_s`: 0 = until stopped [0 … 1e6]
  Rates rates;
  std::size_t deformation_threads = 1;  ///< `deformation_threads` [1 … 16]
  Haptics haptics;
  Needs needs;
  Camera camera;
};

}  // namespace palpate::scene
