/// Checkpoint: values of a fit in a folder, from which a later run goes on, with any number of processes.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "slom/base/collective.hpp"

namespace slom::io {

/// A folder with the values of variables by their names. Each process writes a file of its own. When all are complete,
/// the first process names them in the file `checkpoint`, which replaces its predecessor at once. So the folder has a
/// whole set of values at any time, even if the run is killed while it writes.
class Checkpoint {
 public:
  /// Values of one run. They are bytes: a checkpoint is read by the same program on the same kind of machine.
  class Values {
   public:
    /// Adds the value of a variable.
    template <class T>
    void add(std::uint64_t name, const T& value) {
      addBytes(name, reinterpret_cast<const char*>(&value), sizeof value);
    }
    /// Returns the names and values, one after another.
    const std::string& bytes() const { return bytes_; }

   private:
    void addBytes(std::uint64_t name, const char* value, std::size_t size);
    std::string bytes_;
  };

  /// Identifies the problem. A checkpoint of another problem is refused.
  struct Problem {
    std::string text;  ///< the kind and the counts of the whole problem, such as `graph of 2500 poses`
    /// Returns a hash of the measurements of this process (slom/io/data_hash.hpp). Called once, by the first write() or
    /// read().
    std::function<std::uint64_t()> data_hash;
  };

  /// Uses a folder, which requireWritable() or write() makes if it is not there. `process`: the number of this process
  /// among `count`. Refers to `processes`, which must outlive this object.
  Checkpoint(const Collective& processes, int process, int count, std::string folder, Problem problem)
      : processes_(processes),
        process_(process),
        count_(count),
        folder_(std::move(folder)),
        problem_(std::move(problem)) {}
  /// Uses a folder for a single process.
  Checkpoint(std::string folder, Problem problem)
      : Checkpoint(singleProcess(), 0, 1, std::move(folder), std::move(problem)) {}

  /// Checks before the work that all processes can write files in the folder. All call it. Throws [slom.checkpoint] in
  /// all.
  void requireWritable() const;
  /// Writes the values of all processes, each variable in one of them, and removes those written before. All processes
  /// call it. Throws [slom.checkpoint] in all.
  void write(const Values& own);
  /// Calls f(name, bytes) in each process for the values of all. All processes call it. Throws [slom.checkpoint] in all.
  void read(const std::function<void(std::uint64_t name, std::string_view bytes)>& f) const;

 private:
  struct Set;
  std::string nameOf(int set, int process, int processes) const;
  const std::string& problemText() const;

  const Collective& processes_;
  int process_ = 0, count_ = 1;
  std::string folder_;
  Problem problem_;
  mutable std::string problem_text_;  // with the hash of all processes; empty: not needed yet
  int written_ = -1;                  // number of the last set, -1: none yet
};

}  // namespace slom::io
