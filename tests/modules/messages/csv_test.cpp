#include "modules/messages/csv.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <limits>
#include <sstream>

#include "modules/messages/describe.h"

namespace palpate::messages {
namespace {

std::string number(double value) {
  std::ostringstream stream;
  write_number(stream, value);
  return stream.str();
}

std::string values_of(const AnyMessage& message) {
  std::ostringstream stream;
  write_csv_values(stream, message);
  return stream.str();
}

long columns_in(const std::string& row) { return 1 + std::count(row.begin(), row.end(), ','); }

}  // namespace

TEST_CASE("csv: numbers are as short as they can be and read back the same") {
  // Oracle: round trip through the C library; texts by hand.
  CHECK(number(0.1) == "0.1");
  CHECK(number(-2) == "-2");
  CHECK(number(std::numeric_limits<double>::infinity()) == "inf");
  CHECK(number(std::numeric_limits<double>::quiet_NaN()) == "nan");
  for (const double value : {1.0 / 3, 1e-300, 6.02214076e23, -7.0 / 11}) {
    CHECK(std::stod(number(value)) == value);
  }
}

TEST_CASE("csv: times keep their nanoseconds") {
  // Oracle: decimal shifts by hand; ten days and one nanosecond.
  const auto seconds = [](std::int64_t ns) {
    std::ostringstream stream;
    write_seconds(stream, ns);
    return stream.str();
  };
  CHECK(seconds(44'250'000) == "0.04425");
  CHECK(seconds(-1) == "-1e-09");
  CHECK(seconds(864'000'000'000'001) == "864000.000000001");
}

TEST_CASE("csv: texts are quoted where they need to be") {
  // Oracle: RFC 4180.
  CHECK(csv_text("plain") == "plain");
  CHECK(csv_text("a,b") == "\"a,b\"");
  CHECK(csv_text("say \"ah\"") == "\"say \"\"ah\"\"\"");
  CHECK(csv_text("two\nlines") == "\"two\nlines\"");
}

TEST_CASE("csv: every kind of message has as many values as columns") {
  // Oracle: invariant of a table.
  const AnyMessage messages[] = {ProbeState{},    Contacts{},         ContactModel{},
                                 NodePositions{}, SurfaceTopology{},  HapticForce{},
                                 ModuleStatus{},  SceneDescription{}, SessionControl{}};
  for (const AnyMessage& message : messages) {
    CAPTURE(csv_columns(message));
    CHECK(columns_in(csv_columns(message)) == columns_in(values_of(message)));
  }
}

TEST_CASE("csv: values stand under their names") {
  // Oracle: rows written by hand.
  NodePositions nodes;
  nodes.generation = 2;
  nodes.positions.resize(9);
  nodes.volume = 0.5;
  nodes.target_volume = 0.25;
  nodes.pressure = -3;
  nodes.kinetic_energy = 4;
  nodes.elastic_energy = 5;
  nodes.organ_contacts = 6;
  CHECK(csv_columns(nodes) ==
        "generation,volume_m3,target_volume_m3,pressure_pa,kinetic_energy_j,elastic_energy_j,"
        "organ_contacts,node_count");
  CHECK(values_of(nodes) == "2,0.5,0.25,-3,4,5,6,3");

  HapticForce force;
  force.force = {1, 2, 3};
  force.torque = {4, 5, 6};
  force.limits = 9;
  force.passivity_energy = -7;
  force.contact_model_age = 0.125;
  CHECK(csv_columns(force) ==
        "force_x_n,force_y_n,force_z_n,torque_x_n_m,torque_y_n_m,torque_z_n_m,limits,"
        "passivity_energy_j,contact_model_age_s");
  CHECK(values_of(force) == "1,2,3,4,5,6,9,-7,0.125");

  Contacts contacts;
  contacts.contacts.resize(2);
  contacts.contacts[1].gap = -0.5;
  contacts.generations = {8, 9, 9};
  CHECK(csv_columns(contacts) ==
        "probe_position_x_m,probe_position_y_m,probe_position_z_m,probe_rotation_x,"
        "probe_rotation_y,probe_rotation_z,probe_rotation_w,organ_count,truncated,"
        "face_count,face_node_count,contact_count,deepest_gap_m");
  CHECK(values_of(contacts) == "0,0,0,0,0,0,1,3,0,0,0,2,-0.5");

  ModuleStatus status;
  status.state = ModuleState::kDegraded;
  status.process_id = -4;
  status.rate_hz = 250;
  status.last_error = "late, very";
  CHECK(csv_columns(status).starts_with("state,process_id,rate_hz,nominal_rate_hz,cycles,"));
  CHECK(values_of(status) == "degraded,-4,250,0,0,0,0,0,0,0,0,0,0,0,\"late, very\"");

  const ModuleStatus::Input input{"contacts", 0.5, 0.25, 1, 2, 3};
  std::ostringstream row;
  write_csv_values(row, input);
  CHECK(csv_columns(input) == "topic,age_s,age_error_s,received,dropped,rejected");
  CHECK(row.str() == "contacts,0.5,0.25,1,2,3");
}

TEST_CASE("csv: parts of a vector are named before its unit") {
  // Oracle: names by hand; stiffness has nine parts.
  CHECK(name_of_part("position_m", "x") == "position_x_m");
  CHECK(name_of_part("linear_velocity_m_per_s", "y") == "linear_velocity_y_m_per_s");
  CHECK(name_of_part("torque_n_m", "z") == "torque_z_n_m");
  CHECK(name_of_part("rotation_xyzw", "w") == "rotation_w");
  CHECK(name_of_part("normal", "x") == "normal_x");
  const std::string columns = csv_columns(ContactModel{});
  CHECK(columns.find("stiffness_xx_n_per_m,stiffness_xy_n_per_m,") != std::string::npos);
}

TEST_CASE("csv: keys are those of the wire types") {
  // Oracle: the @key fields in idl/.
  ProbeState probe;
  probe.probe = 3;
  SurfaceTopology surface;
  surface.organ = 1;
  ModuleStatus status;
  status.module = "haptics";
  CHECK(key_text(probe) == "3");
  CHECK(key_text(surface) == "1");
  CHECK(key_text(status) == "haptics");
  CHECK(key_text(SceneDescription{}).empty());
}

TEST_CASE("csv: every state of a module has a name") {
  // Oracle: idl/ModuleStatus.idl.
  CHECK(word_of(ModuleState::kStarting) == std::string("starting"));
  CHECK(word_of(ModuleState::kStopped) == std::string("stopped"));
  CHECK(word_of(static_cast<ModuleState>(7)) == std::string("unknown"));
}

}  // namespace palpate::messages
