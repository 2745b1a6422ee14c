// palpate-recorder: records one session until it is told to stop (Ctrl-C, SIGTERM).
#include <CLI/CLI.hpp>
#include <iostream>

#include "modules/core/error.h"
#include "modules/recording/recorder.h"
#include "modules/runtime/module_options.h"
#include "modules/runtime/periodic_loop.h"
#include "modules/runtime/program.h"
#include "modules/runtime/stop_signal.h"

namespace {

constexpr double kPollRateHz = 100;  // a tenth of what the readers can hold at 4 kHz

void record(const palpate::bus::BusOptions& session, const std::string& file) {
  const palpate::runtime::StopSignal stop;
  palpate::recording::Recorder recorder(session, file);
  palpate::runtime::PeriodicLoop loop(kPollRateHz);
  while (!stop.requested()) {
    loop.wait_for_period();
    recorder.poll();
  }
  recorder.close();
  std::cerr << "[recorder] " << file << ": " << recorder.file().statistics().message_count
            << " samples, " << recorder.file().bytes_written() << " bytes\n";
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Records every sample of a session into one MCAP file", "palpate-recorder");
  palpate::bus::BusOptions session{.participant_name = "recorder"};
  std::string file;
  app.add_option("FILE", file, "the recording to write; an existing one is replaced")->required();
  palpate::runtime::add_bus_options(app, session);
  return palpate::runtime::run_program(app, argc, argv, [&] {
    record(session, file);
    return palpate::kExitDone;
  });
}
