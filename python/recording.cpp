#include "modules/recording/recorder.h"
#include "modules/recording/sample_reader.h"

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <map>
#include <set>

#include "modules/bus/topics.h"
#include "modules/core/error.h"
#include "python/bindings.h"
#include "python/topic_columns.h"
#include "python/unlocked.h"

namespace py = pybind11;

namespace palpate::python {
namespace {

struct ReadTopics {
  std::map<std::string, TopicColumns> columns;
  std::map<std::string, std::size_t> invalid;  ///< samples refused by the codec
  recording::McapMap scene;
  std::string warning;  ///< lines
};

ReadTopics topics_in(const std::string& file, const std::set<std::string>& wanted) {
  ReadTopics read;
  recording::SampleReader reader(file);
  messages::AnyMessage message;
  while (const auto sample = reader.next()) {
    const std::string topic(sample->topic->name);
    if (!wanted.empty() && !wanted.contains(topic)) continue;
    if (sample->topic->type->decode(sample->payload, message) == nullptr) {
      read.columns[topic].add(message);
    } else {
      ++read.invalid[topic];
    }
  }
  read.scene = reader.metadata(recording::kSceneMetadata);
  for (const std::string& line : reader.warnings()) {
    read.warning += (read.warning.empty() ? "" : "\n  ") + line;
  }
  return read;
}

/// (topic, columns, messages) of each, the scene's name and digest, what is wrong with it.
py::tuple read_recording(const std::string& file, const std::set<std::string>& wanted) {
  for (const std::string& name : wanted) {
    if (bus::find_topic(name) != nullptr) continue;
    std::string known;
    for (const bus::TopicInfo& topic : bus::all_topics()) {
      known.append(known.empty() ? "" : ", ").append(topic.name);
    }
    throw InputError("topics: there is no topic '" + name + "'; there are " + known);
  }
  ReadTopics topics;
  {
    const Unlocked unlocked;
    topics = topics_in(file, wanted);
  }
  py::list result;
  for (auto& [name, columns] : topics.columns) {
    const std::size_t messages = columns.size();
    result.append(py::make_tuple(name, columns.take(), messages));
  }
  return py::make_tuple(result, topics.scene, topics.invalid, topics.warning);
}

}  // namespace

void bind_recording(py::module_& module) { module.def("read_recording", &read_recording); }

}  // namespace palpate::python
