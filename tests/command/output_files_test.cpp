// Result files: complete or not there, under names that nobody can foretell, with the mode and the links of
// what they replace.
#include "output_files.hpp"

#include <csignal>
#include <set>
#include <unistd.h>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "error.hpp"
#include "support/refusal_of.hpp"
#include "support/temporary_folder.hpp"

namespace slom::app {
namespace {

using slom::testing::readFile;
using slom::testing::refusalOf;
using slom::testing::TemporaryFolder;
using slom::testing::writeFile;

std::set<std::string> namesIn(const TemporaryFolder& folder) {
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    names.insert(entry.path().filename());
  return names;
}

mode_t modeOf(const std::filesystem::path& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 ? status.st_mode & 07777 : 0;
}

TEST(OutputFiles, AppearTogether) {
  const TemporaryFolder folder;
  OutputFiles files;
  files.add(folder / "a", "one");
  files.add(folder / "b", "two");
  for (const std::string& name : namesIn(folder))
    EXPECT_TRUE(name.starts_with(".slom-") && name.size() == 22) << name;
  files.commit();
  EXPECT_EQ(namesIn(folder), (std::set<std::string>{"a", "b"}));
  EXPECT_EQ(readFile(folder / "a") + readFile(folder / "b"), "onetwo");
}

TEST(OutputFiles, TemporaryNamesDiffer) {
  const TemporaryFolder folder;
  std::set<std::string> seen;
  for (int i = 0; i < 50; ++i) {
    OutputFiles files;
    files.add(folder / "a", "x");
    const auto names = namesIn(folder);
    seen.insert(names.begin(), names.end());
  }
  EXPECT_EQ(seen.size(), 50u);
  EXPECT_TRUE(namesIn(folder).empty());
}

TEST(OutputFiles, FailuresLeaveNothing) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "folder");
  const auto both = [&](const std::string& second) {
    return refusalOf([&] {
      OutputFiles files;
      files.add(folder / "a", "one");
      files.add(second, "two");
      files.commit();
    });
  };
  const std::string where = "; name a file in a folder that exists and may be written";
  EXPECT_EQ(both(folder / "folder"),
            "cannot write " + (folder / "folder").string() + ": it is a folder" + where);
  EXPECT_EQ(both(folder / "no/b"),
            "cannot write " + (folder / "no/b").string() + ": No such file or directory" + where);
  const std::string long_name(256, 'x');
  EXPECT_EQ(both(folder / long_name),
            "cannot write " + (folder / long_name).string() + ": File name too long" + where);
  EXPECT_EQ(namesIn(folder), (std::set<std::string>{"folder"}));
}

TEST(OutputFiles, TheLongestNames) {
  const TemporaryFolder folder;
  const std::string name(255, 'x');
  OutputFiles files;
  files.add(folder / name, "long");
  files.commit();
  EXPECT_EQ(readFile(folder / name), "long");
}

TEST(OutputFiles, KeepTheModeOfWhatTheyReplace) {
  const TemporaryFolder folder;
  const mode_t mask = ::umask(027);
  for (const mode_t mode : {0600, 0640, 0444, 0755}) {
    writeFile(folder / "a", "old");
    ::chmod((folder / "a").c_str(), mode);
    OutputFiles files;
    files.add(folder / "a", "new");
    files.commit();
    EXPECT_EQ(readFile(folder / "a"), "new");
    EXPECT_EQ(modeOf(folder / "a"), mode);
    std::filesystem::remove(folder / "a");
  }
  OutputFiles files;
  files.add(folder / "new", "x");
  files.commit();
  EXPECT_EQ(modeOf(folder / "new"), 0640u);
  ::umask(mask);
}

TEST(OutputFiles, LinksStayLinks) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "there");
  writeFile(folder / "there/old", "old");
  std::filesystem::create_symlink("there/old", folder / "link");
  std::filesystem::create_symlink("link", folder / "link to link");
  std::filesystem::create_symlink("there/not yet", folder / "dangling");
  OutputFiles files;
  files.add(folder / "link to link", "new");
  files.add(folder / "dangling", "first");
  files.commit();
  for (const std::string name : {"link", "link to link", "dangling"})
    EXPECT_TRUE(std::filesystem::is_symlink(folder / name)) << name;
  EXPECT_EQ(readFile(folder / "there/old"), "new");
  EXPECT_EQ(readFile(folder / "there/not yet"), "first");
}

TEST(OutputFiles, OneFileSpeltTwice) {
  const TemporaryFolder folder;
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path());
  std::filesystem::create_directory("sub");
  std::filesystem::create_symlink("a.json", "link");
  std::filesystem::create_symlink("sub", "other");
  const auto expectRefused = [](const std::string& one, const std::string& two) {
    const std::string sentence = "--output " + two + ": this is the file of --json too; give another one";
    EXPECT_EQ(refusalOf([&] { checkResultPaths({}, {{"--json", one}, {"--output", two}}); }), sentence);
    EXPECT_EQ(refusalOf([&] { checkResultPaths({{"--json", one}}, {{"--output", two}}); }), sentence);
  };
  for (const std::string one : {"a.json", "./a.json", "sub/../a.json", "link", "././/a.json"}) {
    for (const std::string two : {"a.json", "./a.json", "other/../a.json", "link"}) expectRefused(one, two);
    expectRefused(one, (folder / "a.json").string());
  }
  expectRefused("sub/b", "other/b");
  EXPECT_EQ(refusalOf([&] {
              checkResultPaths({{"FILE", "a"}}, {{"--json", "b"}, {"--output", "sub/b"}});
            }),
            "no error");
  std::filesystem::current_path(before);
}

TEST(OutputFiles, OneFileUnderTwoHardLinks) {
  const TemporaryFolder folder;
  writeFile(folder / "a", "old");
  std::filesystem::create_hard_link(folder / "a", folder / "b");
  std::filesystem::create_symlink("b", folder / "c");
  for (const std::string other : {"b", "c"}) {
    const std::string one = folder / "a", two = folder / other;
    const std::string sentence = "--output " + two + ": this is the file of --json too; give another one";
    EXPECT_EQ(refusalOf([&] { checkResultPaths({}, {{"--json", one}, {"--output", two}}); }), sentence);
    EXPECT_EQ(refusalOf([&] { checkResultPaths({{"--json", one}}, {{"--output", two}}); }), sentence);
  }
  OutputFiles files;
  files.add(folder / "a", "new");
  files.commit();
  EXPECT_EQ(readFile(folder / "a") + readFile(folder / "b"), "newold");
}

TEST(OutputFiles, DevicesUnderAnyName) {
  for (const std::string name : {"/dev/stdout", "/dev/../dev/stdout", "/proc/self/fd/1", "/dev/null"})
    EXPECT_EQ(refusalOf([&] {
                checkResultPaths({}, {{"--json", name}});
              }),
              "--json " + name + ": this is a device or a pipe; give the name of a file");
}

/// A child that a signal ends while its file is not finished.
TEST(OutputFiles, SignalsLeaveNothing) {
  for (const int signal :
       {SIGINT, SIGTERM, SIGHUP, SIGPIPE, SIGQUIT, SIGALRM, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ}) {
    const TemporaryFolder folder;
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      const rlimit no_core{};
      ::setrlimit(RLIMIT_CORE, &no_core);
      OutputFiles files;
      files.add(folder / "a", "x");
      if (namesIn(folder).size() == 1) ::raise(signal);
      ::_exit(0);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(WTERMSIG(status), signal);
    EXPECT_TRUE(namesIn(folder).empty());
  }
}

/// As of a program under nohup.
TEST(OutputFiles, SignalsThatAreIgnoredStayIgnored) {
  const TemporaryFolder folder;
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    ::signal(SIGHUP, SIG_IGN);
    OutputFiles files;
    files.add(folder / "a", "x");
    ::raise(SIGHUP);
    files.commit();
    ::_exit(7);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(WEXITSTATUS(status), 7);
  EXPECT_EQ(namesIn(folder), (std::set<std::string>{"a"}));
}

}  // namespace
}  // namespace slom::app
