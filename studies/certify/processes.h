// The real processes over loopback DDS, and in this one the driver that palpate-emulated-device is.
#pragma once

#include <algorithm>
#include <map>
#include <memory>

#include "modules/bus/bus.h"
#include "palpate/child_process.h"
#include "palpate/device/emulated_driver.h"
#include "palpate/session_tally.h"
#include "studies/certify/loop.h"

namespace palpate::certify {

/// What a session says, as far as a driver can hear it.
struct Heard {
  HapticForce force;                            ///< the newest
  std::map<std::string, ModuleStatus> modules;  ///< the newest of each
  std::int64_t last_pushed_ns = 0;              ///< source time of the last force that was not zero
  std::int64_t last_driven_ns = 0;              ///< of the last pose that the driver wrote
  std::int64_t last_law_ns = 0;                 ///< of the last contact_model, here or in haptics
  std::int64_t last_contacts_ns = 0;
  std::int64_t last_motor_ns = 0;  ///< when the device's motors were last not at zero
  double largest_step = 0;         ///< of the force per tick, since it was set to 0 [N]
  // While `timing`:
  bool timing = false;
  std::vector<double> periods;    ///< between two ticks of haptics that follow each other [s]
  std::vector<double> latencies;  ///< from a pose written to the force of its tick heard [s]
  std::vector<Tick> held;         ///< time and depth of the body, since a hand took the device

  void hear_law(std::int64_t source_ns) { last_law_ns = std::max(last_law_ns, source_ns); }
};

/// What else runs on the machine.
enum class Beside {
  kNothing,
  kPicturesAndHog  ///< the visualizer, without a window, and a program that takes what it gets
};

class Processes {
 public:
  /// Starts deformation, collision and haptics on the subject's scene, whose probe becomes a
  /// `topic`, written to `folder`. What they say is dropped.
  /// @throws std::runtime_error if one cannot be started
  Processes(const Subject& subject, const bus::BusOptions& bus, const std::filesystem::path& folder,
            KeepGoing keep_going, Beside beside = Beside::kNothing);
  ~Processes();

  /// Waits until all are ready and starts the session. False after a minute.
  bool start();

  /// A hand takes the device, which is where it says at once; before, it waits above the place.
  void hold(const scene::EmulatedDevice& hand);

  /// Drives and listens, a millisecond at a time, until the condition holds; false after `longest`
  /// [s].
  bool wait(const std::function<bool(const Heard&)>& condition, double longest);

  void kill(const std::string& module);
  void start_again(const std::string& module);
  void drive(bool on);
  void command(SessionCommand wanted);
  /// That the session plays another scene than this one: it is at fault. "": the true one again.
  void tell_scene(const std::string& another);

  Heard& heard() { return heard_; }
  /// Of all modules as they said last, those that were killed too.
  ContactTroubles contact_troubles() const { return tally_.contact_troubles(); }

 private:
  struct Bus;
  void start_module(const std::string& module, std::vector<std::string> more = {});
  void tick();
  void drive_device(std::int64_t now_ns);
  void listen(std::int64_t now_ns);
  void hear(const HapticForce& force, std::int64_t now_ns);

  const Subject& subject_;
  bus::BusOptions options_;
  KeepGoing keep_going_;
  scene::Scene scene_;
  std::filesystem::path file_;
  std::map<std::string, std::unique_ptr<launcher::ChildProcess>> children_;
  std::unique_ptr<Bus> bus_;  // after the children: they are born from a program of one thread
  std::unique_ptr<launcher::EmulatedDriver> driver_;
  bool driving_ = true;
  std::int64_t next_ns_ = 0, began_ns_ = 0;  ///< began 0: the hand has not taken the device
  std::uint32_t count_ = 0, answered_ = 0;   ///< poses written, and the newest that was answered
  std::vector<std::int64_t> written_ns_;     ///< by count, a ring
  Heard heard_;
  launcher::SessionTally tally_;
};

}  // namespace palpate::certify
