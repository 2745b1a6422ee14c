#include "python/unlocked.h"

#include <atomic>
#include <chrono>
#include <thread>

#include "python/busy.h"

namespace py = pybind11;

namespace palpate::python {
namespace {

std::atomic<bool> interpreter_ends{false};
std::atomic<int> calls{0};

void refuse_at_end() {
  if (interpreter_ends) throw ClosedError("the interpreter ends");
}

}  // namespace

Unlocked::Counted::Counted(AtEnd at_end) {
  if (at_end == AtEnd::kRefused) refuse_at_end();
  ++calls;
}
Unlocked::Counted::~Counted() { --calls; }

void Unlocked::look_for_signals() {
  refuse_at_end();
  const py::gil_scoped_acquire acquire;
  if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

void end_unlocked_work() {
  interpreter_ends = true;
  const py::gil_scoped_release release;
  while (calls > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace palpate::python
