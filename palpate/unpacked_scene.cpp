#include "palpate/unpacked_scene.h"

#include <fstream>
#include <iterator>
#include <ostream>
#include <set>
#include <stdexcept>

#include "modules/core/input_file.h"
#include "modules/recording/mcap_reader.h"
#include "modules/recording/recorder.h"
#include "modules/scene/placed_files.h"
#include "palpate/recorded_scene.h"

namespace palpate::launcher {
namespace {

namespace fs = std::filesystem;
using recording::McapAttachment;

/// Of the scene that was told first: they lie between it and the next message.
std::map<std::string, std::vector<McapAttachment>> attachments_of(const fs::path& recording) {
  std::map<std::string, std::vector<McapAttachment>> attached;
  recording::McapReader reader(recording);
  while (auto record = reader.next()) {
    if (!attached.empty() && std::holds_alternative<recording::McapMessage>(*record)) break;
    auto* attachment = std::get_if<McapAttachment>(&*record);
    if (attachment != nullptr) attached[attachment->name].push_back(std::move(*attachment));
  }
  return attached;
}

std::map<std::string, std::set<fs::path>> by_name(const std::vector<fs::path>& files) {
  std::map<std::string, std::set<fs::path>> named;
  for (const fs::path& file : files) named[file.filename().string()].insert(file);
  return named;
}

std::string why_taken(const fs::path& file, const std::string& bytes) {
  if (!why_not_readable(file).empty()) return "is not there";
  std::error_code error;
  if (fs::file_size(file, error) != bytes.size() || error) return "has changed since";
  std::ifstream stream = open_input(file);
  const std::string there{std::istreambuf_iterator<char>(stream), {}};
  return there == bytes ? "" : "has changed since";
}

void write(const fs::path& file, const std::string& bytes) {
  std::ofstream stream(file, std::ios::binary);
  if (!(stream << bytes << std::flush)) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace

UnpackedScene::UnpackedScene(const fs::path& recording, const fs::path& folder, std::ostream& log)
    : here_(recorded_scene(recording)), file_(folder / "recorded.yaml") {
  const auto attached = attachments_of(recording);
  std::map<fs::path, fs::path> places;
  for (const auto& [name, files] : by_name(scene::files_named(here_.resolved_text))) {
    const auto found = attached.find(name);
    // They were attached in the order of their places, which alone tells those of one name apart.
    if (found == attached.end() || found->second.size() != files.size()) continue;
    auto attachment = found->second.begin();
    for (const fs::path& file : files) places[file] = placed(file, *attachment++, folder, log);
  }
  here_.resolved_text =
      scene::with_files(here_.resolved_text, [&](const fs::path& file) -> fs::path {
        const auto place = places.find(file);
        return place == places.end() ? file : place->second;
      });
  write(file_, here_.resolved_text);
}

fs::path UnpackedScene::placed(const fs::path& named, const McapAttachment& attached,
                               const fs::path& folder, std::ostream& log) {
  const std::string why = why_taken(named, attached.data);
  if (why.empty()) return named;
  const fs::path own = folder / ("attached-" + std::to_string(taken_.size()));
  fs::create_directory(own);
  const fs::path place = own / named.filename();
  write(place, attached.data);
  log << "palpate: " << named.string() << ": " << why << "; taken from the recording" << std::endl;
  told_[place] = named;
  taken_.push_back({0, attached.name, attached.media_type, attached.data});
  return place;
}

std::string UnpackedScene::as_told(const std::string& resolved_text) const {
  return scene::with_files(resolved_text, [this](const fs::path& file) -> fs::path {
    const auto name = told_.find(file);
    return name == told_.end() ? file : name->second;
  });
}

}  // namespace palpate::launcher
