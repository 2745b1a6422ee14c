#include "palpate/hosts_file.h"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>

#include "modules/core/error.h"
#include "palpate/run_options.h"
#include "tests/palpate/shell_script.h"

namespace palpate::launcher {
namespace {

using Names = std::vector<std::string>;

constexpr const char* kTwo =
    "palpate_hosts: 1\n"
    "hosts:\n"
    "  - {name: bench, address: 10.0.0.5, modules: [haptics, collision, recorder]}\n"
    "  - {name: rack, address: 10.0.0.6, modules: [deformation]}\n"
    "  - {name: desk, address: 10.0.0.7, modules: [visualizer]}\n";

std::filesystem::path written(const testing::Scripts& files, const std::string& text) {
  const auto file = files.folder() / "hosts.yaml";
  std::ofstream(file) << text;
  return file;
}

std::string refusal(const std::string& text) {
  const testing::Scripts files;
  const auto file = written(files, text);
  try {
    load_hosts(file);
  } catch (const InputError& error) {
    return std::string(error.what()).substr(files.folder().string().size() + 1);
  }
  return "accepted";
}

std::string with(const std::string& from, const std::string& to) {
  std::string text = kTwo;
  return text.replace(text.find(from), from.size(), to);
}

std::string refused_options(const std::function<void(RunOptions&)>& change) {
  const testing::Scripts files;
  RunOptions options;
  options.hosts = written(files, kTwo);
  options.host = "rack";
  change(options);
  try {
    apply_hosts(options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("hosts file: who runs what, who conducts, and where the others are") {
  // Oracle: the file by hand.
  const testing::Scripts files;
  const HostsFile hosts = load_hosts(written(files, kTwo));
  REQUIRE(hosts.hosts.size() == 3);
  CHECK(hosts.host("rack").modules == Names{"deformation"});
  CHECK(hosts.conducts("bench"));
  CHECK_FALSE(hosts.conducts("rack"));
  CHECK(hosts.peers_of("rack") == "10.0.0.5,10.0.0.7");
  CHECK(hosts.all_modules() ==
        Names{"haptics", "collision", "recorder", "deformation", "visualizer"});
  CHECK_THROWS_WITH(hosts.host("lab"),
                    "--host lab: there is none of that name; there are bench rack desk");
}

TEST_CASE("hosts file: what is wrong is named with its line and what is allowed") {
  // Oracle: messages by hand.
  CHECK(refusal(kTwo) == "accepted");
  CHECK(refusal(with("palpate_hosts: 1\n", "")) == "hosts.yaml:1: key 'palpate_hosts' is missing");
  CHECK(refusal(with("address: 10.0.0.6", "address: rack.lab")) ==
        "hosts.yaml:4: key 'hosts[1].address' = 'rack.lab': must be an IPv4 address such as "
        "10.0.0.6");
  CHECK(refusal(with("10.0.0.6", "10.0.0.5")) ==
        "hosts.yaml:4: key 'hosts[1].address' = '10.0.0.5': must differ from host to host");
  CHECK(refusal(with("name: rack", "name: bench")) ==
        "hosts.yaml:4: key 'hosts[1].name' = 'bench': must differ from host to host");
  CHECK(refusal(with("[deformation]", "[organs]")) ==
        "hosts.yaml:4: key 'hosts[1].modules[0]' = 'organs': must be one of: haptics, collision, "
        "deformation, visualizer, recorder");
  CHECK(refusal(with("[deformation]", "[collision]")) ==
        "hosts.yaml:4: key 'hosts[1].modules[0]' = 'collision': must be on one host, but is on "
        "'bench' too");
  CHECK(refusal(with("[deformation]", "[deformation, deformation]")) ==
        "hosts.yaml:4: key 'hosts[1].modules[1]' = 'deformation': must be named once");
  CHECK(refusal(with("[deformation]", "[]")).find("must have at least one entry") !=
        std::string::npos);
  CHECK(refusal(with("modules: [deformation]", "runs: [deformation]")).find("'hosts[1].runs'") !=
        std::string::npos);
  CHECK(refusal("palpate_hosts: 1\nhosts: []\n").find("must have at least one entry") !=
        std::string::npos);
  for (const char* text : {"", "# nothing yet\n", "bench\n"}) {
    CHECK(refusal(text) ==
          "hosts.yaml:1: a file of hosts must hold the keys palpate_hosts and hosts");
  }
  CHECK_THROWS_WITH(load_hosts("/nowhere/hosts.yaml"), "/nowhere/hosts.yaml: no such file");
  CHECK_THROWS_WITH(load_hosts("/"), "/: is a folder, not a file");
}

TEST_CASE("hosts file: a run takes its modules, and its part, from it") {
  // Oracle: the file by hand.
  const testing::Scripts files;
  RunOptions options;
  options.hosts = written(files, with("10.0.0.6", "127.0.0.1"));
  options.host = "rack";
  apply_hosts(options);
  CHECK(options.only == Names{"deformation"});
  CHECK_FALSE(options.conducts);
  CHECK(participants_of(options, {"deformation"}).size() == 5);
  CHECK(std::string(std::getenv("PALPATE_INTERFACES")) == "127.0.0.1");
  CHECK(std::string(std::getenv("PALPATE_PEERS")) == "10.0.0.5,10.0.0.7");
  ::unsetenv("PALPATE_INTERFACES");
  ::unsetenv("PALPATE_PEERS");

  RunOptions alone;
  apply_hosts(alone);
  CHECK(alone.only.empty());
  CHECK(alone.conducts);
}

TEST_CASE("hosts file: options that do not go with it are refused") {
  // Oracle: messages by hand.
  CHECK(refused_options([](RunOptions& o) { o.host = ""; }) ==
        "--hosts: which of them is this? Give --host NAME");
  CHECK(refused_options([](RunOptions& o) { o.hosts = ""; }) == "--host rack: needs --hosts FILE");
  CHECK(refused_options([](RunOptions& o) { o.only = {"haptics"}; }) ==
        "--only: --hosts says already what runs where");
  CHECK(refused_options([](RunOptions& o) { o.host = "bench"; }) ==
        "--hosts: host bench has the recorder: give it --record FILE");
  CHECK(refused_options([](RunOptions& o) {
          o.lockstep = true;
          o.record = "felt.mcap";
        }).starts_with("--record: in lockstep all must know of it"));
  const std::string elsewhere = refused_options([](RunOptions&) {});
  CHECK(
      elsewhere.find("hosts.yaml: host rack: address 10.0.0.6 is none of this host, which has ") !=
      std::string::npos);
  CHECK(elsewhere.find("127.0.0.1") != std::string::npos);
}

}  // namespace palpate::launcher
