// A solid ball between frictionless plates, and its free vibration.
#include <algorithm>
#include <cmath>

#include "deformation/models.h"
#include "modules/core/data_folder.h"
#include "modules/geometry/primitives.h"
#include "modules/scene/models.h"
#include "studies/chart/case_parts.h"
#include "studies/report/measures.h"
#include "studies/rigs/squeezed_ball.h"

namespace palpate::chart {
namespace {

constexpr double kRadius = rigs::kBallRadius;
constexpr double kBallPlateSpeed = 0.02;  // [m/s]
/// About critical for the ball's slowest mode, the one the plates excite [1/s].
constexpr double kBallDrag = 60;

}  // namespace

geometry::OrganShape ball_shape(const Setting& setting) {
  const bool quadratic = scene::is_quadratic(setting.model);
  const int levels = setting.level + (quadratic ? 1 : 2);
  if (!scene::is_solid(setting.model)) return geometry::make_ball(kRadius, levels);
  auto shape = shape_for(setting, rigs::filled_ball(levels));
  for (Vec3& node : shape.surface.nodes) node *= kRadius / node.norm();
  return shape;
}

scene::Scene ball_scene(const Setting& setting, double drag) {
  scene::Scene scene;
  scene.organs.push_back(solid_organ(setting, kRadius, 1, kYoungsModulus, kDensity));
  scene.organs[0].tissue.drag = drag;
  scene.rates.deformation = setting.rate;
  return scene;
}

namespace {

double equatorial_radius(const rigs::PressedOrgan& pressed) {
  return rigs::equatorial_radius(pressed.model().triangles,
                                 [&](std::size_t node) { return pressed.position(node); });
}

/// Amplitude of the ellipsoidal mode: Σ m (2 z u_z − x u_x − y u_y) / Σ m (4z² + x² + y²).
double ellipsoid(const deformation::OrganModel& model, const deformation::OrganState& state) {
  double sum = 0, norm = 0;
  for (std::size_t i = 0; i < model.node_count(); ++i) {
    const Vec3& x = model.rest_positions[i];
    const Vec3 mode(-x.x(), -x.y(), 2 * x.z());
    sum += model.masses[i] * mode.dot(state.positions[i] - x);
    norm += model.masses[i] * mode.squaredNorm();
  }
  return sum / norm;
}

/// From the times at which a swing passes zero, about its mean over whole periods [Hz].
double frequency_of(const std::vector<double>& swing, double h) {
  std::vector<double> crossings;
  for (std::size_t i = 1; i < swing.size(); ++i) {
    if ((swing[i - 1] < 0) == (swing[i] < 0)) continue;
    const double part = swing[i - 1] / (swing[i - 1] - swing[i]);
    crossings.push_back((static_cast<double>(i) - 1 + part) * h);
  }
  if (crossings.size() < 3) return kUnknown;
  const double halves = static_cast<double>(crossings.size() - 1);
  return halves / (2 * (crossings.back() - crossings.front()));
}

}  // namespace

Measurement measure_ball(const Setting& setting, const KeepGoing& keep_going) {
  const ReferenceTable reference(data_file("reference/A_ball_plates.csv"));
  const auto shape = ball_shape(setting);
  scene::Scene scene = ball_scene(setting, kBallDrag);
  const auto plates = rigs::add_plates(scene);
  rigs::PressedOrgan pressed(scene, shape, plates);
  const double rest_radius = equatorial_radius(pressed);
  std::vector<Sample> samples;
  for (const double compression : {0.1, 0.2, 0.3, 0.4}) {
    const double height = kRadius * (1 - compression);
    pressed.move_and_settle({{0, 0, height}, {0, 0, -height}}, kBallPlateSpeed, keep_going);
    const std::size_t row = reference.row_of("compression_d_over_2R", compression);
    Sample sample;
    sample.load = compression;
    sample.force = (std::abs(pressed.force(0).z()) + std::abs(pressed.force(1).z())) / 2;
    sample.reference_force = reference.at("F_N_nu0.499", row);
    // The mesh's own radius is a little less than the ball's: growth is compared.
    sample.shape = equatorial_radius(pressed) / rest_radius * kRadius - kRadius;
    sample.reference_shape = 1e-3 * reference.at("equatorial_radius_mm_nu0.499", row) - kRadius;
    sample.contact_radius =
        contact_radius(pressed, Vec3::UnitZ(), [&](const Vec3& x) { return height - x.z(); });
    sample.reference_contact_radius = 1e-3 * reference.at("contact_radius_mm_nu0.499", row);
    samples.push_back(sample);
    if (pressed.diverged()) break;
  }
  Measurement result = summary(pressed, shape);
  result.samples = samples;
  return result;
}

Measurement measure_vibration(const Setting& setting, const KeepGoing& keep_going) {
  constexpr double kDuration = 1, kAmplitude = 0.01;  // [s], of the radius
  const ReferenceTable reference(data_file("reference/E_ball_frequencies.csv"));
  const auto shape = ball_shape(setting);
  scene::Scene scene = ball_scene(setting, 0);
  scene.organs[0].tissue.damping_ratio = 0;
  const auto model = deformation::build_organ_model(scene.organs[0], Vec3::Zero(), shape);
  const auto dynamics = deformation::make_dynamics(scene.organs[0], model, 1 / setting.rate);
  auto state = deformation::rest_state(model);
  for (Vec3& x : state.positions) {
    x += kAmplitude * Vec3(-x.x() / 2, -x.y() / 2, x.z());
  }
  const int substeps = static_cast<int>(std::ceil(1 / (setting.rate * dynamics->largest_step())));
  const double h = 1 / (setting.rate * substeps);
  std::vector<double> swing{ellipsoid(model, state)};
  double busy = 0;
  while (static_cast<double>(swing.size()) * h < kDuration) {
    keep_going();
    const double before = report::processor_time();
    dynamics->step(h, {}, state);
    busy += report::processor_time() - before;
    swing.push_back(ellipsoid(model, state));
  }
  Measurement result;
  result.surface_nodes = shape.surface.nodes.size();
  result.inner_nodes = shape.inner_nodes.size();
  result.tetrahedra = shape.tetrahedra.size();
  result.step = h;
  result.cost = busy / (static_cast<double>(swing.size() - 1) * h);
  result.volume_error = kUnknown;
  Sample sample;
  sample.load = sample.reference_force = reference.at("f_Hz_Lamb_exact", 1);  // spheroidal, n = 2
  sample.force = frequency_of(swing, h);
  result.diverged = !std::isfinite(swing.back()) || std::abs(swing.back()) > 10 * kAmplitude;
  result.samples.push_back(sample);
  return result;
}

}  // namespace palpate::chart
