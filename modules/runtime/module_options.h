// Options common to all modules' command lines, and the frame around a module's run function.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "modules/bus/bus.h"
#include "modules/runtime/program.h"

namespace palpate::runtime {

struct ModuleOptions {
  std::filesystem::path scene;  ///< SCENE
  bus::BusOptions bus;          ///< --session, --domain (or PALPATE_DOMAIN)
  bool realtime = true;         ///< --no-realtime
  /// --lockstep: the modules of a lockstep session, this one included; empty: real time.
  std::vector<std::string> lockstep;
};

struct ModuleProgram {
  std::string name;     ///< "haptics"; the program is palpate-haptics
  std::string purpose;  ///< one sentence for --help
  /// Options beyond the common ones; may be empty.
  std::function<void(Options&)> add_options;
};

/// Adds --lockstep with its check of names.
void add_lockstep_option(Options& options, std::vector<std::string>& participants);

/// Adds --session and --domain with their checks. PALPATE_DOMAIN is the default of --domain.
void add_bus_options(Options& options, bus::BusOptions& bus);

/// The whole of a module's main: parses, starts the log on stderr ("[haptics] warning: …"), runs,
/// and reports what is thrown in one line.
/// @return kExitDone, kExitBadInput for an InputError or a wrong command line, else kExitFailed
int run_module(int argc, char** argv, const ModuleProgram& program,
               const std::function<void(const ModuleOptions&)>& run);

}  // namespace palpate::runtime
