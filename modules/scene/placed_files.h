// The files and probes that a scene's text names, and the same text where the files lie elsewhere.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace palpate::scene {

/// Meshes and motions, each as often as it is named; they need not be there.
/// @param resolved_text  as resolved_text() gives it
/// @throws SceneError for what is no YAML
std::vector<std::filesystem::path> files_named(const std::string& resolved_text);

/// Of its probes, in their order; "" of one without. Its files need not be there.
/// @throws SceneError for what is no YAML
std::vector<std::string> probe_names(const std::string& resolved_text);

/// @param place  where each of them is to be
std::string with_files(
    const std::string& resolved_text,
    const std::function<std::filesystem::path(const std::filesystem::path&)>& place);

}  // namespace palpate::scene
