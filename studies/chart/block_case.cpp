// A block with bonded ends, compressed: force and bulge against reference solutions, and the beads
// of the Truth Cube. The same block bends as a beam, and is indented by a sphere.
#include <cmath>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/geometry/tools/gmsh_tool.h"
#include "modules/scene/models.h"
#include "studies/chart/case_parts.h"
#include "studies/chart/displacement_field.h"
#include "studies/chart/equilibria.h"
#include "studies/chart/reference_solutions.h"
#include "studies/chart/truth_cube.h"
#include "studies/rigs/indented_block.h"
#include "studies/rigs/squeezed_ball.h"

namespace palpate::chart {
namespace {

constexpr double kHalf = rigs::kBlockHalfWidth, kHeight = rigs::kBlockHeight;  // [m]
constexpr double kBlockPlateSpeed = 0.01;                                      // [m/s]
constexpr double kBlockDrag = 60;                                              // [1/s]
/// No less than the largest a scene takes: the plate holds the tissue as if bonded.
constexpr double kBondFriction = 2;
const double kEqualRadius = std::cbrt(3 * 8 * kHalf * kHalf * kHalf / (4 * M_PI));

/// Edges of `size`; of a quadratic model twice as long, so that nodes are as many.
geometry::OrganShape block_shape(const Setting& setting, const Vec3& low, const Vec3& high,
                                 double size, const std::string& growth) {
  if (scene::is_quadratic(setting.model)) size *= 2;
  std::ostringstream expression;
  expression << size << growth;
  return shape_for(setting, geometry::shape_of(geometry::mesh_block(low, high, expression.str())));
}

geometry::OrganShape block_shape(const Setting& setting) {
  constexpr std::array kSizes{0.016, 0.008, 0.004};
  return block_shape(setting, {-kHalf, -kHalf, 0}, {kHalf, kHalf, kHeight},
                     kSizes[static_cast<std::size_t>(setting.level)], " + 0*x");
}

scene::Scene block_scene(const Setting& setting) {
  scene::Scene scene;
  scene.organs.push_back(solid_organ(setting, kEqualRadius, 1, kYoungsModulus, kDensity));
  scene.organs[0].tissue.drag = kBlockDrag;
  scene.organs[0].fixed.push_back(rigs::block_base());
  scene.rates.deformation = setting.rate;
  return scene;
}

/// A sphere presses the middle of the block's top.
constexpr double kTip = rigs::kIndenterRadius, kTipSpeed = 4e-3;  // [m], [m/s]
constexpr std::array kTipDepths{2e-3, 4e-3, 6e-3, 8e-3};

/// A beam along x, held at x = 0.
constexpr double kLength = 0.1, kWidth = 0.02, kStiff = 200e3;  // [m], [m], [Pa]
const Vec3 kBeamLow(0, -kWidth / 2, -kWidth / 2), kBeamHigh(kLength, kWidth / 2, kWidth / 2);
const Vec3 kWeight(0, 0, -9.81);

Vec3 displacement(const rigs::PressedOrgan& pressed, const NodeWeights& weights) {
  Vec3 sum = Vec3::Zero();
  for (const auto& [node, weight] : weights) {
    sum += weight * (pressed.position(node) - pressed.rest_position(node));
  }
  return sum;
}

/// Compresses the block by each of `compressions` and asks `answer` each time it has come to rest.
Measurement compress(const Setting& setting, const std::vector<double>& compressions,
                     const geometry::OrganShape& shape,
                     const std::function<Sample(const rigs::PressedOrgan&, double)>& answer,
                     const KeepGoing& keep_going) {
  scene::Scene scene = block_scene(setting);
  scene.probes.push_back({"plate", scene::PlaneShape{}, kBondFriction, scene::ScriptedDevice{}});
  rigs::PressedOrgan pressed(scene, shape, {rigs::plate_pose(kHeight, false)});
  std::vector<Sample> samples;
  for (const double compression : compressions) {
    pressed.move_and_settle({{0, 0, kHeight * (1 - compression)}}, kBlockPlateSpeed, keep_going);
    samples.push_back(answer(pressed, compression));
    if (pressed.diverged()) break;
  }
  Measurement result = summary(pressed, shape);
  result.samples = samples;
  return result;
}

struct GridPoint {
  NodeWeights weights;
  double compression = 0;
  Vec3 displacement;  ///< of the reference [m]
};

std::vector<GridPoint> reference_grid(const std::filesystem::path& file,
                                      const geometry::OrganShape& shape) {
  const ReferenceTable table(file);
  std::vector<GridPoint> grid;
  for (std::size_t row = 0; row < table.size(); ++row) {
    const Vec3 at(table.at("X_m", row), table.at("Y_m", row), table.at("Z_m", row));
    const Vec3 moved(table.at("ux_mm", row), table.at("uy_mm", row), table.at("uz_mm", row));
    grid.push_back({weights_at(shape, at), table.at("compression", row), 1e-3 * moved});
  }
  return grid;
}

double grid_error(const rigs::PressedOrgan& pressed, const std::vector<GridPoint>& grid,
                  double compression) {
  double sum = 0;
  int count = 0;
  for (const GridPoint& point : grid) {
    if (std::abs(point.compression - compression) > 1e-9) continue;
    sum += (displacement(pressed, point.weights) - point.displacement).squaredNorm();
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : kUnknown;
}

}  // namespace

Measurement measure_block(const Setting& setting, const KeepGoing& keep_going) {
  const ReferenceTable reference(data_file("reference/C_block_force_bulge.csv"));
  const auto shape = block_shape(setting);
  const auto grid = reference_grid(data_file("reference/C_block_grid_5x5x5.csv"), shape);
  const auto middle = weights_at(shape, {kHalf, 0, kHeight / 2});
  const auto answer = [&](const rigs::PressedOrgan& pressed, double compression) {
    const std::size_t row = reference.row_of("compression", compression);
    Sample sample;
    sample.load = compression;
    sample.force = std::abs(pressed.force(0).z());
    sample.reference_force = reference.at("F_N", row);
    sample.shape = displacement(pressed, middle).x();
    sample.reference_shape = 1e-3 * reference.at("lateral_bulge_face_centre_mm", row);
    sample.field_error = grid_error(pressed, grid, compression);
    return sample;
  };
  return compress(setting, {0.05, 0.125, 0.1825}, shape, answer, keep_going);
}

Measurement measure_truth_cube(const Setting& setting, const KeepGoing& keep_going) {
  const auto folder = truth_cube_folder();
  if (!folder) throw InputError("truthcube: PALPATE_DATA is not there");
  const TruthCube cube = read_truth_cube(*folder);
  const auto shape = block_shape(setting);
  std::vector<NodeWeights> beads;
  for (const Vec3& bead : cube.rest) beads.push_back(weights_at(shape, bead));
  const auto answer = [&](const rigs::PressedOrgan& pressed, double compression) {
    std::vector<Vec3> moved;
    for (std::size_t i = 0; i < beads.size(); ++i) {
      moved.push_back(cube.rest[i] + displacement(pressed, beads[i]));
    }
    Sample sample;
    sample.load = compression;
    sample.field_error = distance_after_fit(moved, cube.states.at(compression));
    return sample;
  };
  std::vector<double> compressions;
  for (const auto& [compression, positions] : cube.states) compressions.push_back(compression);
  return compress(setting, compressions, shape, answer, keep_going);
}

Measurement measure_beam(const Setting& setting, const KeepGoing& keep_going) {
  constexpr double kLongest = 5;  // [s]
  constexpr std::array kSizes{0.01, 0.0067, 0.004};
  const auto shape = block_shape(setting, kBeamLow, kBeamHigh,
                                 kSizes[static_cast<std::size_t>(setting.level)], " + 0*x");
  scene::Scene scene;
  const double radius = std::cbrt(3 * kLength * kWidth * kWidth / (4 * M_PI));
  scene.organs.push_back(solid_organ(setting, radius, kVirtualNodes, kStiff, kDensity));
  scene.organs[0].tissue.drag = 20;
  scene.organs[0].fixed.push_back(scene::BoxRegion{{-1, -1, -1}, {1e-6, 1, 1}});
  scene.gravity = kWeight;
  scene.rates.deformation = setting.rate;
  rigs::PressedOrgan pressed(scene, shape, {});
  const auto tip = weights_at(shape, {kLength, 0, 0});
  pressed.settle(kLongest, keep_going);
  Measurement result = summary(pressed, shape);
  Sample sample;
  sample.load = kWeight.norm();
  sample.shape = -displacement(pressed, tip).z();
  result.samples.push_back(sample);
  return result;
}

Measurement bend_beam(int level, const KeepGoing& keep_going) {
  constexpr std::array kSizes{"0.007", "0.005"};
  const deformation::TaylorHoodElements solid(
      deformation::make_quadratic(
          geometry::mesh_block(kBeamLow, kBeamHigh, kSizes[static_cast<std::size_t>(level)])),
      deformation::ElasticConstants(kStiff, kPoissonRatio), kDensity);
  std::vector<char> constrained;
  for (const Vec3& node : solid.mesh().nodes)
    constrained.insert(constrained.end(), 3, node.x() == 0);
  Measurement result = summary(solid);
  Sample& sample = result.samples.emplace_back();
  sample.load = kWeight.norm();
  sample.shape = -sag_at_rest(solid, constrained, kWeight, {{kLength, 0, 0}}, keep_going)[0].z();
  return result;
}

Measurement measure_indent(const Setting& setting, const KeepGoing& keep_going) {
  constexpr std::array kSizes{2e-3, 0.93e-3, 0.6e-3};  // under the tip
  static const double kFlat = std::sqrt(3e-4);         // [m]
  const ReferenceTable reference(data_file("reference/D_indent_force_depth.csv"));
  double size = kSizes[static_cast<std::size_t>(setting.level)];
  const double growth = 20 * size;
  if (scene::is_quadratic(setting.model)) size *= 2;
  const auto shape =
      shape_for(setting, geometry::shape_of(rigs::whole_block({size, growth, kFlat})));
  scene::Scene scene = block_scene(setting);
  rigs::add_indenter(scene);
  rigs::PressedOrgan pressed(scene, shape, {{rigs::indenter_at(-1e-4), Quat::Identity()}});
  std::vector<NodeWeights> places;
  places.reserve(kProfilePlaces.size());
  for (const double place : kProfilePlaces)
    places.push_back(weights_at(shape, {place, 0, kHeight}));
  std::vector<Sample> samples;
  for (const double depth : kTipDepths) {
    pressed.move_and_settle({rigs::indenter_at(depth)}, kTipSpeed, keep_going);
    const std::size_t row = reference.row_of("depth_mm", std::round(1e3 * depth));
    Sample sample;
    sample.load = depth;
    sample.force = pressed.force(0).z();
    sample.reference_force = reference.at("F_block_N", row);
    sample.contact_radius = contact_radius(pressed, Vec3::UnitZ(), [&](const Vec3& x) {
      return (x - pressed.pose(0).position).norm() - kTip;
    });
    sample.reference_contact_radius = 1e-3 * reference.at("contact_radius_mm", row);
    for (std::size_t i = 0; i < places.size(); ++i) {
      sample.profile[i] = displacement(pressed, places[i]).z();
    }
    samples.push_back(sample);
    if (pressed.diverged()) break;
  }
  Measurement result = summary(pressed, shape);
  result.samples = samples;
  return result;
}

/// A quarter of the block, as in case D of studies/elements.
Measurement press_block(int level, const KeepGoing& keep_going) {
  constexpr std::array kSizes{0.4, 0.28};  // of the tip's radius
  const deformation::TaylorHoodElements solid(
      deformation::make_quadratic(rigs::quarter_block(kSizes[static_cast<std::size_t>(level)])),
      deformation::ElasticConstants(kYoungsModulus, kPoissonRatio), kDensity);
  std::vector<char> constrained;
  constrained.reserve(solid.displacement_count());
  for (const Vec3& node : solid.mesh().nodes) {
    for (int axis = 0; axis < 3; ++axis)
      constrained.push_back(rigs::is_constrained_in_quarter(node, axis));
  }
  Press press{{0, 0, kHeight}, -Vec3::UnitZ(), kTip, {kTipDepths.begin(), kTipDepths.end()}, {}};
  for (const double place : kProfilePlaces) press.marks.emplace_back(place, 0, kHeight);
  Measurement result = summary(solid);
  const auto answers = press_at_rest(solid, constrained, press, keep_going);
  for (std::size_t i = 0; i < answers.size(); ++i) {
    Sample& sample = result.samples.emplace_back();
    sample.load = kTipDepths[i];
    sample.force = 4 * answers[i].force;
    for (std::size_t k = 0; k < kProfilePlaces.size(); ++k) {
      sample.profile[k] = answers[i].displacements[k].z();
    }
  }
  return result;
}

}  // namespace palpate::chart
