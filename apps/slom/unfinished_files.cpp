#include "unfinished_files.hpp"

#include <atomic>
#include <csignal>
#include <mutex>
#include <string>
#include <system_error>
#include <unistd.h>

namespace slom::app {

namespace {

/// Signals that end a program that does not handle them, except those of the program's own faults and those that cannot
/// be handled.
constexpr int ending_signals[] = {SIGINT,  SIGTERM, SIGHUP,  SIGPIPE, SIGQUIT,
                                  SIGALRM, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ};

/// An entry of a list that only grows, so that a signal handler can walk it at any time. Entries whose names are no
/// longer needed are reused.
struct Entry {
  std::string file;
  std::atomic<bool> is_there = false;
  Entry* next = nullptr;
};
std::atomic<Entry*> first = nullptr;
std::mutex changes;

void removeAllAndEnd(int signal) {
  for (const Entry* entry = first.load(); entry != nullptr; entry = entry->next) {
    if (entry->is_there.load()) ::unlink(entry->file.c_str());
  }
  struct sigaction usual {};
  usual.sa_handler = SIG_DFL;
  ::sigaction(signal, &usual, nullptr);
  ::raise(signal);
}

void handleSignals() {
  for (const int signal : ending_signals) {
    struct sigaction now {};
    if (::sigaction(signal, nullptr, &now) != 0 || now.sa_handler != SIG_DFL) continue;
    struct sigaction ours {};
    ours.sa_handler = removeAllAndEnd;
    ::sigemptyset(&ours.sa_mask);
    ::sigaction(signal, &ours, nullptr);
  }
}

Entry* find(const std::string& file) {
  for (Entry* entry = first.load(); entry != nullptr; entry = entry->next) {
    if (entry->is_there.load() && entry->file == file) return entry;
  }
  return nullptr;
}

}  // namespace

void expectUnfinished(const std::filesystem::path& file) {
  const std::lock_guard lock(changes);
  handleSignals();
  for (Entry* entry = first.load(); entry != nullptr; entry = entry->next) {
    if (entry->is_there.load()) continue;
    entry->file = file.string();
    entry->is_there.store(true);
    return;
  }
  auto* const entry = new Entry;  // lives until the program ends
  entry->file = file.string();
  entry->is_there.store(true);
  entry->next = first.load();
  first.store(entry);
}

void forgetUnfinished(const std::filesystem::path& file) {
  const std::lock_guard lock(changes);
  if (Entry* const entry = find(file.string())) entry->is_there.store(false);
}

void removeUnfinished(const std::filesystem::path& file) {
  std::error_code ignored;
  std::filesystem::remove(file, ignored);
  forgetUnfinished(file);
}

}  // namespace slom::app
