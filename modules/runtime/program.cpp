#include "modules/runtime/program.h"

#include <CLI/CLI.hpp>
#include <iostream>

#include "modules/core/error.h"
#include "modules/messages/messages.h"

namespace palpate::runtime {

std::string version_text() {
  return "palpate " PALPATE_VERSION ", protocol " + std::to_string(kProtocolVersion);
}

void add_version(CLI::App& app) { app.set_version_flag("--version", version_text()); }

int run_program(CLI::App& app, int argc, char** argv, const std::function<int()>& body) {
  add_version(app);
  const auto failed = [&app](const std::exception& error, int code) {
    std::cerr << app.get_name() << ": " << error.what() << '\n';
    return code;
  };
  try {
    app.parse(argc, argv);
    return body();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitDone : kExitBadInput;
  } catch (const InputError& error) {
    return failed(error, kExitBadInput);
  } catch (const std::exception& error) {
    return failed(error, kExitFailed);
  }
}

}  // namespace palpate::runtime
