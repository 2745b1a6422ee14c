// What the modules tell each other, as plain structs. The wire types in idl/ mirror them; the
// codecs beside them (cdr.h) translate and check. Field units and frames as in idl/README.md.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "modules/core/organ_limits.h"
#include "modules/core/touch.h"
#include "modules/core/types.h"

namespace palpate {

/// Version of the message set; processes with different versions refuse to work together.
inline constexpr std::uint32_t kProtocolVersion = 14;

// Bounds of the lists on the wire.
inline constexpr std::size_t kMaxContactsPerProbe = 16384;
inline constexpr std::size_t kMaxFacesPerProbe = 1024;
inline constexpr std::size_t kMaxFaceNodes = kMaxNodes;  ///< of all faces of a probe
inline constexpr std::size_t kMaxLawCompliance = 3 * kMaxLawRows * (3 * kMaxLawRows + 1) / 2;
inline constexpr std::size_t kMaxInputs = 16;
inline constexpr std::size_t kMaxClockEchoes = 64;

/// First field of every message.
struct Header {
  std::uint64_t sequence = 0;       ///< counts up from 1 per writer
  std::int64_t sim_time_ns = 0;     ///< simulated time since the session started [ns]
  std::int64_t source_time_ns = 0;  ///< the writer's monotonic clock at sampling [ns]
  std::uint64_t session_token = 0;  ///< only on the wire: buses write it and take it off
};

/// Pose of one probe. Written by haptics (topic probe_state) and by outside drivers of a probe
/// whose device is `topic` (topic probe_input).
struct ProbeState {
  Header header;
  std::uint32_t probe = 0;    ///< index in the scene's list (key)
  Pose pose;                  ///< X_WP
  Twist twist;                ///< in W
  std::uint32_t buttons = 0;  ///< bit i = button i held
};

/// Contacts of one probe (key).
struct Contacts : ContactSet {
  Header header;
  std::vector<std::uint32_t> generations;  ///< by organ, of the surface they were found on
};

/// The tissue's local law for one probe: of the organs of one process. The forces of all add.
struct ContactModel : LocalLaw {
  Header header;
  std::uint32_t probe = 0;    ///< (key)
  std::uint32_t process = 1;  ///< of deformation (key)
  /// How much too large the force is because of the organ's mesh, estimated a few times a second: a
  /// part of it, 0 … 1, 1: as much or more; 0 where nothing is estimated.
  double force_error = 0;
};

/// Deformed nodes of one organ: surface nodes first, then virtual nodes or a solid's inner nodes.
struct NodePositions {
  Header header;
  std::uint32_t organ = 0;           ///< (key)
  std::uint32_t generation = 0;      ///< of the SurfaceTopology these belong to
  double volume = 0;                 ///< enclosed [m³]
  double target_volume = 0;          ///< V* [m³]
  double pressure = 0;               ///< of the contents over the outside, p = −λ [Pa]
  double kinetic_energy = 0;         ///< [J]
  double elastic_energy = 0;         ///< in all springs or elements; of now or up to 0.04 s ago [J]
  std::uint32_t organ_contacts = 0;  ///< places where it presses on another organ or on itself
  std::vector<float> positions;      ///< x, y, z per node, in W [m]  (node_count × 3)
  std::vector<float> block_boxes;  ///< least and greatest x, y, z of the triangles of each block of
                                   ///< SurfaceTopology [m]  (block_count × 6); none: not told
};

/// What does not change while an organ deforms.
struct SurfaceTopology {
  struct Spring {
    std::uint32_t node_a = 0, node_b = 0;
    SpringFamily family = SpringFamily::kStructural;
  };
  Header header;
  std::uint32_t organ = 0;       ///< (key)
  std::uint32_t generation = 0;  ///< counts restarts, resets and changes of the organ's mesh
  std::string name;
  std::uint32_t surface_node_count = 0;
  std::vector<float> rest_positions;                    ///< (node_count × 3) in W [m]
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< outward orientation
  std::vector<std::uint32_t> triangle_blocks;           ///< of each triangle, see
                                                        ///< geometry::SurfaceBlocks; none: not told
  std::vector<std::uint32_t> fixed_nodes;
  std::vector<Spring> springs;
};

/// Force commanded to the device of one probe.
struct HapticForce : RenderedForce {
  Header header;
  std::uint32_t probe = 0;  ///< (key)
};

enum class ModuleState : std::uint8_t {
  kStarting = 0,  ///< loading, or waiting for an input it cannot do without
  kReady = 1,     ///< waiting for the session to start
  kRunning = 2,
  kPaused = 3,
  kDegraded = 4,  ///< running, but a guard acts or an input is stale; last_error says which
  kFault = 5,     ///< holds its last good state; last_error says why
  kStopped = 6    ///< said goodbye
};

/// What of contacts went wrong, counted since a module's start.
struct ContactTroubles {
  std::uint64_t truncated = 0;  ///< searches that left contacts out
  std::uint64_t lost = 0;       ///< searches that found a probe inside an organ without a contact
  std::uint64_t unsolved = 0;   ///< steps of organs whose contacts were not solved to the end

  bool any() const { return truncated + lost + unsolved > 0; }
  ContactTroubles& operator+=(const ContactTroubles& other) {
    truncated += other.truncated;
    lost += other.lost;
    unsolved += other.unsolved;
    return *this;
  }
};

/// What a deformation process has seen of one of its organs since it first ran the session.
struct OrganExtremes {
  std::uint32_t organ = 0;        ///< in scene order
  double volume_ratio = 0;        ///< newest V/V*, < 0 turned inside out; 0 before the first
  double worst_volume_error = 0;  ///< largest |V−V*|/V*
  double lowest_pressure = 0, highest_pressure = 0;  ///< [Pa]
  std::uint32_t most_contacts = 0;                   ///< with other organs and itself at a time
};

/// What the haptic loop has made of a probe's force since it first ran the session.
struct ProbeExtremes {
  std::uint32_t probe = 0;       ///< in scene order
  double force = 0;              ///< newest magnitude [N]
  double greatest_force = 0;     ///< [N]
  std::uint32_t limits = 0;      ///< ForceLimit bits that ever acted, but those of a pause
  double error_of_greatest = 0;  ///< ContactModel::force_error when the force was greatest
};

/// Published by every process, a few times a second.
struct ModuleStatus {
  struct Input {
    std::string topic;
    double age = 0;        ///< of the newest sample; infinity before the first [s]
    double age_error = 0;  ///< how well its writer's clock is known; 0 of this host's [s]
    std::uint64_t received = 0;
    std::uint64_t dropped = 0;   ///< gaps in the writers' sequence numbers
    std::uint64_t rejected = 0;  ///< samples refused by the codec
  };
  Header header;
  std::string module;  ///< "deformation", "collision", … (key)
  ModuleState state = ModuleState::kStarting;
  std::int64_t process_id = 0;
  double rate_hz = 0;  ///< cycles per wall second since the last status
  double nominal_rate_hz = 0;
  std::uint64_t cycles = 0;     ///< since start
  std::uint64_t overruns = 0;   ///< cycles that missed their period, since start
  double worst_lateness = 0;    ///< of a wake-up since start [s]
  double busy_fraction = 0;     ///< of the period spent working, mean since the last status
  double real_time_factor = 0;  ///< simulated per wall time, 0 where it has no meaning
  bool realtime_priority = false;
  std::uint64_t packets_refused = 0;  ///< not sound, or in another's name, since start
  ContactTroubles contacts;           ///< of collision and deformation
  std::string last_error;             ///< empty if none
  std::vector<Input> inputs;          ///< at most kMaxInputs
  std::vector<OrganExtremes> organs;  ///< of deformation, at most kMaxOrgans
  std::vector<ProbeExtremes> probes;  ///< of haptics, at most kMaxProbes
};

/// The resolved scene, for late joiners and recordings.
struct SceneDescription {
  Header header;
  std::uint32_t protocol_version = kProtocolVersion;
  std::string name;
  std::string digest;         ///< of the resolved scene and its meshes; equal iff same physics
  std::string resolved_text;  ///< YAML with every default written out
};

enum class SessionCommand : std::uint8_t {
  kStart = 0,
  kPause = 1,
  kReset = 2,
  kStop = 3,
  kStep = 4  ///< lockstep: go on until `until_ns`
};

struct SessionControl {
  Header header;
  SessionCommand command = SessionCommand::kStart;
  std::uint32_t reset_count = 0;  ///< counts kReset commands, so that none is applied twice
  /// Simulated time zero on the monotonic clock of the launcher's host, valid for kStart [ns].
  std::int64_t start_time_ns = 0;
  /// Lockstep: cycles that begin before this simulated time may run [ns].
  std::int64_t until_ns = 0;
};

/// Several hosts: every process says when it speaks, and when it heard what the others said. With
/// its own clock, each then knows how far the others' are from it (modules/bus/clock_offset.h).
struct ClockExchange {
  struct Echo {
    std::uint32_t process = 0;     ///< who was heard
    std::int64_t sent_ns = 0;      ///< its source time [ns]
    std::int64_t received_ns = 0;  ///< when that came, on the writer's clock [ns]
  };
  Header header;
  std::uint32_t process = 0;  ///< who speaks: a number of its own
  std::vector<Echo> echoes;   ///< of other hosts' processes, at most kMaxClockEchoes
};

}  // namespace palpate

// All of them.
#define PALPATE_MESSAGES(X) \
  X(ProbeState)             \
  X(Contacts)               \
  X(ContactModel)           \
  X(NodePositions)          \
  X(SurfaceTopology)        \
  X(HapticForce)            \
  X(ModuleStatus)           \
  X(SceneDescription)       \
  X(SessionControl)         \
  X(ClockExchange)
