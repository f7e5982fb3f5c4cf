#include "apps/cli/command_page.hpp"

#include <algorithm>
#include <sstream>

#include <gtest/gtest.h>

#include "apps/cli/help_text.hpp"
#include "apps/cli/man_page.hpp"
#include "apps/cli/wrapping.hpp"
#include "apps/commands/commands.hpp"

namespace groundloop::apps {
namespace {

std::vector<CommandPage> pages() {
  Context context;
  CLI::App app;
  add_commands(app, context);
  return all_pages(app);
}

bool has_option(const CommandPage& page, const std::string& name) {
  const auto named = [&](const OptionPage& option) { return option.name == name; };
  return std::any_of(page.options.begin(), page.options.end(), named) ||
         std::any_of(page.everywhere.begin(), page.everywhere.end(), named);
}

// The page whose words an example begins with.
const CommandPage* page_of_example(const std::vector<CommandPage>& pages, const std::string& line) {
  const CommandPage* best = nullptr;
  for (const CommandPage& page : pages) {
    const bool begins = line == page.path || line.rfind(page.path + " ", 0) == 0;
    if (begins && (best == nullptr || page.path.size() > best->path.size())) best = &page;
  }
  return best;
}

TEST(CommandPage, EveryCommandTeachesByAnExample) {
  for (const CommandPage& page : pages()) {
    if (page.path == "groundloop evaluate") continue;  // only names those below it
    EXPECT_FALSE(page.guide.examples.empty()) << page.path;
    EXPECT_FALSE(page.summary.empty()) << page.path;
  }
}

TEST(CommandPage, ExamplesUseOptionsThatExist) {
  const std::vector<CommandPage> all = pages();
  for (const CommandPage& page : all) {
    for (const Example& example : page.guide.examples) {
      const CommandPage* command = page_of_example(all, example.command);
      ASSERT_NE(command, nullptr) << example.command;
      std::istringstream words(example.command);
      for (std::string word; words >> word;) {
        if (word.rfind("--", 0) != 0) continue;
        EXPECT_TRUE(has_option(*command, word)) << example.command;
      }
    }
  }
}

TEST(CommandPage, EveryCommandWithAnOutSaysWhatItWrites) {
  for (const CommandPage& page : pages()) {
    if (!has_option(page, "--out")) continue;
    EXPECT_FALSE(page.guide.files.empty()) << page.path;
  }
}

TEST(CommandPage, HelpNamesEveryOptionAndKeepsToItsWidth) {
  for (const CommandPage& page : pages()) {
    const std::string help = help_text(page, 80, false);
    for (const OptionPage& option : page.options)
      EXPECT_NE(help.find("  " + option_label(option)), std::string::npos) << option.name;
    std::istringstream lines(help);
    for (std::string line; std::getline(lines, line);) {
      const bool command = line.rfind("  groundloop ", 0) == 0;  // for copying: not broken
      EXPECT_TRUE(command || columns_of(line) <= 80) << line;
    }
    EXPECT_EQ(help.find('\033'), std::string::npos);
  }
}

TEST(CommandPage, ChoicesAndLimitsComeFromTheParser) {
  for (const CommandPage& page : pages()) {
    for (const OptionPage& option : page.options) {
      if (page.path == "groundloop run" && option.name == "--stamp") {
        EXPECT_EQ(option.choices, (std::vector<std::string>{"start", "middle", "end"}));
      }
      if (page.path == "groundloop" && option.name == "--threads") {
        EXPECT_EQ(option.limits, "[0 - 1024]");
      }
    }
  }
}

// What roff(7) would take for a request or an escape of its own.
TEST(ManPage, HoldsNoTextThatRoffTakesForRequests) {
  for (const CommandPage& page : pages()) {
    std::istringstream lines(man_page(page));
    for (std::string line; std::getline(lines, line);) {
      if (line.empty()) continue;
      if (line.front() == '.') {
        EXPECT_TRUE(line[1] == 'T' || line[1] == 'S' || line[1] == 'P' || line[1] == 'R' ||
                    line[1] == 'n' || line[1] == 'f' || line[1] == 'B')
            << line;
      }
      EXPECT_NE(line.front(), '\'') << line;
    }
  }
}

TEST(Wrapping, BreaksBetweenWordsOnly) {
  EXPECT_EQ(wrapped("one two three", 7), (std::vector<std::string>{"one two", "three"}));
  EXPECT_EQ(wrapped("incomprehensible", 4), (std::vector<std::string>{"incomprehensible"}));
  EXPECT_EQ(wrapped("", 4), (std::vector<std::string>{""}));
  EXPECT_EQ(columns_of("±σ"), 2U);
}

TEST(Wrapping, PutsALongLeftColumnOnALineOfItsOwn) {
  EXPECT_EQ(two_columns("a", "b c", 6, 40), "  a   b c\n");
  EXPECT_EQ(two_columns("abcdef", "b", 6, 40), "  abcdef\n      b\n");
}

}  // namespace
}  // namespace groundloop::apps
