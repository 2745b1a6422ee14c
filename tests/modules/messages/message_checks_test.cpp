#include "modules/messages/message_checks.h"

#include <catch2/catch.hpp>
#include <limits>

#include "modules/core/tolerances.h"
#include "tests/modules/messages/random_messages.h"

namespace palpate::messages {
namespace {

using testing::Random;
using testing::random_message;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The field named after one change to a valid random message; "" if it is still valid.
template <class Message, class Change>
std::string named(const Change& change) {
  Random random(21);
  Message message = random_message<Message>(random);
  REQUIRE(first_invalid_field(message) == nullptr);
  change(message);
  const char* field = first_invalid_field(message);
  return field == nullptr ? std::string() : field;
}

// Each value that is not finite must be refused in each place.
template <class Message, class Place>
void check_finite(const std::string& field, const Place& place) {
  for (const double bad : {kNan, kInfinity, -kInfinity, 1.1 * kMaxMagnitude, -1e308}) {
    CHECK(named<Message>([&](Message& m) { place(m) = bad; }) == field);
  }
}

template <class Message, class Place>
void check_finite_at_least_zero(const std::string& field, const Place& place) {
  check_finite<Message>(field, place);
  CHECK(named<Message>([&](Message& m) { place(m) = -1e-300; }) == field);
  CHECK(named<Message>([&](Message& m) { place(m) = 0; }).empty());
}

template <class Message, class Place>
void check_age(const std::string& field, const Place& place) {
  CHECK(named<Message>([&](Message& m) { place(m) = kNan; }) == field);
  CHECK(named<Message>([&](Message& m) { place(m) = -1; }) == field);
  CHECK(named<Message>([&](Message& m) { place(m) = kInfinity; }).empty());
}

template <class Message>
void check_corrupted() {
  CAPTURE(type_of<Message>().name);
  std::size_t place = 0;
  for (;; ++place) {
    Random random(23);
    auto message = random_message<Message>(random);
    testing::Corrupter corrupter(place);
    describe(corrupter, message);
    if (corrupter.corrupted() == nullptr) break;
    const char* field = first_invalid_field(message);
    CAPTURE(place, corrupter.corrupted());
    REQUIRE(field != nullptr);
    REQUIRE(std::string(field) == corrupter.corrupted());
  }
  CHECK(place >= 2);  // the header and a field of its own at least
}

template <class Message>
void check_header() {
  const auto sequence = [](std::uint64_t number) {
    return named<Message>([&](Message& m) { m.header.sequence = number; });
  };
  CHECK(sequence(0) == "sequence_number");
  CHECK(sequence(kMaxCount).empty());
  CHECK(sequence(kMaxCount + 1) == "sequence_number");
  CHECK(sequence(~0ull) == "sequence_number");
  CHECK(named<Message>([](Message& m) { m.header.sim_time_ns = -kMaxTimeNs; }).empty());
  CHECK(named<Message>([](Message& m) { m.header.sim_time_ns = -kMaxTimeNs - 1; }) ==
        "sim_time_ns");
  CHECK(named<Message>([](Message& m) { m.header.source_time_ns = kMaxTimeNs + 1; }) ==
        "source_time_ns");
  CHECK(named<Message>([](Message& m) { m.header.session_token = ~0ull; }).empty());
}

template <class Message, class Place>
void check_unit(const std::string& field, const Place& place) {
  CHECK(named<Message>([&](Message& m) { place(m) *= 1 + 2 * kUnitTolerance; }) == field);
  CHECK(named<Message>([&](Message& m) { place(m) *= 0; }) == field);
  CHECK(named<Message>([&](Message& m) { place(m) *= kNan; }) == field);
  CHECK(named<Message>([&](Message& m) { place(m) *= 1 + 0.5 * kUnitTolerance; }).empty());
}

template <class Message, class Place>
void check_text(const std::string& field, const Place& place) {
  CHECK(named<Message>([&](Message& m) { place(m).assign(kMaxTextBytes + 1, 'x'); }) == field);
  CHECK(named<Message>([&](Message& m) { place(m).assign(1, '\0'); }) == field);
  CHECK(named<Message>([&](Message& m) { place(m).assign(kMaxTextBytes, 'x'); }).empty());
}

template <class Message, class Place>
void check_name(const std::string& field, const Place& place) {
  CHECK(named<Message>([&](Message& m) { place(m).assign(kMaxNameBytes + 1, 'x'); }) == field);
  CHECK(named<Message>([&](Message& m) { place(m).clear(); }) == field);
  CHECK(named<Message>([&](Message& m) { place(m).assign(1, '\0'); }) == field);
  CHECK(named<Message>([&](Message& m) { place(m).assign(kMaxNameBytes, 'x'); }).empty());
}

}  // namespace

TEST_CASE("message checks: one corrupted field is named, whichever it is", "[messages]") {
  // Oracle: the field that was corrupted. What each rule allows is tested below, by hand.
#define PALPATE_CHECK(Message) check_corrupted<Message>();
  PALPATE_MESSAGES(PALPATE_CHECK)
#undef PALPATE_CHECK
}

TEST_CASE("message checks: a header counts from 1 and has no negative time", "[messages]") {
  // Oracle: the field rules of idl/README.md.
  check_header<ProbeState>();
  check_header<Contacts>();
  check_header<ContactModel>();
  check_header<NodePositions>();
  check_header<SurfaceTopology>();
  check_header<HapticForce>();
  check_header<ModuleStatus>();
  check_header<SceneDescription>();
  check_header<SessionControl>();
}

TEST_CASE("message checks: ProbeState", "[messages]") {
  // Oracle: the field rules of idl/README.md.
  using M = ProbeState;
  check_finite<M>("position_m", [](M& m) -> double& { return m.pose.position.y(); });
  check_finite<M>("linear_velocity_m_per_s", [](M& m) -> double& { return m.twist.linear.z(); });
  check_finite<M>("angular_velocity_rad_per_s",
                  [](M& m) -> double& { return m.twist.angular.x(); });
  check_unit<M>(
      "rotation_xyzw", [](M & m) -> auto& { return m.pose.rotation.coeffs(); });
}

TEST_CASE("message checks: Contacts", "[messages]") {
  // Oracle: the field rules of idl/README.md.
  using M = Contacts;
  check_finite<M>("probe_position_m", [](M& m) -> double& { return m.probe_pose.position.y(); });
  check_unit<M>(
      "probe_rotation_xyzw", [](M & m) -> auto& { return m.probe_pose.rotation.coeffs(); });
  CHECK(named<M>([](M& m) { m.contacts.resize(kMaxContactsPerProbe + 1, m.contacts[0]); }) ==
        "contacts");
  CHECK(named<M>([](M& m) { m.contacts.resize(kMaxContactsPerProbe, m.contacts[0]); }).empty());
  check_finite<M>("contacts.point_P_m",
                  [](M& m) -> double& { return m.contacts.back().point_P.y(); });
  check_finite<M>("contacts.gap_m", [](M& m) -> double& { return m.contacts.back().gap; });
  check_unit<M>(
      "contacts.normal_P", [](M & m) -> auto& { return m.contacts.back().normal_P; });
  for (const Vec3& bad : {Vec3(0.5, 0.6, -0.1), Vec3(0.5, 0.5, 0.1), Vec3(kNan, 0.5, 0.5)}) {
    CHECK(named<M>([&](M& m) { m.contacts.back().barycentric = bad; }) == "contacts.barycentric");
  }
}

TEST_CASE("message checks: ContactModel", "[messages]") {
  // Oracle: the field rules of idl/README.md.
  using M = ContactModel;
  check_finite<M>("anchor_position_m", [](M& m) -> double& { return m.anchor.position.x(); });
  check_unit<M>(
      "anchor_rotation_xyzw", [](M & m) -> auto& { return m.anchor.rotation.coeffs(); });
  check_finite_at_least_zero<M>("anchor_age_s", [](M& m) -> double& { return m.anchor_age; });
  check_finite_at_least_zero<M>("force_error", [](M& m) -> double& { return m.force_error; });
  check_finite_at_least_zero<M>("period_s", [](M& m) -> double& { return m.period; });
  check_finite<M>("growth_per_s", [](M& m) -> double& { return m.growth; });
  check_finite<M>("stiffness_n_per_m", [](M& m) -> double& { return m.stiffness(2, 1); });
  // Zero is allowed, but then the compliance is another's size.
  CHECK(named<M>([](M& m) { m.friction_coefficient = -0.1; }) == "friction_coefficient");
  check_finite_at_least_zero<M>("validity_radius_m",
                                [](M& m) -> double& { return m.validity_radius; });
  check_finite<M>("rows.point_P_m", [](M& m) -> double& { return m.rows[0].point_P.y(); });
  check_unit<M>(
      "rows.normal", [](M & m) -> auto& { return m.rows[0].normal; });
  check_finite_at_least_zero<M>("rows.gap_m", [](M& m) -> double& { return m.rows[0].gap; });
  check_finite_at_least_zero<M>("rows.radius_m", [](M& m) -> double& { return m.rows[0].radius; });
  check_finite<M>("rows.force_n", [](M& m) -> double& { return m.rows[0].force.z(); });
  check_finite<M>("rows.velocity_m_per_s", [](M& m) -> double& { return m.rows[0].velocity.x(); });
  check_finite<M>("compliance_m_per_n", [](M& m) -> double& { return m.compliance[0]; });
  CHECK(named<M>([](M& m) { m.rows.resize(kMaxLawRows + 1, m.rows[0]); }) == "rows");
  CHECK(named<M>([](M& m) { m.compliance.pop_back(); }) == "compliance_m_per_n");

  const auto with = [](const Mat3& stiffness) {
    return named<M>([&](M& m) { m.stiffness = stiffness; });
  };
  CHECK(with(Mat3::Zero()).empty());
  Mat3 asymmetric = Mat3::Identity();
  asymmetric(0, 1) = 1e-5;
  CHECK(with(asymmetric) == "stiffness_n_per_m");
}

TEST_CASE("message checks: NodePositions", "[messages]") {
  // Oracle: the field rules of idl/README.md.
  using M = NodePositions;
  check_finite<M>("volume_m3", [](M& m) -> double& { return m.volume; });
  check_finite<M>("pressure_pa", [](M& m) -> double& { return m.pressure; });
  check_finite_at_least_zero<M>("target_volume_m3",
                                [](M& m) -> double& { return m.target_volume; });
  check_finite_at_least_zero<M>("kinetic_energy_j",
                                [](M& m) -> double& { return m.kinetic_energy; });
  check_finite_at_least_zero<M>("elastic_energy_j",
                                [](M& m) -> double& { return m.elastic_energy; });
  CHECK(named<M>([](M& m) { m.positions.clear(); }) == "positions_m");
  CHECK(named<M>([](M& m) { m.positions.resize(4); }) == "positions_m");
  CHECK(named<M>([](M& m) { m.positions.resize(3 * kMaxNodes + 3); }) == "positions_m");
  CHECK(named<M>([](M& m) { m.positions.resize(3 * kMaxNodes); }).empty());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto of_box = [&](float lower, float upper) {
      return named<M>([&](M& m) {
        m.block_boxes = {0, 0, 0, 1, 1, 1, 0, 0, 0, 1, 1, 1};
        m.block_boxes[6 + axis] = lower;
        m.block_boxes[9 + axis] = upper;
      });
    };
    CHECK(of_box(2, 1) == "block_boxes_m");
    CHECK(of_box(2, 2).empty());
  }
  // One value that is not finite, or too large, is found anywhere, however the loop is vectorized.
  Random random(22);
  for (std::size_t place = 0; place < 3 * 20; ++place) {
    M m = random_message<M>(random);
    m.positions.assign(3 * 20, 0.999f * float{kMaxMagnitude});
    REQUIRE(first_invalid_field(m) == nullptr);
    m.positions[place] =
        std::array{std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(),
                   -1.001f * float{kMaxMagnitude}}[place % 3];
    CHECK(first_invalid_field(m) != nullptr);
  }
}

TEST_CASE("message checks: SurfaceTopology", "[messages]") {
  // Oracle: the field rules of idl/README.md.
  using M = SurfaceTopology;
  const auto nodes = [](const M& m) {
    return static_cast<std::uint32_t>(m.rest_positions.size() / 3);
  };
  check_text<M>(
      "name", [](M & m) -> auto& { return m.name; });
  CHECK(named<M>([](M& m) { m.rest_positions.pop_back(); }) == "rest_positions_m");
  CHECK(named<M>([](M& m) { m.rest_positions[1] = static_cast<float>(kNan); }) ==
        "rest_positions_m");
  CHECK(named<M>([&](M& m) { m.surface_node_count = nodes(m) + 1; }) == "surface_node_count");
  CHECK(named<M>([](M& m) { m.triangles = {{0, 1, 1}}; }) == "triangle_nodes");
  CHECK(named<M>([](M& m) { m.triangles = {{0, 1, m.surface_node_count}}; }) == "triangle_nodes");
  CHECK(named<M>([](M& m) {
          m.triangles.resize(kMaxTriangles + 1, {0, 1, 2});
        }) == "triangle_nodes");
  CHECK(named<M>([](M& m) { m.triangle_blocks.push_back(0); }) == "triangle_blocks");
  for (const std::vector<std::uint32_t>& blocks :
       {std::vector<std::uint32_t>{0, 2}, {1, 1}, {0, 4'000'000'000}}) {
    CHECK(named<M>([&](M& m) {
            m.triangles = {{0, 1, 2}, {0, 2, 1}};
            m.triangle_blocks = blocks;
          }) == "triangle_blocks");
  }
  CHECK(named<M>([&](M& m) { m.fixed_nodes = {nodes(m)}; }) == "fixed_nodes");
  CHECK(named<M>([&](M& m) { m.fixed_nodes.assign(nodes(m) + 1, 0); }) == "fixed_nodes");
  CHECK(named<M>([](M& m) { m.springs = {{1, 1, SpringFamily::kInner}}; }) == "spring_nodes");
  CHECK(named<M>([&](M& m) {
          m.springs = {{0, nodes(m), SpringFamily::kInner}};
        }) == "spring_nodes");
  CHECK(named<M>([](M& m) {
          m.springs.resize(kMaxSprings + 1, {0, 1, SpringFamily::kInner});
        }) == "spring_nodes");
  CHECK(named<M>([](M& m) {
          m.springs = {{0, 1, static_cast<SpringFamily>(3)}};
        }) == "spring_families");
}

TEST_CASE("message checks: HapticForce", "[messages]") {
  // Oracle: the field rules of idl/README.md.
  using M = HapticForce;
  check_finite<M>("force_n", [](M& m) -> double& { return m.force.x(); });
  check_finite<M>("torque_n_m", [](M& m) -> double& { return m.torque.y(); });
  check_finite<M>("passivity_energy_j", [](M& m) -> double& { return m.passivity_energy; });
  check_age<M>("contact_model_age_s", [](M& m) -> double& { return m.contact_model_age; });
  CHECK(named<M>([](M& m) { m.limits = kAllForceLimits + 1; }) == "limits");
  CHECK(named<M>([](M& m) { m.limits = kAllForceLimits; }).empty());
}

TEST_CASE("message checks: ModuleStatus", "[messages]") {
  // Oracle: the field rules of idl/README.md.
  using M = ModuleStatus;
  check_name<M>(
      "module_name", [](M & m) -> auto& { return m.module; });
  CHECK(named<M>([](M& m) { m.state = static_cast<ModuleState>(7); }) == "state");
  check_finite_at_least_zero<M>("rate_hz", [](M& m) -> double& { return m.rate_hz; });
  check_finite_at_least_zero<M>("nominal_rate_hz",
                                [](M& m) -> double& { return m.nominal_rate_hz; });
  check_finite_at_least_zero<M>("worst_lateness_s",
                                [](M& m) -> double& { return m.worst_lateness; });
  check_finite_at_least_zero<M>("busy_fraction", [](M& m) -> double& { return m.busy_fraction; });
  check_finite_at_least_zero<M>("real_time_factor",
                                [](M& m) -> double& { return m.real_time_factor; });
  check_text<M>(
      "last_error", [](M & m) -> auto& { return m.last_error; });
  CHECK(named<M>([](M& m) { m.inputs.resize(kMaxInputs + 1, {"topic", 0, 0, 0, 0}); }) == "inputs");
  const auto input = [](M & m) -> auto& {
    m.inputs.resize(1, {"topic", 0, 0, 0, 0});
    return m.inputs[0];
  };
  check_name<M>(
      "inputs.topic", [&](M & m) -> auto& { return input(m).topic; });
  check_age<M>("inputs.age_s", [&](M& m) -> double& { return input(m).age; });
  CHECK(named<M>([](M& m) { m.organs.resize(kMaxOrgans + 1); }) == "organs");
  CHECK(named<M>([](M& m) { m.probes.resize(kMaxProbes + 1); }) == "probes");
  const auto organ = [](M & m) -> auto& { return m.organs.emplace_back(); };
  const auto probe = [](M & m) -> auto& { return m.probes.emplace_back(); };
  // An organ turned inside out has a negative volume, and its process goes on saying so.
  check_finite<M>("organs.volume_ratio", [&](M& m) -> double& { return organ(m).volume_ratio; });
  CHECK(named<M>([&](M& m) { organ(m).volume_ratio = -0.5; }).empty());
  check_finite_at_least_zero<M>("organs.worst_volume_error",
                                [&](M& m) -> double& { return organ(m).worst_volume_error; });
  CHECK(named<M>([&](M& m) { organ(m).lowest_pressure = kNan; }) == "organs.lowest_pressure_pa");
  CHECK(named<M>([&](M& m) { organ(m).highest_pressure = kInfinity; }) ==
        "organs.highest_pressure_pa");
  check_finite_at_least_zero<M>("probes.force_n", [&](M& m) -> double& { return probe(m).force; });
  check_finite_at_least_zero<M>("probes.greatest_force_n",
                                [&](M& m) -> double& { return probe(m).greatest_force; });
  check_finite_at_least_zero<M>("probes.error_of_greatest",
                                [&](M& m) -> double& { return probe(m).error_of_greatest; });
  CHECK(named<M>([&](M& m) { probe(m).limits = kAllForceLimits + 1; }) == "probes.limits");
}

TEST_CASE("message checks: SceneDescription and SessionControl", "[messages]") {
  // Oracle: the field rules of idl/README.md.
  check_text<SceneDescription>(
      "name", [](SceneDescription & m) -> auto& { return m.name; });
  check_text<SceneDescription>(
      "digest", [](SceneDescription & m) -> auto& { return m.digest; });
  check_text<SceneDescription>(
      "resolved_text", [](SceneDescription & m) -> auto& { return m.resolved_text; });
  CHECK(named<SessionControl>(
            [](SessionControl& m) { m.command = static_cast<SessionCommand>(5); }) == "command");
}

}  // namespace palpate::messages
