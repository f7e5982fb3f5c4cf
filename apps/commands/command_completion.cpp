#include <filesystem>
#include <iostream>
#include <memory>

#include "apps/cli/completion.hpp"
#include "apps/cli/man_page.hpp"
#include "apps/commands/commands.hpp"
#include "frontend/core/output_file.hpp"

namespace groundloop::apps {

void add_completion_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "completion", "print what makes bash, zsh or fish complete commands and options");
  auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
  command->callback([shell, &app] {
    const std::vector<CommandPage> pages = all_pages(app);
    std::cout << (*shell == "bash"  ? bash_completion(pages)
                  : *shell == "zsh" ? zsh_completion(pages)
                                    : fish_completion(pages));
  });
}

void add_man_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("man", "write the manual pages into a folder");
  // For the build alone: who wants to read has man(1) and --help.
  command->group("");
  auto folder = std::make_shared<std::string>();
  command->add_option("--out", *folder, "folder that exists")->required();
  command->callback([folder, &app] {
    for (const CommandPage& page : all_pages(app))
      write_text_atomically(std::filesystem::path(*folder) / man_page_name(page), man_page(page));
  });
}

}  // namespace groundloop::apps
