#include "apps/cli/command_page.hpp"

#include <algorithm>

namespace groundloop::apps {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end; (end = text.find(separator, begin)) != std::string::npos; begin = end + 1)
    parts.push_back(text.substr(begin, end - begin));
  parts.push_back(text.substr(begin));
  return parts;
}

// CLI11 keeps what a validator demands in the name of the type only: "TEXT:{a,b}",
// "INT:INT in [0 - 9]".
void add_demands(OptionPage& page, const std::string& type) {
  const std::size_t brace = type.find(":{");
  if (brace != std::string::npos && type.back() == '}')
    page.choices = split(type.substr(brace + 2, type.size() - brace - 3), ',');
  const std::size_t bracket = type.find(" in [");
  if (bracket != std::string::npos) page.limits = type.substr(bracket + 4);
}

OptionPage page_of(const CLI::Option& option, const std::string& command) {
  OptionPage page;
  page.name = option.get_positional() ? option.get_name(true) : "--" + option.get_lnames().front();
  page.description = option.get_description();
  page.fallback = option.get_default_str();
  page.required = option.get_required();
  page.repeats = option.get_expected_max() > 1 ||
                 option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
  const bool flag = !option.get_positional() && option.get_items_expected_max() == 0;
  if (flag) return page;
  page.value = value_guide(command, page.name);
  add_demands(page, option.get_type_name());
  return page;
}

std::string path_of(const CLI::App& command) {
  const std::string name = command.get_name();
  return command.get_parent() == nullptr ? name : path_of(*command.get_parent()) + " " + name;
}

std::vector<const CLI::App*> visible_commands(const CLI::App& command) {
  std::vector<const CLI::App*> commands;
  for (const CLI::App* below : command.get_subcommands(nullptr)) {
    if (!below->get_group().empty()) commands.push_back(below);
  }
  return commands;
}

// Its options by their names on the command line; --help is said once, with those of everywhere.
void add_options(const CLI::App& command, bool of_the_top, std::vector<OptionPage>& arguments,
                 std::vector<OptionPage>& options) {
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group().empty()) continue;
    const bool help = option == command.get_help_ptr();
    if (help && !of_the_top) continue;
    (option->get_positional() ? arguments : options)
        .push_back(page_of(*option, command.get_name()));
  }
}

}  // namespace

CommandPage page_of(const CLI::App& command) {
  CommandPage page;
  page.path = path_of(command);
  page.summary = command.get_description();
  add_options(command, command.get_parent() == nullptr, page.arguments, page.options);
  for (const CLI::App* above = command.get_parent(); above != nullptr; above = above->get_parent())
    add_options(*above, above->get_parent() == nullptr, page.arguments, page.everywhere);
  for (const CLI::App* below : visible_commands(command))
    page.commands.push_back({below->get_name(), below->get_description()});
  page.guide = command_guide(page.path);
  return page;
}

std::vector<CommandPage> all_pages(const CLI::App& command) {
  std::vector<CommandPage> pages{page_of(command)};
  for (const CLI::App* below : visible_commands(command)) {
    std::vector<CommandPage> more = all_pages(*below);
    std::move(more.begin(), more.end(), std::back_inserter(pages));
  }
  return pages;
}

}  // namespace groundloop::apps
