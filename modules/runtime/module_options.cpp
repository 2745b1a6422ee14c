#include "modules/runtime/module_options.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "modules/core/error.h"
#include "modules/core/standard_streams.h"
#include "modules/runtime/wiring.h"
#include "modules/scene/processes.h"

namespace palpate::runtime {
void start_log(const std::string& name) {
  auto logger =
      std::make_shared<spdlog::logger>(name, std::make_shared<spdlog::sinks::stderr_sink_mt>());
  logger->set_pattern("[%n] %l: %v");
  logger->flush_on(spdlog::level::trace);
  spdlog::set_default_logger(logger);
}

Option add_bus_options(Options& options, bus::BusOptions& bus) {
  const Option session =
      options.add("--session", bus.session, "Name that keeps simultaneous sessions apart")
          .shows_default();
  options.add("--domain", bus.domain, "DDS domain id, 0 to 200")
      .environment("PALPATE_DOMAIN")
      .range(0, 200)
      .shows_default();
  return session;
}

Option add_lockstep_options(Options& options, ModuleOptions& module) {
  std::vector<std::string> names(kModules.begin(), kModules.end());
  for (std::size_t process = 2; process <= scene::kMaxProcesses; ++process) {
    names.push_back(name_of({"deformation", process}));
  }
  Option lockstep =
      options
          .add("--lockstep", module.lockstep,
               "Modules of a lockstep session, this one included: cycles wait for their inputs, "
               "no clock is read (palpate run --lockstep)")
          .one_of(names);
  options.add_input("--from-snapshot", module.from_snapshot, "In lockstep: goes on from there")
      .needs(lockstep);
  Option at =
      options
          .add("--snapshot-at", module.snapshot_at, "In lockstep: when --snapshot is written [s]")
          .range(1e-6, 1e6)
          .needs(lockstep);
  const Option snapshot =
      options.add_output("--snapshot", module.snapshot, "Its own part of a snapshot").needs(at);
  at.needs(snapshot);
  return lockstep;
}

int run_module(int argc, char** argv, const ModuleProgram& program,
               const std::function<void(const ModuleOptions&)>& run) {
  start_log(program.name);
  ModuleOptions options;
  Program command(program.purpose, "palpate-" + program.name);
  command.report_to([](const std::string& what) { spdlog::error("{}", what); });
  command.add_input("SCENE", options.scene, "Scene file (YAML)").required();
  add_bus_options(command, options.bus);
  command.flag_off("--no-realtime", options.realtime, "Do not ask for real-time priority");
  command
      .add("--kept-state", options.kept_state,
           "Open descriptor of where it keeps what it remembers for a successor, and goes on from "
           "what is kept there (palpate run gives it)")
      .range(0, 1e6);
  command.flag("--joins", options.joins,
               "The session may run already: its time is waited for before the first cycle, for a "
               "second at most (palpate run says so of whom it starts again, and of parts)");
  add_lockstep_options(command, options);
  command.footer(kModuleExitCodes);
  if (program.add_options) program.add_options(command);
  return command.run(argc, argv, [&] {
    outlive_readers();
    try {
      run(options);
    } catch (const Interrupted& stop) {  // no error: it was asked for
      spdlog::info("{}", stop.what());
      return kExitStopped;
    }
    return kExitDone;
  });
}

}  // namespace palpate::runtime
