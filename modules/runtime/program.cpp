#include "modules/runtime/program.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <new>
#include <optional>

#include "modules/core/error.h"
#include "modules/core/standard_streams.h"
#include "modules/messages/messages.h"
#include "modules/runtime/scarcity.h"

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

/// The parser takes 0x10 for 16 and 010 for 8; a scene file and an environment variable do not.
void refuse_other_bases(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    const std::string type = option->get_type_name();
    if (type.find("INT") == std::string::npos && type.find("FLOAT") == std::string::npos) continue;
    for (const std::string& text : option->results()) {
      const std::size_t first = text.find_first_not_of("+-");
      if (first == std::string::npos || text[first] != '0' || first + 1 == text.size()) continue;
      const char next = text[first + 1];
      const bool hexadecimal = next == 'x' || next == 'X';
      const bool octal = next >= '0' && next <= '9' && type.find("INT") != std::string::npos;
      if (!hexadecimal && !octal) continue;
      throw CLI::ValidationError(option->get_name(), text + " is not a decimal number");
    }
  }
  for (const CLI::App* command : app.get_subcommands()) refuse_other_bases(*command);
}

/// The parser takes -1, and what is too large, for the largest number there is.
void refuse_wrapped(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_type_name().find("UINT") == std::string::npos) continue;
    for (const std::string& text : option->results()) {
      errno = 0;
      std::strtoull(text.c_str(), nullptr, 0);
      if (errno != ERANGE && text.find('-') == std::string::npos) continue;
      throw CLI::ValidationError(option->get_name(), text + " is not between 0 and 2^64 - 1");
    }
  }
  for (const CLI::App* command : app.get_subcommands()) refuse_wrapped(*command);
}

/// "a,,b": the parser passes over what is not there.
/// @throws InputError for an empty entry of a list
void refuse_empty_entries(const CLI::App& app, const std::vector<std::string>& words) {
  const CLI::Option* list = nullptr;
  for (const std::string& word : words) {
    const std::size_t sign = word.find('=');
    const CLI::Option* option = app.get_option_no_throw(word.substr(0, sign));
    if (option != nullptr && word.starts_with('-')) list = option;
    if (list == nullptr || list->get_delimiter() != ',') continue;
    if (option != nullptr && sign == std::string::npos) continue;
    const std::string entries = "," + (option == nullptr ? word : word.substr(sign + 1)) + ",";
    if (entries.find(",,") == std::string::npos) continue;
    if (entries == ",,") throw InputError(list->get_name() + ": an empty list names nothing");
    throw InputError(list->get_name() + " " + entries.substr(1, entries.size() - 2) +
                     ": an entry between its commas is empty");
  }
}

/// The parser blames an option that nobody gave.
/// @return what is wrong with a variable of the environment; empty if nothing is
std::string blames_environment(const CLI::App& app, const std::vector<std::string>& words,
                               const std::string& error) {
  for (const CLI::Option* option : app.get_options()) {
    const char* const value =
        option->get_envname().empty() ? nullptr : std::getenv(option->get_envname().c_str());
    if (value == nullptr || !error.starts_with(option->get_name() + ": ")) continue;
    const bool typed = std::ranges::any_of(words, [&](const auto& word) {
      return word == value || word == option->get_name() + "=" + value;
    });
    if (typed || error.find(value) == std::string::npos) continue;
    return option->get_envname() + " of the environment, for " + error;
  }
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (auto blamed = blames_environment(*command, words, error); !blamed.empty()) return blamed;
  }
  return "";
}

std::string refuse_empty(const std::string& path) {
  return path.empty() ? "an empty path names no file" : "";
}

/// @throws InputError for a file that is both read and written, or written twice
void refuse_overwriting(const Files& files) {
  for (std::size_t i = 0; i < files.written.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (files.written[i]->empty() || files.written[k]->empty()) continue;
      const std::filesystem::path a = files.written[i]->results()[0];
      const std::filesystem::path b = files.written[k]->results()[0];
      if (std::filesystem::absolute(a).lexically_normal() !=
          std::filesystem::absolute(b).lexically_normal()) {
        continue;
      }
      throw InputError(files.written[i]->get_name() + " " + a.string() + ": is what " +
                       files.written[k]->get_name() + " names and would be overwritten");
    }
  }
  for (const CLI::Option* output : files.written) {
    for (const CLI::Option* input : files.read) {
      if (output->empty() || input->empty()) continue;
      std::error_code none;
      if (!std::filesystem::equivalent(output->results()[0], input->results()[0], none)) continue;
      throw InputError(output->get_name() + " " + output->results()[0] + ": is what " +
                       input->get_name() + " names and would be overwritten");
    }
  }
}

}  // namespace

std::string version_text() {
  return "palpate " PALPATE_VERSION ", protocol " + std::to_string(kProtocolVersion);
}

Option& Option::required() { return option_->required(), *this; }

Option& Option::shows_default() { return option_->capture_default_str(), *this; }

Option& Option::range(double lowest, double highest) {
  const bool whole = option_->get_type_name().find("INT") != std::string::npos;
  const auto rounded = [](double bound) { return static_cast<long long>(bound); };
  option_->check(whole ? CLI::Range(rounded(lowest), rounded(highest))
                       : CLI::Range(lowest, highest));
  return *this;
}

Option& Option::one_of(const std::vector<std::string>& words) {
  return option_->check(CLI::IsMember(words)), *this;
}

Option& Option::environment(const char* variable) { return option_->envname(variable), *this; }

Option& Option::excludes(const Option& other) { return option_->excludes(other.option_), *this; }

Option& Option::needs(const Option& other) { return option_->needs(other.option_), *this; }

template <class T>
Option Options::add(const char* names, T& value, const std::string& help) {
  using Path = std::filesystem::path;
  CLI::Option* option = app_->add_option(names, value, help);
  if constexpr (std::is_same_v<T, Path> || std::is_same_v<T, std::vector<Path>>) {
    option->check(refuse_empty);
  } else if (*names == '-' && option->get_items_expected_max() > 1) {
    option->delimiter(',');
  }
  return Option(*option);
}

template Option Options::add(const char*, int&, const std::string&);
template Option Options::add(const char*, std::size_t&, const std::string&);
template Option Options::add(const char*, double&, const std::string&);
template Option Options::add(const char*, std::string&, const std::string&);
template Option Options::add(const char*, std::filesystem::path&, const std::string&);
template Option Options::add(const char*, std::optional<int>&, const std::string&);
template Option Options::add(const char*, std::optional<double>&, const std::string&);
template Option Options::add(const char*, std::optional<std::string>&, const std::string&);
template Option Options::add(const char*, std::optional<std::size_t>&, const std::string&);
template Option Options::add(const char*, std::vector<int>&, const std::string&);
template Option Options::add(const char*, std::vector<std::size_t>&, const std::string&);
template Option Options::add(const char*, std::vector<double>&, const std::string&);
template Option Options::add(const char*, std::vector<std::string>&, const std::string&);
template Option Options::add(const char*, std::vector<std::filesystem::path>&, const std::string&);
template Option Options::add(const char*, std::set<std::string, std::less<>>&, const std::string&);

Option Options::add_input(const char* names, std::filesystem::path& value,
                          const std::string& help) {
  Option option = add(names, value, help);
  files_->read.push_back(app_->get_options().back());
  return option;
}

Option Options::add_output(const char* names, std::filesystem::path& value,
                           const std::string& help) {
  Option option = add(names, value, help);
  files_->written.push_back(app_->get_options().back());
  return option;
}

Option Options::add_each(const char* names, std::vector<std::string>& value,
                         const std::string& help) {
  CLI::Option* option = app_->add_option(names, value, help);
  option->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  return Option(*option);
}

Option Options::flag(const char* names, bool& value, const std::string& help) {
  return Option(*app_->add_flag(names, value, help));
}

Option Options::flag_off(const char* names, bool& value, const std::string& help) {
  return Option(*app_->add_flag_callback(
      names, [&value] { value = false; }, help));
}

void Options::footer(const std::string& text) { app_->footer(text); }

Program::Program(const std::string& purpose, const std::string& name)
    : Program((open_standard_descriptors(), std::make_unique<CLI::App>(purpose, name))) {}

Program::Program(std::unique_ptr<CLI::App> app)
    : Options(*app),
      app_(std::move(app)),
      report_([name = app_->get_name()](const std::string& what) {
        std::cerr << name << ": " << what << '\n';
      }) {
  app_->set_version_flag("--version", version_text());
  footer(kExitCodes);  // of every command, too
  end_in_words(app_->get_name());
}

Program::~Program() = default;

Options Program::command(const std::string& word, const std::string& purpose,
                         std::function<int()> job) {
  app_->require_subcommand(1);
  CLI::App* command = app_->add_subcommand(word, purpose);
  command->set_version_flag("--version", version_text());
  Options options(*command);
  command->final_callback([this, files = options.files_, job = std::move(job)] {
    refuse_overwriting(*files);
    job_ = job;
  });
  return options;
}

void Program::command_with_words(const std::string& word, const std::string& purpose,
                                 std::function<int(const std::vector<std::string>&)> job) {
  app_->require_subcommand(1);
  CLI::App* command = app_->add_subcommand(word, purpose);
  command->prefix_command();
  command->set_help_flag();
  command->final_callback([this, command, job = std::move(job)] {
    job_ = [job, words = command->remaining()] { return job(words); };
  });
}

/// Says so where the first word is meant as a command and is none.
bool Program::refuse_unknown(const std::vector<std::string>& words) const {
  const auto commands = app_->get_subcommands([](const CLI::App*) { return true; });
  if (commands.empty() || words.empty() || words[0].starts_with('-')) return false;
  const std::string& word = words[0];
  std::string names;
  for (const CLI::App* command : commands) {
    if (command->get_name() == word) return false;
    names += ' ' + command->get_name();
  }
  report_("there is no command '" + word + "'; there are" + names);
  return true;
}

std::vector<std::string> Program::commands() const {
  std::vector<std::string> words;
  for (const CLI::App* command : app_->get_subcommands([](const CLI::App*) { return true; })) {
    words.push_back(command->get_name());
  }
  words.emplace_back("help");
  return words;
}

std::vector<std::string> Program::given() const {
  std::vector<std::string> names;
  for (const CLI::App* command : app_->get_subcommands()) {
    for (const CLI::Option* option : command->get_options()) {
      if (option->count() > 0 && !option->get_positional()) names.push_back(option->get_name());
    }
  }
  return names;
}

std::vector<std::string> Program::typed(int argc, char** argv) const {
  std::vector<std::string> words(argv + 1, argv + argc);
  const bool has_commands = !app_->get_subcommands([](const CLI::App*) { return true; }).empty();
  if (!has_commands || words.empty() || words[0] != "help") return words;
  words.erase(words.begin());
  words.push_back("--help");
  return words;
}

int Program::run(int argc, char** argv, const std::function<int()>& body) {
  const int code = run_body(argc, argv, body);
  const std::string lost = why_output_is_lost();
  if (lost.empty()) return code;
  std::cerr << app_->get_name() << ": " << lost << '\n';
  return code == kExitDone ? kExitFailed : code;
}

int Program::run_body(int argc, char** argv, const std::function<int()>& body) {
  const std::vector<std::string> words = typed(argc, argv);
  std::signal(SIGCHLD, SIG_DFL);  // who starts us may ignore it: no child's exit code is told then
  std::signal(SIGXFSZ, SIG_IGN);  // a file that may not grow is an error of its writer
  if (refuse_unknown(words)) return kExitBadInput;
  try {
    for (const CLI::App* command : app_->get_subcommands([](const CLI::App*) { return true; })) {
      if (!words.empty() && command->get_name() == words[0]) refuse_empty_entries(*command, words);
    }
    refuse_empty_entries(*app_, words);
    app_->parse(std::vector<std::string>(words.rbegin(), words.rend()));  // it takes the last first
    refuse_nan(*app_);
    refuse_other_bases(*app_);
    refuse_wrapped(*app_);
    refuse_overwriting(*files_);
    return job_ ? job_() : body();
  } catch (const CLI::ParseError& error) {
    const std::string blamed = blames_environment(*app_, words, error.what());
    if (!blamed.empty()) return report_(blamed), kExitBadInput;
    return app_->exit(error) == 0 ? kExitDone : kExitBadInput;
  } catch (const InputError& error) {
    report_(error.what());
    return kExitBadInput;
  } catch (const Interrupted& error) {
    report_(error.what());
    return kExitStopped;
  } catch (const std::bad_alloc&) {
    report_(kNoMemory);
    return kExitFailed;
  } catch (const std::system_error& error) {
    report_(why(error));
    return kExitFailed;
  } catch (const std::exception& error) {
    report_(error.what());
    return kExitFailed;
  }
}

}  // namespace palpate::runtime
