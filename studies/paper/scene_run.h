// A scene run in one process, with what the figures need of every period.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "palpate/session/in_process.h"
#include "studies/report/progress.h"

namespace palpate::paper {

/// The first organ and its probes after one deformation period.
struct Sample {
  double time = 0;              ///< simulated [s]
  double volume = 0;            ///< [m³]
  double target_volume = 0;     ///< V* [m³]
  double pressure = 0;          ///< [Pa]
  double force = 0;             ///< magnitude, of the tissue on the first probe [N]
  double far_displacement = 0;  ///< mean, of free surface nodes far from the first probe [m]
  double volume_error() const { return volume / target_volume - 1; }
};

/// Far from the probe: farther at rest than half the organ's extent along its dominant axis.
class FarField {
 public:
  explicit FarField(const SurfaceTopology& topology);

  /// Mean displacement [m] of the free surface nodes so far from `p_W`.
  double displacement(const NodePositions& nodes, const Vec3& p_W) const;

 private:
  std::vector<Vec3> rest_;  ///< of the free surface nodes [m]
  std::vector<std::uint32_t> nodes_;
  double distance_ = 0;
};

/// Called after every period with the pipeline as it then is; false: enough.
using Observer = std::function<bool(const session::InProcess&, const Sample&)>;

/// Runs the scene for `seconds` of simulated time, one sample per deformation period.
/// @throws InputError as load_session(), Stopped
std::vector<Sample> run_scene(const scene::Scene& scene, double seconds, report::Progress& progress,
                              const Observer& observe = {});

/// One row per sample: time_s, volume_ratio, volume_error, pressure_pa, force_n,
/// far_displacement_m.
void write_samples(const std::vector<Sample>& samples, const std::filesystem::path& file);

/// "implicit_volume" or "mass_spring": the key in the scene file.
std::string model_key(const std::string& model);

/// The largest |V − V*|/V*.
double worst_volume_error(const std::vector<Sample>& samples);
double greatest_force(const std::vector<Sample>& samples);  ///< [N]

}  // namespace palpate::paper
