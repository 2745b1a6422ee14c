// What is counted and kept of a session while it runs, for the status line and the summary. Pure.
#pragma once

#include <map>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "modules/bus/sequence_gaps.h"
#include "modules/messages/messages.h"
#include "modules/scene/scene.h"

namespace palpate::launcher {

// What processes have said of each, put together over those that came after one another.
struct OrganTally : OrganExtremes {
  std::string name;
};

struct ProbeTally : ProbeExtremes {
  std::string name;
};

struct ModuleTally {
  ModuleStatus newest;
  std::uint64_t cycles_before = 0, overruns_before = 0;  ///< before the session started

  std::uint64_t cycles() const { return newest.cycles - cycles_before; }
  std::uint64_t overruns() const { return newest.overruns - overruns_before; }
  /// Periods that had their cycle since the start, of all [0 … 1].
  double on_time_fraction() const;
};

class SessionTally {
 public:
  explicit SessionTally(const scene::Scene& scene);

  /// What comes from now on counts for the sums.
  void start();

  /// While a session stands, whoever waits for news calls it old: that is no trouble.
  void stands(bool standing) { standing_ = standing; }

  /// @param writer  of the process: numbers of processes are those of its host
  void receive(const ModuleStatus& status, const bus::WriterId& writer = {});
  void receive(std::span<const OrganExtremes> organs);
  void receive(std::span<const ProbeExtremes> probes);

  const std::vector<OrganTally>& organs() const { return organs_; }
  const std::vector<ProbeTally>& probes() const { return probes_; }
  const std::map<std::string, ModuleTally>& modules() const { return modules_; }
  /// Of all modules, those that ended too, and of a session in one process.
  ContactTroubles contact_troubles() const;
  void receive(const ContactTroubles& of_session) { of_session_ = of_session; }

  /// That a module said this while it was degraded; nothing: it was not.
  void note_degraded(const std::string& module, const std::string& said);
  /// "module: what its status said while degraded", each once, in the order of its first time.
  const std::vector<std::string>& troubles() const { return troubles_; }
  /// nullptr if nothing was heard of it.
  const ModuleTally* module(const std::string& name) const;
  /// Of the slowest deformation process; 0 before the first.
  double real_time_factor() const;

 private:
  bool started_ = false, standing_ = false;
  std::vector<OrganTally> organs_;
  std::vector<ProbeTally> probes_;
  std::map<std::string, ModuleTally> modules_;
  std::vector<std::string> troubles_;
  /// Newest of each, those that ended too: by module, process_id and writer.
  std::map<std::tuple<std::string, std::int64_t, bus::WriterId>, ContactTroubles> of_processes_;
  ContactTroubles of_session_;
};

}  // namespace palpate::launcher
