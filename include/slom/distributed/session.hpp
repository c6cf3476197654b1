/// Session: the beginning and the end of a program on several processes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "mtk/detail/cpp20.hpp"

namespace slom::distributed {

/// Begins MPI and PETSc, unless the program has done so, and ends them. Make one object, first of all in main(). PETSc
/// reads its own options from the environment variable PETSC_OPTIONS. The processes are those of PETSC_COMM_WORLD.
///
/// If an exception that Collective::agree did not pass to all processes ends the session of one of them, all are ended.
/// Otherwise they would wait for that process forever.
class Session {
 public:
  /// `petsc_options`: further options of PETSc, such as `-ksp_type cg -pc_type gamg`.
  explicit Session(const std::string& petsc_options = {});
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Returns the options of PETSc that nothing has used so far, such as misspelt ones: `-ksp_tpye cg`.
  static std::vector<std::string> unusedPetscOptions();

  /// Returns the number of this process, from 0.
  int rank() const { return rank_; }
  /// Returns the number of processes.
  int size() const { return size_; }

 private:
  int rank_ = 0, size_ = 1;
  bool owns_mpi_ = false, owns_petsc_ = false;
};

/// Runs a program on several processes: makes the Session, calls f, and returns the exit code for main(), 0 or 1. An
/// error is printed once. If an error comes from one process alone, such as a file that only this process reads, ends
/// all processes, because the others would wait for this one forever.
int run(const std::function<void(const Session&)>& f);

}  // namespace slom::distributed
