// Options common to all modules' command lines, and the frame around a module's run function.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "modules/bus/bus.h"
#include "modules/runtime/program.h"

namespace palpate::runtime {

struct ModuleOptions {
  std::filesystem::path scene;    ///< SCENE
  bus::BusOptions bus;            ///< --session, --domain (or PALPATE_DOMAIN)
  bool realtime = true;           ///< --no-realtime
  std::optional<int> kept_state;  ///< --kept-state: of a KeptMemory, inherited; none: keeps nothing
  bool joins = false;             ///< --joins: the session may run already, in real time
  /// --lockstep: the modules of a lockstep session, this one included; empty: real time.
  std::vector<std::string> lockstep;
  std::filesystem::path from_snapshot;  ///< --from-snapshot: lockstep goes on there; empty: from 0
  std::optional<double> snapshot_at;    ///< --snapshot-at [s], lockstep: when to write …
  std::filesystem::path snapshot;       ///< --snapshot: … its part of one, a snapshot of itself
};

/// What --help of a module says last.
inline constexpr const char* kModuleExitCodes =
    "Exit code: 0 if its session ended or it was stopped, 1 if something failed, 2 for bad input, "
    "130 if it was stopped while an organ was filled.";

struct ModuleProgram {
  std::string name;     ///< "haptics"; the program is palpate-haptics
  std::string purpose;  ///< one sentence for --help
  /// Options beyond the common ones; may be empty.
  std::function<void(Options&)> add_options;
};

/// Adds --lockstep with its check of names, and what is of lockstep alone and refused without.
/// @return --lockstep
Option add_lockstep_options(Options& options, ModuleOptions& module);

/// Adds --session and --domain with their checks. PALPATE_DOMAIN is the default of --domain.
/// @return --session
Option add_bus_options(Options& options, bus::BusOptions& bus);

/// What a module says goes to stderr: "[haptics] warning: …".
void start_log(const std::string& name);

/// The whole of a module's main: parses, starts the log, runs, and reports what is thrown in one
/// line.
/// @return kExitDone, kExitStopped while an organ was filled, kExitBadInput for an InputError or a
/// wrong command line, else kExitFailed
int run_module(int argc, char** argv, const ModuleProgram& program,
               const std::function<void(const ModuleOptions&)>& run);

}  // namespace palpate::runtime
