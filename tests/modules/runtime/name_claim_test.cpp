#include "modules/runtime/name_claim.h"

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <csignal>

#include "modules/core/error.h"
#include "modules/core/stop_signal.h"
#include "tests/modules/runtime/own_bus.h"

using namespace palpate;
using namespace palpate::runtime;

namespace {

/// A process that is this module and does nothing.
pid_t process_of(const bus::BusOptions& session, const std::string& module) {
  int ready[2];
  REQUIRE(::pipe(ready) == 0);
  const pid_t process = fork();
  if (process == 0) {
    const auto claim = claim_module(session, module);
    const bool told = ::write(ready[1], "x", 1) == 1;
    while (told) ::pause();
    ::_exit(1);
  }
  char byte = 0;
  REQUIRE(::read(ready[0], &byte, 1) == 1);
  ::close(ready[0]);
  ::close(ready[1]);
  return process;
}

}  // namespace

TEST_CASE("name claim: one has a name, and it is free when that one is gone") {
  // Oracle: the kernel's names.
  const std::string name = palpate::testing::own_bus_options().session;
  auto first = NameClaim::take(name);
  REQUIRE(first);
  CHECK(NameClaim::holder(name) == ::getpid());
  CHECK_FALSE(NameClaim::take(name));
  CHECK(NameClaim::take(name + "b"));
  NameClaim moved = std::move(*first);
  first.reset();
  CHECK_FALSE(NameClaim::take(name));
  { const NameClaim last = std::move(moved); }
  CHECK(NameClaim::take(name));
}

TEST_CASE("name claim: a module that is there is named, killed it has a successor at once") {
  // Oracle: the process's number; the kernel's names once its end is known.
  const bus::BusOptions own = palpate::testing::own_bus_options();
  const pid_t process = process_of(own, "haptics");
  ::kill(process, SIGSTOP);  // it could go on at any moment
  CHECK_THROWS_WITH(claim_module(own, "haptics"),
                    Catch::Contains("session '" + own.session + "' has haptics here already, " +
                                    "process " + std::to_string(process)));
  CHECK(claim_module(own, "deformation"));
  CHECK(claim_module(own, "deformation2"));
  CHECK_FALSE(claim_module(own, "visualizer"));  // of which there may be several
  const StopSignal stop;
  ::raise(SIGTERM);
  CHECK_THROWS_AS(claim_module(own, "haptics"), Interrupted);  // whoever waits can be stopped
  ::kill(process, SIGKILL);
  REQUIRE(::waitpid(process, nullptr, 0) == process);
  CHECK(claim_module(own, "haptics"));
}
