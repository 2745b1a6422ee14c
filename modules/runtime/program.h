// What is around the body of every program: its command line, --help, --version, and what is
// thrown. The parser is known to one file, for its header costs each that includes it eight
// seconds.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace palpate::runtime {

/// What --help of a program or command says last, unless that says more.
inline constexpr const char* kExitCodes =
    "Exit code: 0 if it did what was asked, 1 if something failed, 2 for bad input, 130 if it was "
    "stopped (Ctrl-C).";

/// What --version prints: "palpate VERSION, protocol NUMBER". Programs with the same protocol can
/// share a session.
std::string version_text();

/// One option, to be told more about.
class Option {
 public:
  explicit Option(CLI::Option& option) : option_(&option) {}
  Option& required();
  Option& shows_default();  ///< --help prints the value it has now
  Option& range(double lowest, double highest);
  Option& one_of(const std::vector<std::string>& words);
  Option& environment(const char* variable);  ///< whose value is the default
  Option& excludes(const Option& other);
  Option& needs(const Option& other);

 private:
  CLI::Option* option_;
};

/// The files that options name.
struct Files {
  std::vector<const CLI::Option*> read, written;
};

/// The options of a program, or of one of its commands.
class Options {
 public:
  explicit Options(CLI::App& app) : app_(&app) {}

  /// An option ("-o,--out") or, without dashes, an argument ("SCENE"). NaN and empty paths are
  /// refused, and so are empty entries of lists, which are separated by commas or spaces, arguments
  /// and paths by spaces alone.
  /// @param value  what it sets: a number, text or path, an optional, vector or set of these
  template <class T>
  Option add(const char* names, T& value, const std::string& help);
  /// The same for a file, or a folder of files. What a command reads it does not write.
  Option add_input(const char* names, std::filesystem::path& value, const std::string& help);
  Option add_output(const char* names, std::filesystem::path& value, const std::string& help);
  /// A list of texts that may hold commas, one behind each mention of the option.
  Option add_each(const char* names, std::vector<std::string>& value, const std::string& help);
  Option flag(const char* names, bool& value, const std::string& help);
  Option flag_off(const char* names, bool& value, const std::string& help);  ///< makes it false
  void footer(const std::string& text);  ///< what --help says last; else the exit codes of all

 private:
  friend class Program;

  CLI::App* app_;
  std::shared_ptr<Files> files_ = std::make_shared<Files>();
};

class Program : public Options {
 public:
  /// First thing in a program: standard descriptors that are closed are opened on /dev/null, and
  /// what nobody can catch ends it in words (scarcity.h).
  /// @param purpose  a sentence for --help  @param name  as it is typed
  Program(const std::string& purpose, const std::string& name);
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// "NAME WORD …" runs `job`, whose result is the exit code. With one command, one has to be
  /// given.
  Options command(const std::string& word, const std::string& purpose, std::function<int()> job);
  /// The same where all words that follow, --help too, are the job's.
  void command_with_words(const std::string& word, const std::string& purpose,
                          std::function<int(const std::vector<std::string>&)> job);
  /// Their words, and "help".
  std::vector<std::string> commands() const;
  /// Names of the options that were given behind the command, "--frames", when its job runs.
  std::vector<std::string> given() const;
  /// Where what is thrown goes, in one line. Else to stderr, led by the program's name.
  void report_to(std::function<void(const std::string&)> report) { report_ = std::move(report); }

  /// Parses the command line and runs `body`, or the command that was given. "help WORD" is
  /// "WORD --help".
  /// @return what that returns; kExitDone after --help or --version; kExitBadInput for an
  /// InputError or a wrong command line, kExitFailed for any other exception, and where all was
  /// done but what was printed could not be written
  int run(int argc, char** argv, const std::function<int()>& body = {});

 private:
  explicit Program(std::unique_ptr<CLI::App> app);
  int run_body(int argc, char** argv, const std::function<int()>& body);
  bool refuse_unknown(const std::vector<std::string>& words) const;
  std::vector<std::string> typed(int argc, char** argv) const;

  std::unique_ptr<CLI::App> app_;
  std::function<int()> job_;
  std::function<void(const std::string&)> report_;
};

}  // namespace palpate::runtime
