// A process that writes probe states until it is killed: test-probe-writer DOMAIN SESSION BUTTONS
#include <chrono>
#include <cstdlib>
#include <thread>

#include "modules/bus/dds_bus.h"

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  palpate::bus::BusOptions options;
  options.domain = std::atoi(argv[1]);
  options.session = argv[2];
  palpate::bus::DdsBus bus(options);
  auto writer = bus.writer(palpate::bus::kProbeState);
  palpate::ProbeState state;
  state.buttons = static_cast<std::uint32_t>(std::atoi(argv[3]));
  for (;;) {
    writer.write(state);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}
