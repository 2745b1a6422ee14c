#include "modules/recording/csv_columns.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <ostream>

#include "modules/core/units.h"

namespace palpate::recording {
namespace {

// Appends values with commas between them.
class Row {
 public:
  explicit Row(std::ostream& stream) : stream_(stream) {}
  Row& operator<<(double value) {
    write_number(separated(), value);
    return *this;
  }
  Row& operator<<(const Vec3& v) { return *this << v.x() << v.y() << v.z(); }
  Row& operator<<(const std::string& text) {
    separated() << csv_text(text);
    return *this;
  }
  Row& operator<<(std::uint64_t value) {
    separated() << value;
    return *this;
  }
  Row& operator<<(std::uint32_t value) { return *this << std::uint64_t{value}; }
  Row& operator<<(bool value) { return *this << std::uint64_t{value}; }

 private:
  std::ostream& separated() {
    if (!first_) stream_ << ',';
    first_ = false;
    return stream_;
  }
  std::ostream& stream_;
  bool first_ = true;
};

const char* columns(const ProbeState&) {
  return "x_m,y_m,z_m,qx,qy,qz,qw,linear_velocity_x_m_per_s,linear_velocity_y_m_per_s,"
         "linear_velocity_z_m_per_s,angular_velocity_x_rad_per_s,angular_velocity_y_rad_per_s,"
         "angular_velocity_z_rad_per_s,buttons";
}
void write(Row& row, const ProbeState& m) {
  const Quat& q = m.pose.rotation;
  row << m.pose.position << q.x() << q.y() << q.z() << q.w() << m.twist.linear << m.twist.angular
      << m.buttons;
}

const char* columns(const Contacts&) {
  return "contact_count,deepest_gap_m,truncated,node_positions_sequence";
}
void write(Row& row, const Contacts& m) {
  double deepest = std::numeric_limits<double>::infinity();
  for (const Contact& contact : m.contacts) deepest = std::min(deepest, contact.gap);
  row << std::uint64_t{m.contacts.size()} << deepest << m.truncated << m.node_positions_sequence;
}

const char* columns(const ContactModel&) {
  return "touching,anchor_x_m,anchor_y_m,anchor_z_m,force_x_n,force_y_n,force_z_n,torque_x_n_m,"
         "torque_y_n_m,torque_z_n_m,stiffness_xx_n_per_m,stiffness_yy_n_per_m,"
         "stiffness_zz_n_per_m,normal_x,normal_y,normal_z,friction_coefficient,validity_radius_m";
}
void write(Row& row, const ContactModel& m) {
  row << m.touching << m.anchor << m.force << m.torque << Vec3(m.stiffness.diagonal()) << m.normal
      << m.friction_coefficient << m.validity_radius;
}

const char* columns(const NodePositions&) {
  return "generation,node_count,volume_m3,target_volume_m3,pressure_pa,kinetic_energy_j,"
         "elastic_energy_j";
}
void write(Row& row, const NodePositions& m) {
  row << m.generation << std::uint64_t{m.positions.size() / 3} << m.volume << m.target_volume
      << m.pressure << m.kinetic_energy << m.elastic_energy;
}

const char* columns(const SurfaceTopology&) {
  return "generation,name,surface_node_count,node_count,triangle_count,spring_count";
}
void write(Row& row, const SurfaceTopology& m) {
  row << m.generation << m.name << m.surface_node_count
      << std::uint64_t{m.rest_positions.size() / 3} << std::uint64_t{m.triangles.size()}
      << std::uint64_t{m.springs.size()};
}

const char* columns(const HapticForce&) {
  return "force_x_n,force_y_n,force_z_n,torque_x_n_m,torque_y_n_m,torque_z_n_m,limits,"
         "passivity_energy_j,contact_model_age_s";
}
void write(Row& row, const HapticForce& m) {
  row << m.force << m.torque << m.limits << m.passivity_energy << m.contact_model_age;
}

const char* columns(const ModuleStatus&) {
  return "state,rate_hz,nominal_rate_hz,cycles,overruns,worst_lateness_s,busy_fraction,"
         "real_time_factor,realtime_priority,last_error";
}
void write(Row& row, const ModuleStatus& m) {
  row << std::string(name_of(m.state)) << m.rate_hz << m.nominal_rate_hz << m.cycles << m.overruns
      << m.worst_lateness << m.busy_fraction << m.real_time_factor << m.realtime_priority
      << m.last_error;
}

const char* columns(const SceneDescription&) { return "protocol_version,name,digest"; }
void write(Row& row, const SceneDescription& m) { row << m.protocol_version << m.name << m.digest; }

const char* columns(const SessionControl&) { return "command,reset_count,start_time_s"; }
void write(Row& row, const SessionControl& m) {
  constexpr std::array kNames{"start", "pause", "reset", "stop"};
  const auto command = static_cast<std::size_t>(m.command);
  row << std::string(command < kNames.size() ? kNames[command] : "unknown") << m.reset_count
      << 1e-9 * static_cast<double>(m.start_time_ns);
}

std::string key(const ProbeState& m) { return std::to_string(m.probe); }
std::string key(const Contacts& m) { return std::to_string(m.probe); }
std::string key(const ContactModel& m) { return std::to_string(m.probe); }
std::string key(const HapticForce& m) { return std::to_string(m.probe); }
std::string key(const NodePositions& m) { return std::to_string(m.organ); }
std::string key(const SurfaceTopology& m) { return std::to_string(m.organ); }
std::string key(const ModuleStatus& m) { return m.module; }
std::string key(const SceneDescription&) { return {}; }
std::string key(const SessionControl&) { return {}; }

}  // namespace

void write_number(std::ostream& stream, double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value);
  stream.write(text.data(), end.ptr - text.data());
}

void write_seconds(std::ostream& stream, std::int64_t ns) {
  write_number(stream, static_cast<double>(ns) / kNanosecondsPerSecond);  // 1e-9 is not exact
}

std::string csv_text(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char letter : text) {
    if (letter == '"') quoted += '"';
    quoted += letter;
  }
  return quoted + '"';
}

std::string key_of(const AnyMessage& message) {
  return std::visit([](const auto& m) { return key(m); }, message);
}

const Header& header_of(const AnyMessage& message) {
  return std::visit([](const auto& m) -> const Header& { return m.header; }, message);
}

const char* csv_columns(const AnyMessage& message) {
  return std::visit([](const auto& m) { return columns(m); }, message);
}

void write_csv_values(std::ostream& stream, const AnyMessage& message) {
  Row row(stream);
  std::visit([&row](const auto& m) { write(row, m); }, message);
}

const char* name_of(ModuleState state) {
  constexpr std::array kNames{"starting", "ready", "running", "paused",
                              "degraded", "fault", "stopped"};
  const auto index = static_cast<std::size_t>(state);
  return index < kNames.size() ? kNames[index] : "unknown";
}

}  // namespace palpate::recording
