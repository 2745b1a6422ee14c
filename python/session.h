// A session in this process, as Python drives it.
#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "modules/runtime/worker_team.h"
#include "modules/scene/scene.h"
#include "palpate/session/in_process.h"
#include "python/guided_device.h"

namespace palpate::python {

/// The session that `palpate run --in-process` runs, same bits. One thread at a time; another's
/// call meanwhile gets a BusyError. While it steps, other Python threads run, and Ctrl-C is looked
/// for.
class Session {
 public:
  /// Every topic that carries physics is recorded to `record`, unless it is empty. Goes on from the
  /// snapshot of that name, unless it is empty.
  /// @throws InputError as session::InProcess and runtime::read_snapshot() do
  Session(const scene::Scene& scene, const std::string& record, const std::string& from_snapshot);

  double time() const { return time_; }  ///< when the next cycle begins [s]; any thread may ask
  /// All cycles that begin before `time` [s].
  void run_until(double time);
  /// Deformation's periods.
  void step(std::size_t periods);
  /// Until no node of any organ was faster than `speed` [m/s] for `still` [s]; false if that did
  /// not come before `time` [s].
  bool settle(double speed, double still, double time);
  /// The same as run_until(); what is said of these topics meanwhile, (topic, columns, messages).
  pybind11::list run_keeping(double time, const std::vector<std::string>& topics);
  /// Of now, as `palpate run --snapshot-at`. @return its time [s]
  /// @throws InputError as runtime::check_snapshot_name() does
  double save_snapshot(const std::string& file, bool overwrite);
  void close();
  bool closed() const { return closed_; }

  void guide_probe(std::size_t probe, const Pose& pose, const Twist& twist);
  void ask_for_volume(std::size_t organ, double ratio);
  /// The newest message of a topic with such messages, of a key.
  pybind11::dict newest(const std::string& topic, std::size_t key);
  std::vector<std::string> guards();  ///< that act, "module: which"

  const scene::Scene& scene() const { return scene_; }
  double period() const { return period_; }  ///< of deformation [s]

 private:
  using Listener = std::function<void()>;
  session::InProcess& open() const;
  void guide_as_in(const runtime::Snapshot& snapshot, haptics::HapticsStage& haptics);
  void check_probe(std::size_t probe) const;
  void check_organ(std::size_t organ) const;
  void check_time(double time) const;
  void run_while(const std::function<bool()>& wanted, const Listener& listen);

  const scene::Scene scene_;
  double period_;
  std::atomic_flag in_use_;
  std::atomic<double> time_{0};
  std::atomic<bool> closed_{false};
  double asked_for_ = 0;  ///< the latest time [s]
  std::unique_ptr<runtime::WorkerTeam> team_;
  std::unique_ptr<session::InProcess> session_;
  std::optional<bus::Writer<SceneDescription>> scenes_;
  std::vector<GuidedDevice*> guided_;  ///< by probe; nullptr: as the scene says
};

}  // namespace palpate::python
