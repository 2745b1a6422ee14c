#include "bench/bullet/bullet_ball.h"

#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <array>
#include <vector>

#include "studies/report/measures.h"

namespace palpate::bench {
namespace {

constexpr double kScale = 1 / kBallRadius;  // Bullet's lengths per metre
constexpr double kMargin = 1e-3;            // [m]: at which nodes rest before a surface
constexpr double kBoxHalf = 0.05;           // [m], half the thickness of a plate

btVector3 scaled(const Vec3& p) {
  return {btScalar(kScale * p.x()), btScalar(kScale * p.y()), btScalar(kScale * p.z())};
}

btTransform at_height(double z) {
  btTransform pose = btTransform::getIdentity();
  pose.setOrigin({0, 0, btScalar(kScale * z)});
  return pose;
}

/// A box whose inner face holds nodes at ±height.
double box_center(int side, double height) { return side * (height + kMargin + kBoxHalf); }

/// Times its search for collisions, contacts' creation included.
class TimedWorld : public btSoftRigidDynamicsWorld {
 public:
  using btSoftRigidDynamicsWorld::btSoftRigidDynamicsWorld;
  void performDiscreteCollisionDetection() override {
    const double begin = report::processor_time();
    btSoftRigidDynamicsWorld::performDiscreteCollisionDetection();
    search_seconds += report::processor_time() - begin;
  }
  double search_seconds = 0;
};

}  // namespace

struct BulletBall::World {
  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  TimedWorld world{&dispatcher, &broadphase, &solver, &configuration};
  btBoxShape plate_shape{{btScalar(4), btScalar(4), btScalar(kScale* kBoxHalf)}};
  std::array<std::unique_ptr<btRigidBody>, 2> plates;
  std::unique_ptr<btSoftBody> body;
  const std::vector<geometry::Triangle>& triangles;
  double rest_volume = 0;
  double step_seconds = 0;

  World(const Ball& ball, const BulletSettings& settings)
      : triangles(ball.surface.triangles), rest_volume(ball.model.rest_volume) {
    world.setGravity({0, 0, 0});
    auto& info = world.getWorldInfo();
    info.m_gravity = {0, 0, 0};
    info.air_density = info.water_density = 0;
    info.m_sparsesdf.Initialize();
    add_plates();
    add_body(ball);
    configure(ball, settings);
    world.addSoftBody(body.get());
  }

  ~World() {
    world.removeSoftBody(body.get());
    for (auto& plate : plates) world.removeRigidBody(plate.get());
  }

  void add_plates() {
    for (int i = 0; i < 2; ++i) {
      auto& plate = plates[static_cast<std::size_t>(i)];
      plate = std::make_unique<btRigidBody>(
          btRigidBody::btRigidBodyConstructionInfo(0, nullptr, &plate_shape));
      plate->setCollisionFlags(plate->getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
      plate->setActivationState(DISABLE_DEACTIVATION);
      plate->setWorldTransform(at_height(box_center(i == 0 ? 1 : -1, kBallRadius)));
      world.addRigidBody(plate.get());
    }
  }

  void add_body(const Ball& ball) {
    const auto& network = ball.model.network();
    std::vector<btVector3> positions;
    std::vector<btScalar> masses;
    for (std::size_t i = 0; i < ball.model.node_count(); ++i) {
      positions.push_back(scaled(ball.model.rest_positions[i]));
      masses.push_back(btScalar(ball.model.masses[i]));
    }
    body = std::make_unique<btSoftBody>(&world.getWorldInfo(), int(positions.size()),
                                        positions.data(), masses.data());
    body->getCollisionShape()->setMargin(btScalar(kScale * kMargin));
    for (const auto& t : ball.surface.triangles) {
      body->appendFace(int(t[0]), int(t[1]), int(t[2]));
    }
    for (const auto& spring : network.springs) {
      const double w =
          ball.model.inverse_masses[spring.node_a] + ball.model.inverse_masses[spring.node_b];
      const double stiffness = spring.stiffness * kStep * kStep * w;
      auto* material = body->appendMaterial();
      material->m_kLST = btScalar(stiffness / (1 + stiffness));
      body->appendLink(int(spring.node_a), int(spring.node_b), material);
    }
  }

  void configure(const Ball& ball, const BulletSettings& settings) {
    const double s = kScale, volume = ball.model.rest_volume;
    auto& config = body->m_cfg;
    config.piterations = settings.position_iterations;
    config.kDP = btScalar(ball.model.drag * kStep);
    config.kDF = 0;   // no friction, as in our rows
    config.kCHR = 1;  // contacts fully hard
    config.kKHR = 1;
    config.collisions = btSoftBody::fCollision::SDF_RS;
    // p = kVC (V₀ − V) and p = kPR/V, in Bullet's unit of length
    config.kVC = btScalar(settings.volume_stiffness / volume / (s * s * s * s));
    config.kPR = btScalar(settings.gas_pressure * volume * s * s);
    body->setPose(/*bvolume=*/true, /*bframe=*/false);
  }
};

BulletBall::BulletBall(const Ball& ball, const BulletSettings& settings)
    : world_(std::make_unique<World>(ball, settings)), settings_(settings) {}

BulletBall::~BulletBall() = default;

void BulletBall::step(double height) {
  for (int i = 0; i < 2; ++i) {
    world_->plates[static_cast<std::size_t>(i)]->setWorldTransform(
        at_height(box_center(i == 0 ? 1 : -1, height)));
  }
  const double begin = report::processor_time();
  world_->world.stepSimulation(btScalar(kStep), 0);
  world_->step_seconds += report::processor_time() - begin;
}

double BulletBall::solver_seconds() const {
  return world_->step_seconds - world_->world.search_seconds;
}

double BulletBall::pressure() const {
  if (settings_.volume_stiffness == 0 && settings_.gas_pressure == 0) return kNone;
  const double ratio = volume() / world_->rest_volume;
  return settings_.volume_stiffness * (1 - ratio) + settings_.gas_pressure / ratio;
}

std::size_t BulletBall::contact_count() const {
  return std::size_t(world_->body->m_rcontacts.size());
}

double BulletBall::depth_beyond(double height) const {
  double farthest = 0;
  for (int i = 0; i < world_->body->m_nodes.size(); ++i) {
    const double z = world_->body->m_nodes[i].m_x.z() / kScale;
    farthest = std::max(farthest, std::abs(z) - height);
  }
  return farthest;
}

double BulletBall::volume() const {
  std::vector<Vec3> nodes;
  for (int i = 0; i < world_->body->m_nodes.size(); ++i) {
    const btVector3& x = world_->body->m_nodes[i].m_x;
    nodes.emplace_back(x.x() / kScale, x.y() / kScale, x.z() / kScale);
  }
  return geometry::enclosed_volume(nodes, world_->triangles);
}

}  // namespace palpate::bench
