#include "apps/cli/completion.hpp"

#include <utility>

namespace groundloop::apps {
namespace {

std::vector<OptionPage> all_options(const CommandPage& page) {
  std::vector<OptionPage> options = page.options;
  options.insert(options.end(), page.everywhere.begin(), page.everywhere.end());
  return options;
}

std::string words(const std::vector<std::string>& list) {
  std::string text;
  for (const std::string& word : list) text += (text.empty() ? "" : " ") + word;
  return text;
}

// Within single quotes, for every shell here.
std::string shell_quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

// The words that may follow the command itself.
std::vector<std::string> next_words(const CommandPage& page) {
  std::vector<std::string> list;
  for (const CommandName& below : page.commands) list.push_back(below.name);
  for (const OptionPage& option : all_options(page)) list.push_back(option.name);
  return list;
}

const char* bash_action(Completes completes) {
  switch (completes) {
    case Completes::file:
      return "COMPREPLY=($(compgen -f -- \"$current\"))";
    case Completes::folder:
      return "COMPREPLY=($(compgen -d -- \"$current\"))";
    case Completes::nothing:
      break;
  }
  return "COMPREPLY=()";
}

// What the arguments of a command are; folders where all of them are.
Completes arguments_of(const CommandPage& page) {
  return page.arguments.empty() ? Completes::nothing : page.arguments.front().value.completes;
}

std::string bash_values(const CommandPage& page) {
  std::string text;
  for (const OptionPage& option : all_options(page)) {
    if (option.value.name.empty()) continue;
    text += "      " + shell_quoted(page.path + " " + option.name) + ") ";
    text += option.choices.empty() ? std::string(bash_action(option.value.completes))
                                   : "COMPREPLY=($(compgen -W " +
                                         shell_quoted(words(option.choices)) + " -- \"$current\"))";
    text += "; return ;;\n";
  }
  return text;
}

std::string zsh_specification(const OptionPage& option) {
  std::string description;
  for (const char c : option.description) {
    // Brackets end a description in zsh, colons a field.
    if (c == '[' || c == ']' || c == ':') description += '\\';
    description += c;
  }
  std::string text = (option.repeats ? "*" : "") + option.name + "[" + description + "]";
  if (option.value.name.empty()) return shell_quoted(text);
  text += ":" + option.value.name + ":";
  if (!option.choices.empty()) return shell_quoted(text + "(" + words(option.choices) + ")");
  if (option.value.completes == Completes::file) text += "_files";
  if (option.value.completes == Completes::folder) text += "_files -/";
  return shell_quoted(text);
}

std::string zsh_name(const CommandPage& page) {
  std::string name = "_" + page.path;
  for (char& c : name) c = c == ' ' || c == '-' ? '_' : c;
  return name;
}

std::string zsh_function(const CommandPage& page) {
  std::string text = zsh_name(page) + "() {\n  _arguments -C";
  for (const OptionPage& option : all_options(page))
    text += " \\\n    " + zsh_specification(option);
  if (!page.commands.empty()) {
    std::string names;
    for (const CommandName& below : page.commands) names += " " + below.name;
    text += " \\\n    '1:command:(" + names.substr(1) + ")' '*::argument:->below'\n";
    text += "  [[ $state == below ]] || return\n  case $words[1] in\n";
    for (const CommandName& below : page.commands) {
      CommandPage next;
      next.path = page.path + " " + below.name;
      text += "    " + below.name + ") " + zsh_name(next) + " ;;\n";
    }
    return text + "  esac\n}\n\n";
  }
  const Completes arguments = arguments_of(page);
  if (arguments == Completes::file) text += " \\\n    '*:file:_files'";
  if (arguments == Completes::folder) text += " \\\n    '*:folder:_files -/'";
  return text + "\n}\n\n";
}

}  // namespace

std::string bash_completion(const std::vector<CommandPage>& pages) {
  std::string known;
  std::string values;
  std::string nexts;
  for (const CommandPage& page : pages) {
    for (const CommandName& below : page.commands)
      known += "      " + shell_quoted(page.path + " " + below.name) + ") path+=\" $word\" ;;\n";
    values += bash_values(page);
    nexts += "    " + shell_quoted(page.path) + ") next=" + shell_quoted(words(next_words(page))) +
             "; arguments=" +
             (arguments_of(page) == Completes::folder ? "-d"
              : arguments_of(page) == Completes::file ? "-f"
                                                      : "''") +
             " ;;\n";
  }
  return "# bash completion for groundloop, made by `groundloop completion bash`.\n"
         "_groundloop() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}\n"
         "  local path=groundloop word next arguments\n"
         "  for word in \"${COMP_WORDS[@]:1:COMP_CWORD-1}\"; do\n"
         "    case \"$path $word\" in\n" +
         known +
         "    esac\n"
         "  done\n"
         "  compopt -o filenames 2>/dev/null\n"
         "  case \"$path $before\" in\n" +
         values +
         "  esac\n"
         "  case \"$path\" in\n" +
         nexts +
         "  esac\n"
         "  COMPREPLY=($(compgen -W \"$next\" -- \"$current\"))\n"
         "  [[ $current == -* || -z $arguments ]] ||\n"
         "    COMPREPLY+=($(compgen $arguments -- \"$current\"))\n"
         "}\n"
         "complete -F _groundloop groundloop\n";
}

std::string zsh_completion(const std::vector<CommandPage>& pages) {
  std::string text =
      "#compdef groundloop\n# zsh completion, made by `groundloop completion zsh`.\n\n";
  for (const CommandPage& page : pages) text += zsh_function(page);
  // Run when it is autoloaded, defined when it is sourced.
  return text +
         "if [[ $funcstack[1] == _groundloop ]]; then\n  _groundloop \"$@\"\n"
         "else\n  compdef _groundloop groundloop\nfi\n";
}

std::string fish_completion(const std::vector<CommandPage>& pages) {
  std::string text =
      "# fish completion for groundloop, made by `groundloop completion fish`.\n"
      "# True where the words so far that are no options begin with these.\n"
      "function __groundloop_at\n"
      "  set -l words (commandline -opc)[2..]\n"
      "  set -l named\n"
      "  for word in $words\n"
      "    string match -q -- '-*' $word; or set -a named $word\n"
      "  end\n"
      "  test (count $named) -ge (count $argv); or return 1\n"
      "  test -z \"$argv\"; or test \"$named[1..\"(count $argv)\"]\" = \"$argv\"\n"
      "end\n"
      "function __groundloop_only\n"
      "  __groundloop_at $argv; or return 1\n"
      "  set -l words (commandline -opc)[2..]\n"
      "  test (count (string match -v -- '-*' $words)) -eq (count $argv)\n"
      "end\n\n";
  for (const CommandPage& page : pages) {
    const std::size_t space = page.path.find(' ');
    const std::string below = space == std::string::npos ? "" : page.path.substr(space);
    const std::string at = " -n " + shell_quoted("__groundloop_at" + below);
    for (const CommandName& next : page.commands) {
      text += "complete -c groundloop -f -n " + shell_quoted("__groundloop_only" + below) + " -a " +
              next.name + " -d " + shell_quoted(next.summary) + "\n";
    }
    for (const OptionPage& option : page.options) {
      text += "complete -c groundloop" + at + " -l " + option.name.substr(2) + " -d " +
              shell_quoted(option.description);
      if (!option.choices.empty()) {
        text += " -x -a " + shell_quoted(words(option.choices));
      } else if (option.value.completes == Completes::folder) {
        text += " -x -a '(__fish_complete_directories)'";
      } else if (!option.value.name.empty()) {
        text += option.value.completes == Completes::file ? " -r -F" : " -x";
      }
      text += "\n";
    }
    if (page.commands.empty() && arguments_of(page) == Completes::nothing)
      text += "complete -c groundloop -f" + at + "\n";
  }
  return text;
}

}  // namespace groundloop::apps
