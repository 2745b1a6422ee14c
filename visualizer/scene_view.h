// State the visualizer shows: the newest message of every topic, the histories of the plots, and
// what the picture derives from node positions. No DDS, no VTK; time is an argument.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "modules/messages/messages.h"
#include "modules/scene/scene.h"
#include "visualizer/history.h"
#include "visualizer/shape_measures.h"

namespace palpate::visualizer {

struct OrganView {
  using SpringEnds = std::array<std::uint32_t, 2>;

  std::string name;
  bool solid = false;  ///< made of tetrahedra, whose edges take the springs' place
  bool known = false;  ///< a surface has arrived
  SurfaceTopology surface;
  /// Told, but no positions have come that are of them: the picture stays until then.
  std::vector<SurfaceTopology> next;
  std::uint64_t shape_version = 0;      ///< counts accepted surfaces
  std::uint64_t positions_version = 0;  ///< counts accepted surfaces and node positions
  NodePositions newest;                 ///< positions of the surface's generation, else at rest
  std::int64_t received_ns = 0;         ///< when `newest` came, 0 = never

  std::array<std::vector<SpringEnds>, 3> springs;  ///< by SpringFamily
  std::vector<float> normals;                      ///< unit  (node_count × 3)
  std::vector<float> displacement;                 ///< of each node [m]
  std::vector<float> triangle_strain;              ///< principal, magnitude [1]
  std::vector<float> node_strain;                  ///< its mean at each node [1]

  History volume_error;  ///< (V − V*)/V*
  History pressure;      ///< [Pa]

  std::size_t node_count() const { return surface.rest_positions.size() / 3; }
  Vec3 node(std::uint32_t i) const;  ///< newest position in W [m]
};

struct ProbeView {
  scene::Probe description;
  bool seen = false;  ///< a pose has arrived
  Pose pose;
  Contacts contacts;
  bool has_force = false;
  HapticForce force;
  double force_error = 0;                      ///< see ContactModel; of several laws the largest
  std::uint32_t error_of_process = 1;          ///< whose law has it
  History force_magnitude;                     ///< [N]
  double greatest_force = 0, greatest_at = 0;  ///< of all that came [N], and when [s]
  double touched_for = 0;                      ///< simulated time with a force [s]
};

struct ModuleView {
  ModuleStatus status;
  std::int64_t received_ns = 0;
};

class SceneView {
 public:
  explicit SceneView(const scene::Scene& scene);

  // Newest message of each topic. False: it names an organ or probe that the scene does not have,
  // another generation than the surface known, or indices and sizes that do not fit; it is then
  // refused and changes nothing. now_ns: monotonic clock at arrival.
  bool receive(SurfaceTopology surface);
  bool receive(NodePositions positions, std::int64_t now_ns);
  bool receive(const ProbeState& probe);
  bool receive(Contacts contacts);
  bool receive(const HapticForce& force);
  bool receive(const ContactModel& law);
  void receive(ModuleStatus status, std::int64_t now_ns);
  void receive(const SessionControl& control);

  /// Recomputes normals, displacement and strain of the organs that moved since the last call.
  void refresh();

  const scene::Scene& scene() const { return scene_; }
  const std::vector<OrganView>& organs() const { return organs_; }
  const std::vector<ProbeView>& probes() const { return probes_; }
  const std::map<std::string, ModuleView>& modules() const { return modules_; }
  const SessionControl& session() const { return session_; }  ///< source time 0 before the first
  /// The run is over, and the window stays: the session stands and its modules have left.
  bool ended() const;
  void end() { ended_ = true; }  ///< of a session without a clock, whose modules do not say so

  double sim_time() const { return seconds_; }  ///< newest of all organs and probes [s]
  double real_time_factor() const;              ///< as the deformation reports it; 0 = unknown
  /// Age of the oldest organ's newest positions [s]; infinity before the first.
  double positions_age(std::int64_t now_ns) const;

  /// Ball that holds all organs at rest; before the first surface, about the scene's origin.
  Vec3 center() const { return center_; }
  double radius() const { return radius_; }  ///< [m]

  /// Tops of the colour scales: round numbers that hold 99.5 % of the nodes; they grow at once and
  /// shrink only when a quarter of them would do.
  double strain_top() const { return strain_top_; }              ///< [1]
  double displacement_top() const { return displacement_top_; }  ///< [m]

 private:
  void show(SurfaceTopology surface);
  void note_time(std::int64_t sim_time_ns);
  void find_extent();

  scene::Scene scene_;
  std::vector<OrganView> organs_;
  std::vector<std::uint64_t> refreshed_;  ///< positions_version of each organ at the last refresh
  std::vector<ProbeView> probes_;
  std::map<std::string, ModuleView> modules_;
  SessionControl session_;
  bool ended_ = false;
  double seconds_ = 0;
  Vec3 center_ = Vec3::Zero();
  double radius_ = 0.1;
  double strain_top_ = 0.05;
  double displacement_top_ = 0.005;
};

}  // namespace palpate::visualizer
