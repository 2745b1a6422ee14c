#include "palpate/hosts_file.h"

#include <arpa/inet.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "modules/core/error.h"
#include "modules/core/input_file.h"
#include "modules/core/organ_limits.h"
#include "modules/runtime/wiring.h"
#include "modules/scene/object_reader.h"
#include "modules/scene/scene_tree.h"

namespace palpate::launcher {
namespace {

using scene::YamlValue;

constexpr const char* kFormatKey = "palpate_hosts";
constexpr const char* kFormat = "1";

/// The value of a key that is there.
YamlValue value_of(const YamlValue& map, const std::string& key) {
  for (const auto& entry : map.node) {
    if (entry.first.Scalar() != key) continue;
    return {entry.second, scene::line_of(entry.first, map.line), map.key_below(key), map.source};
  }
  map.refuse("must have the key " + key);
}

/// Refuses keys that are unknown, missing or given twice.
void check_keys(const YamlValue& map, const std::vector<std::string>& keys) {
  scene::ObjectReader(map, {keys, std::vector<std::string>(keys.size()), keys, false});
}

std::string word_of(const YamlValue& value) { return scene::text_from(value, {}); }

std::string address_of(const YamlValue& value) {
  in_addr ignored;
  std::string text = word_of(value);
  if (inet_pton(AF_INET, text.c_str(), &ignored) != 1)
    value.refuse("must be an IPv4 address such as 10.0.0.6");
  return text;
}

std::string module_of(const YamlValue& value) {
  std::string name = word_of(value);
  if (runtime::module_named(name)) return name;
  std::string names;
  for (const auto module : runtime::kModules)
    names += (names.empty() ? "" : ", ") + std::string(module);
  value.refuse("must be one of: " + names);
}

HostEntry host_of(const YamlValue& value) {
  check_keys(value, {"name", "address", "modules"});
  HostEntry host;
  host.name = word_of(value_of(value, "name"));
  host.address = address_of(value_of(value, "address"));
  for (const YamlValue& module : scene::entries_of(value_of(value, "modules"))) {
    const std::string name = module_of(module);
    if (std::ranges::find(host.modules, name) != host.modules.end()) {
      module.refuse("must be named once");
    }
    host.modules.push_back(name);
  }
  if (host.modules.empty()) value_of(value, "modules").refuse("must have at least one entry");
  return host;
}

void check_differs(const HostEntry& host, const std::vector<HostEntry>& others,
                   const YamlValue& value) {
  for (const HostEntry& other : others) {
    if (host.name == other.name) value_of(value, "name").refuse("must differ from host to host");
    if (host.address == other.address)
      value_of(value, "address").refuse("must differ from host to host");
    for (const YamlValue& module : scene::entries_of(value_of(value, "modules"))) {
      if (std::ranges::find(other.modules, module.node.Scalar()) == other.modules.end()) continue;
      module.refuse("must be on one host, but is on '" + other.name + "' too");
    }
  }
}

}  // namespace

const HostEntry& HostsFile::host(const std::string& name) const {
  const auto found = std::ranges::find(hosts, name, &HostEntry::name);
  if (found != hosts.end()) return *found;
  std::string names;
  for (const HostEntry& each : hosts) names += " " + each.name;
  throw InputError("--host " + name + ": there is none of that name; there are" + names);
}

std::vector<std::string> HostsFile::all_modules() const {
  std::vector<std::string> all;
  for (const HostEntry& each : hosts) std::ranges::copy(each.modules, std::back_inserter(all));
  return all;
}

std::string HostsFile::peers_of(const std::string& name) const {
  std::string peers;
  for (const HostEntry& each : hosts) {
    if (each.name != name) peers += (peers.empty() ? "" : ",") + each.address;
  }
  return peers;
}

HostsFile load_hosts(const std::filesystem::path& file) {
  const std::string text = read_input(file, kMaxTextBytes);
  const scene::Source source{file.string(), file.parent_path()};
  const YamlValue root{scene::parse_yaml(text, source), 1, "", &source};
  if (!root.node.IsMap()) {
    throw InputError(file.string() + ":1: a file of hosts must hold the keys " + kFormatKey +
                     " and hosts");
  }
  check_keys(root, {kFormatKey, "hosts"});
  if (word_of(value_of(root, kFormatKey)) != kFormat)
    value_of(root, kFormatKey).refuse(std::string("must be ") + kFormat);
  HostsFile hosts;
  for (const YamlValue& value : scene::entries_of(value_of(root, "hosts"))) {
    const HostEntry host = host_of(value);
    check_differs(host, hosts.hosts, value);
    hosts.hosts.push_back(host);
  }
  if (hosts.hosts.empty()) value_of(root, "hosts").refuse("must have at least one entry");
  return hosts;
}

}  // namespace palpate::launcher
