#include "modules/runtime/program.h"

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdlib>
#include <iostream>

#include "modules/core/error.h"
#include "modules/messages/messages.h"

namespace palpate::runtime {
namespace {

/// No comparison refuses NaN: CLI::Range lets it pass.
void refuse_nan(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_type_name().find("FLOAT") == std::string::npos) continue;
    for (const std::string& text : option->results()) {
      if (!std::isnan(std::strtod(text.c_str(), nullptr))) continue;
      throw CLI::ValidationError(option->get_name(), text + " is not a number");
    }
  }
  for (const CLI::App* command : app.get_subcommands()) refuse_nan(*command);
}

}  // namespace

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
    refuse_nan(app);
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
