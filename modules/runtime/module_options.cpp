#include "modules/runtime/module_options.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>

#include "modules/core/error.h"
#include "modules/runtime/program.h"
#include "modules/runtime/wiring.h"

namespace palpate::runtime {
namespace {

void start_log(const std::string& name) {
  auto logger =
      std::make_shared<spdlog::logger>(name, std::make_shared<spdlog::sinks::stderr_sink_mt>());
  logger->set_pattern("[%n] %l: %v");
  logger->flush_on(spdlog::level::trace);
  spdlog::set_default_logger(logger);
}

/// Runs `job` and turns what it throws into a line and an exit code.
int report_failure(const std::function<void()>& job) {
  try {
    job();
    return kExitDone;
  } catch (const InputError& error) {
    spdlog::error("{}", error.what());
    return kExitBadInput;
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    return kExitFailed;
  }
}

}  // namespace

void add_bus_options(CLI::App& app, bus::BusOptions& bus) {
  app.add_option("--session", bus.session, "Name that keeps simultaneous sessions apart")
      ->capture_default_str();
  app.add_option("--domain", bus.domain, "DDS domain id, 0 to 200")
      ->envname("PALPATE_DOMAIN")
      ->check(CLI::Range(0, 200))
      ->capture_default_str();
}

void add_lockstep_option(CLI::App& app, std::vector<std::string>& participants) {
  app.add_option("--lockstep", participants,
                 "Modules of a lockstep session, this one included: cycles wait for their inputs, "
                 "no clock is read (palpate run --lockstep)")
      ->delimiter(',')
      ->check(CLI::IsMember(std::vector<std::string>(kModules.begin(), kModules.end())));
}

int run_module(int argc, char** argv, const ModuleProgram& program,
               const std::function<void(const ModuleOptions&)>& run) {
  start_log(program.name);
  ModuleOptions options;
  bool no_realtime = false;
  CLI::App app(program.purpose, "palpate-" + program.name);
  app.add_option("SCENE", options.scene, "Scene file (YAML)")->required();
  add_bus_options(app, options.bus);
  app.add_flag("--no-realtime", no_realtime, "Do not ask for real-time priority");
  add_lockstep_option(app, options.lockstep);
  if (program.add_options) program.add_options(app);
  add_version(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitDone : kExitBadInput;
  }
  options.realtime = !no_realtime;
  return report_failure([&] { run(options); });
}

}  // namespace palpate::runtime
