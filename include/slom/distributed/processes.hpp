/// Processes: the processes of a session as a Collective, and messages between them.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "slom/base/collective.hpp"

namespace slom::distributed {

/// All processes of the Session, which must exist. Sums are formed in the order of the processes, so they have the same
/// bits in each process and in each run.
class Processes : public Collective {
 public:
  Processes();

  /// Returns the number of this process, from 0.
  int rank() const { return rank_; }
  /// Returns the number of processes.
  int size() const { return size_; }

  bool isAlone() const override { return size_ == 1; }
  double sum(double x) const override;
  double max(double x) const override;
  std::vector<std::string> gather(const std::string& text) const override;
  /// Sends bytes to each process, this one included, and returns those from each.
  std::vector<std::string> exchange(std::vector<std::string> to_each) const;
  /// Does the same if the sizes of the texts from each process are known. Only processes with texts that are not empty
  /// send and receive messages.
  std::vector<std::string> exchange(std::vector<std::string> to_each,
                                    const std::vector<std::size_t>& sizes_from) const;
  /// Returns the bytes of process `from`.
  std::string broadcast(const std::string& bytes, int from) const;
  /// Waits for all processes.
  void wait() const;

  /// Returns whether agree() has thrown the error that is now being handled, so that all processes handle it.
  static bool haveAgreedOnError();
  /// Returns the process that threw the last error of agree(). It is the one to print it.
  static int processOfError();
  /// Ends all processes at once.
  [[noreturn]] static void end(int exit_code);

 protected:
  void agreeOn(const std::function<void()>& f) const override;

 private:
  int rank_ = 0, size_ = 1;
};

}  // namespace slom::distributed
